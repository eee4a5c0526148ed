// Radiance and opacity of a surface. Which of it exists is decided when a shader is linked, by what the scene's materials and
// lights need. The CPU reference is peelnet_core::shading.
// Loops: 2: peelnet_scene::MAX_LIGHTS.
@if(display) import package::helpers::display::shown_of;
import package::scene::camera::camera;
@if(emission || transmission) import package::helpers::guards::EMISSIVE_ALPHA;
@if(color_map) import package::scene::maps::color_at;
@if(normal_map) import package::scene::maps::normal_at;
@if(metallic_roughness_map) import package::scene::maps::roughness_metallic_at;
@if(occlusion_map) import package::scene::maps::occlusion_at;
@if(emissive_map) import package::scene::maps::emission_at;
import package::scene::material::{Material, materials};
@if(splat) import package::scene::splat::{FAINTEST, MOST_COVERED};
import package::scene::surface::Surface;

// As `LightData` in peelnet_render, geometry/uniforms.rs.
@if(lit)
struct Light {
    // A point; or, where `is_point` is 0, the direction that light comes from.
    position: vec3f,
    is_point: f32,
    // Linear RGB times intensity.
    color: vec3f,
}

@if(lit) @group(0) @binding(2) var<storage, read> lights: array<Light>;

@if(phong) const AMBIENT: f32 = 0.1;
@if(pbr) const AMBIENT: f32 = 0.03;
@if(pbr) const PI: f32 = 3.14159265;
// Reflectance of a dielectric seen head-on (glTF 2.0, index of refraction 1.5).
@if(pbr) const DIELECTRIC: f32 = 0.04;

// What a surface is before light falls on it.
struct Base {
    // Linear RGB.
    color: vec3f,
    // Share of the light behind that it covers, channel by channel.
    covering: vec3f,
    // Share of the pixel that it takes, and of its light that it reflects.
    coverage: f32,
}

fn base_of(surface: Surface, material: Material) -> Base {
    var color = surface.material_color;
    @if(splat) {
        let gaussian = surface.gaussian / surface.depth_linear;
        let share = exp(-0.5 * dot(gaussian, gaussian));
        color *= vec4f(surface.splat.rgb, min(surface.splat.a * share, MOST_COVERED));
    }
    @if(vertex_colors) color *= surface.color;
    @if(clear_map) color *= color_at(surface.uv);
    @if(color_map && !clear_map) color = vec4f(color.rgb * color_at(surface.uv).rgb, color.a);
    // Sums know a surface by what it covers, and this one shows beyond that.
    @if(emission) color.a = max(color.a, EMISSIVE_ALPHA);
    var covering = vec3f(color.a);
    @if(transmission) {
        var passing = material.transmission;
        @if(vertex_colors) passing *= surface.color.rgb;
        @if(color_map) passing *= color_at(surface.uv).rgb;
        // It reflects, and covers nothing: the same.
        covering = max(covering * (1.0 - passing), vec3f(EMISSIVE_ALPHA));
    }
    return Base(color.rgb, covering, color.a);
}

// Opacity as one number.
fn mean_covering(base: Base) -> f32 {
    @if(transmission) {
        return dot(base.covering, vec3f(1.0 / 3.0));
    }
    @else {
        return base.covering.x;
    }
}

// Opacity alone, for passes that need no colour.
fn opacity(surface: Surface) -> f32 {
    let material = materials[surface.material];
    @if(splat || clear_map || vertex_colors || transmission) {
        return mean_covering(base_of(surface, material));
    }
    @elif(emission) {
        return max(surface.material_color.a, EMISSIVE_ALPHA);
    }
    @else {
        return surface.material_color.a;
    }
}

// Premultiplied radiance and opacity: what is emitted comes beyond what is covered.
fn shade(surface: Surface) -> vec4f {
    let material = materials[surface.material];
    let base = base_of(surface, material);
    var premultiplied = blended(reflected(surface, material, base.color)) * base.coverage;
    @if(emission) premultiplied += blended(emitted(surface, material));
    return vec4f(premultiplied, mean_covering(base));
}

// Opacity channel by channel.
fn covering(surface: Surface) -> vec3f {
    return base_of(surface, materials[surface.material]).covering;
}

// Radiance of an opaque surface, whatever its alpha.
fn opaque(surface: Surface) -> vec3f {
    let material = materials[surface.material];
    var color = reflected(surface, material, base_of(surface, material).color);
    @if(emission) color += emitted(surface, material);
    return blended(color);
}

// Un-premultiplied radiance and opacity, as datasets keep it. An invisible fragment's emission has no such form.
fn radiance(surface: Surface) -> vec4f {
    @if(emission || transmission) {
        let color = shade(surface);
        return vec4f(color.rgb / max(color.a, 1e-6), color.a);
    }
    @else {
        let material = materials[surface.material];
        let base = base_of(surface, material);
        return vec4f(blended(reflected(surface, material, base.color)), mean_covering(base));
    }
}

// Radiance of a surface as if it were opaque, and its layer, for the view of layers.
fn layered(surface: Surface) -> vec4f {
    return vec4f(opaque(surface), materials[surface.material].layer);
}

@if(emission)
fn emitted(surface: Surface, material: Material) -> vec3f {
    var emission = material.emission;
    @if(emissive_map) emission *= emission_at(surface.uv);
    return emission;
}

// Radiance in the space in which the scene blends. Splats' is already.
fn blended(radiance: vec3f) -> vec3f {
    @if(display && !splat) return shown_of(radiance);
    @else return radiance;
}

@if(!lit)
fn reflected(surface: Surface, material: Material, albedo: vec3f) -> vec3f {
    return albedo;
}

// Share of the ambient light that arrives.
@if(lit)
fn ambient_share(surface: Surface, material: Material) -> f32 {
    @if(occlusion_map) {
        return 1.0 + material.occlusion_strength * (occlusion_at(surface.uv) - 1.0);
    }
    @else {
        return 1.0;
    }
}

// The normal towards the eye. An interpolated one can vanish between opposite vertices: the view direction stands in, never NaN.
@if(lit)
fn facing_normal(surface: Surface, material: Material, view: vec3f) -> vec3f {
    let length_squared = dot(surface.normal, surface.normal);
    var normal = select(view, surface.normal * inverseSqrt(max(length_squared, 1e-20)), length_squared > 1e-20);
    let outside = dot(normal, view) >= 0.0;
    @if(normal_map) {
        let lean = normal_at(surface.uv) * vec3f(material.normal_scale, material.normal_scale, 1.0);
        let along = surface.tangent.xyz - normal * dot(normal, surface.tangent.xyz);
        let tangent = along * inverseSqrt(max(dot(along, along), 1e-20));
        let second = cross(normal, tangent) * surface.tangent.w;
        let leaning = tangent * lean.x + second * lean.y + normal * max(lean.z, 1e-3);
        normal = leaning * inverseSqrt(max(dot(leaning, leaning), 1e-20));
    }
    return select(-normal, normal, outside);
}

// From a surface to a light, not normalised; of length 1 to one without a place.
@if(lit)
fn to_light(surface: Surface, light: Light) -> vec3f {
    @if(sun) {
        return light.position - light.is_point * surface.world;
    }
    @else {
        return light.position - surface.world;
    }
}

// Blinn-Phong (Blinn 1977) with two-sided normals.
@if(phong)
fn reflected(surface: Surface, material: Material, albedo: vec3f) -> vec3f {
    let view = normalize(camera.eye - surface.world);
    let normal = facing_normal(surface, material, view);
    var radiance = AMBIENT * ambient_share(surface, material) * albedo;
    for (var i = 0u; i < camera.light_count; i++) {
        let toward = normalize(to_light(surface, lights[i]));
        let diffuse = max(dot(normal, toward), 0.0);
        let halfway = normalize(toward + view);
        let highlight = select(0.0, pow(max(dot(normal, halfway), 0.0), surface.finish.y), diffuse > 0.0);
        radiance += lights[i].color * (albedo * diffuse + surface.finish.x * highlight);
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
fn reflected(surface: Surface, material: Material, albedo: vec3f) -> vec3f {
    let view = normalize(camera.eye - surface.world);
    let normal = facing_normal(surface, material, view);
    var factors = vec2f(surface.finish.y, surface.finish.x);
    @if(metallic_roughness_map) factors *= roughness_metallic_at(surface.uv);
    let metallic = factors.y;
    // Below that the highlight of a point light is smaller than any pixel, and its peak overflows.
    let roughness = max(factors.x, 0.04);
    let head_on = mix(vec3f(DIELECTRIC), albedo, metallic);
    let a = roughness * roughness;
    let k = (roughness + 1.0) * (roughness + 1.0) / 8.0;
    let n_v = max(dot(normal, view), 1e-4);
    var radiance = AMBIENT * ambient_share(surface, material) * albedo;
    for (var i = 0u; i < camera.light_count; i++) {
        let apart = to_light(surface, lights[i]);
        let distance_squared = max(dot(apart, apart), 1e-8);
        let toward = apart * inverseSqrt(distance_squared);
        let halfway = normalize(toward + view);
        let n_l = max(dot(normal, toward), 0.0);
        let n_h = max(dot(normal, halfway), 0.0);
        // 1 - n_h^2 without its cancellation where the highlight is sharp.
        let across = cross(normal, halfway);
        let spread = n_h * n_h * a * a + dot(across, across);
        let distribution = a * a / (PI * spread * spread);
        let shadowing = 1.0 / ((n_l * (1.0 - k) + k) * (n_v * (1.0 - k) + k));
        let fresnel = mix(head_on, vec3f(1.0), grazing(dot(halfway, view)));
        // What a dielectric scatters inside went in at the light's angle and comes out at the eye's.
        let inside = (1.0 - DIELECTRIC) * (1.0 - DIELECTRIC) * (1.0 - grazing(n_l)) * (1.0 - grazing(n_v));
        let diffuse = inside * (1.0 - metallic) * albedo / PI;
        var arriving = lights[i].color / distance_squared;
        // The sun is as bright here as there.
        @if(sun) arriving = select(lights[i].color, arriving, lights[i].is_point > 0.0);
        // n_l n_v of the shadowing term and of the denominator cancel.
        radiance += (diffuse + distribution * shadowing * 0.25 * fresnel) * arriving * n_l;
    }
    return radiance;
}

// Whether this point of the surface is a hole.
@if(cutout || splat)
fn is_hole(surface: Surface) -> bool {
    let material = materials[surface.material];
    @if(splat) return base_of(surface, material).coverage < FAINTEST;
    @else return base_of(surface, material).coverage < material.alpha_cutoff;
}
