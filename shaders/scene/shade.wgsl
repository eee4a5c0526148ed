// Radiance and opacity of a surface. Which of it exists is decided when a shader is linked, by what the scene's materials and
// lights call for. Twin of peelnet_core::shading.
import package::scene::camera::camera;
import package::scene::surface::Surface;

struct Material {
    // Linear RGB and alpha.
    color: vec4f,
    // Blinn-Phong: x: specular strength, y: shininess exponent. Physically based: x: metallic, y: roughness. z: alpha cut-off.
    look: vec4f,
    // Radiance emitted beyond what the opacity covers, linear RGB.
    emission: vec4f,
}

@if(lit)
struct Light {
    position: vec4f,
    // Linear RGB times intensity.
    color: vec4f,
}

@group(0) @binding(1) var<storage, read> materials: array<Material>;
@if(lit) @group(0) @binding(2) var<storage, read> lights: array<Light>;

@if(phong) const AMBIENT: f32 = 0.1;
@if(pbr) const AMBIENT: f32 = 0.03;
@if(pbr) const PI: f32 = 3.14159265;
// Reflectance of a dielectric seen head-on (glTF 2.0, index of refraction 1.5).
@if(pbr) const DIELECTRIC: f32 = 0.04;

// Alpha alone, for passes that need no colour.
fn opacity(surface: Surface) -> f32 {
    return materials[surface.material].color.a;
}

// Premultiplied radiance and alpha: what is emitted comes beyond what is covered.
fn shade(surface: Surface) -> vec4f {
    let material = materials[surface.material];
    var premultiplied = reflected(surface, material) * material.color.a;
    @if(emission) premultiplied += material.emission.rgb;
    return vec4f(premultiplied, material.color.a);
}

// Radiance of an opaque surface, whatever its alpha.
fn opaque(surface: Surface) -> vec3f {
    let material = materials[surface.material];
    var color = reflected(surface, material);
    @if(emission) color += material.emission.rgb;
    return color;
}

// Un-premultiplied radiance and alpha, as datasets keep it. An invisible fragment's emission cannot be told so.
fn radiance(surface: Surface) -> vec4f {
    let material = materials[surface.material];
    var color = reflected(surface, material);
    @if(emission) color += material.emission.rgb / max(material.color.a, 1e-6);
    return vec4f(color, material.color.a);
}

@if(!lit)
fn reflected(surface: Surface, material: Material) -> vec3f {
    return material.color.rgb;
}

// The normal towards the eye. An interpolated one can vanish between opposite corners: the view direction stands in, never NaN.
@if(lit)
fn facing_normal(surface: Surface, view: vec3f) -> vec3f {
    let length_squared = dot(surface.normal, surface.normal);
    let normal = select(view, surface.normal * inverseSqrt(max(length_squared, 1e-20)), length_squared > 1e-20);
    return select(-normal, normal, dot(normal, view) >= 0.0);
}

// Blinn-Phong (Blinn 1977) with two-sided normals.
@if(phong)
fn reflected(surface: Surface, material: Material) -> vec3f {
    let view = normalize(camera.eye.xyz - surface.world);
    let normal = facing_normal(surface, view);
    var radiance = AMBIENT * material.color.rgb;
    for (var i = 0u; i < camera.frame.z; i++) {
        let toward = normalize(lights[i].position.xyz - surface.world);
        let diffuse = max(dot(normal, toward), 0.0);
        let halfway = normalize(toward + view);
        let highlight = select(0.0, pow(max(dot(normal, halfway), 0.0), material.look.y), diffuse > 0.0);
        radiance += lights[i].color.rgb * (material.color.rgb * diffuse + material.look.x * highlight);
    }
    return radiance;
}

// How far the reflectance at this angle is from that head-on towards 1.
@if(pbr)
fn grazing(cosine: f32) -> f32 {
    return pow(saturate(1.0 - cosine), 5.0);
}

// Cook-Torrance: the GGX distribution (Walter et al. 2007), Schlick's Fresnel term (1994), Smith's shadowing in Schlick's form with
// k = (roughness + 1)^2 / 8 for point lights (Karis 2013), inverse-square falloff.
@if(pbr)
fn reflected(surface: Surface, material: Material) -> vec3f {
    let view = normalize(camera.eye.xyz - surface.world);
    let normal = facing_normal(surface, view);
    let albedo = material.color.rgb;
    let metallic = material.look.x;
    // Below that the highlight of a point light is smaller than any pixel, and its peak overflows.
    let roughness = max(material.look.y, 0.04);
    let head_on = mix(vec3f(DIELECTRIC), albedo, metallic);
    let a = roughness * roughness;
    let k = (roughness + 1.0) * (roughness + 1.0) / 8.0;
    let n_v = max(dot(normal, view), 1e-4);
    var radiance = AMBIENT * albedo;
    for (var i = 0u; i < camera.frame.z; i++) {
        let apart = lights[i].position.xyz - surface.world;
        let distance_squared = max(dot(apart, apart), 1e-8);
        let toward = apart * inverseSqrt(distance_squared);
        let halfway = normalize(toward + view);
        let n_l = max(dot(normal, toward), 0.0);
        let n_h = max(dot(normal, halfway), 0.0);
        let spread = n_h * n_h * (a * a - 1.0) + 1.0;
        let distribution = a * a / (PI * spread * spread);
        let shadowing = 1.0 / ((n_l * (1.0 - k) + k) * (n_v * (1.0 - k) + k));
        let fresnel = mix(head_on, vec3f(1.0), grazing(dot(halfway, view)));
        // What a dielectric scatters inside went in at the light's angle and comes out at the eye's.
        let inside = (1.0 - DIELECTRIC) * (1.0 - DIELECTRIC) * (1.0 - grazing(n_l)) * (1.0 - grazing(n_v));
        let diffuse = inside * (1.0 - metallic) * albedo / PI;
        let arriving = lights[i].color.rgb / distance_squared;
        // n_l n_v of the shadowing term and of the denominator cancel.
        radiance += (diffuse + distribution * shadowing * 0.25 * fresnel) * arriving * n_l;
    }
    return radiance;
}

// Whether this point of the surface is a hole.
@if(cutout)
fn is_hole(surface: Surface) -> bool {
    let material = materials[surface.material];
    return material.color.a < material.look.z;
}
