// Radiance and opacity of a surface: unlit, or Blinn-Phong (Blinn 1977) with two-sided normals.
import package::scene::camera::camera;
import package::scene::surface::Surface;

struct Material {
    // Linear RGB and alpha.
    color: vec4f,
    // x: 1 = lit, y: specular strength, z: shininess exponent.
    lighting: vec4f,
}

struct Light {
    position: vec4f,
    // Linear RGB times intensity.
    color: vec4f,
}

@group(0) @binding(1) var<storage, read> materials: array<Material>;
@group(0) @binding(2) var<storage, read> lights: array<Light>;

const AMBIENT: f32 = 0.1;

// Alpha alone, for passes that need no colour.
fn opacity(surface: Surface) -> f32 {
    return materials[surface.material].color.a;
}

// Un-premultiplied radiance and alpha.
fn shade(surface: Surface) -> vec4f {
    let material = materials[surface.material];
    if material.lighting.x == 0.0 {
        return material.color;
    }
    let view = normalize(camera.eye.xyz - surface.world);
    // An interpolated normal can vanish between opposite corners: the view direction stands in, never NaN.
    let length_squared = dot(surface.normal, surface.normal);
    var normal = select(view, surface.normal * inverseSqrt(max(length_squared, 1e-20)), length_squared > 1e-20);
    normal = select(-normal, normal, dot(normal, view) >= 0.0);
    var radiance = AMBIENT * material.color.rgb;
    for (var i = 0u; i < camera.frame.z; i++) {
        let toward = normalize(lights[i].position.xyz - surface.world);
        let diffuse = max(dot(normal, toward), 0.0);
        let halfway = normalize(toward + view);
        let highlight = select(0.0, pow(max(dot(normal, halfway), 0.0), material.lighting.z), diffuse > 0.0);
        radiance += lights[i].color.rgb * (material.color.rgb * diffuse + material.lighting.y * highlight);
    }
    return vec4f(radiance, material.color.a);
}
