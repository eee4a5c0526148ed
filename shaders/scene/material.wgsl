// What materials are made of. The vertex shader hands on what every fragment reads: a storage buffer read at every fragment costs more.

// As `MaterialData` in peelnet_render, geometry/uniforms.rs.
struct Material {
    // Linear RGB and alpha.
    color: vec4f,
    // Blinn-Phong: strength of the highlight and its exponent. Physically based: metallic and roughness.
    specular_or_metallic: f32,
    shininess_or_roughness: f32,
    alpha_cutoff: f32,
    layer: f32,
    // Radiance emitted beyond what the opacity covers, linear RGB.
    emission: vec3f,
    // Share of the normal map's slopes.
    normal_scale: f32,
    // Share of the light behind that passes through what the opacity covers, linear RGB.
    transmission: vec3f,
    // Share of the occlusion map.
    occlusion_strength: f32,
}

@group(0) @binding(1) var<storage, read> materials: array<Material>;
