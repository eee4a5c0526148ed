// Textures. A pipeline binds those that its material has.
@if(mapped) @group(2) @binding(0) var map_sampler: sampler;
@if(color_map) @group(2) @binding(1) var color_map: texture_2d<f32>;
@if(normal_map) @group(2) @binding(2) var normal_map: texture_2d<f32>;
@if(metallic_roughness_map) @group(2) @binding(3) var metallic_roughness_map: texture_2d<f32>;
@if(occlusion_map) @group(2) @binding(4) var occlusion_map: texture_2d<f32>;
@if(emissive_map) @group(2) @binding(5) var emissive_map: texture_2d<f32>;

// How UVs change from pixel to pixel. Derivatives exist in uniform control flow only, and textures are fetched after
// hidden fragments have left.
@if(mapped) var<private> uv_across: vec2f;
@if(mapped) var<private> uv_down: vec2f;

@if(mapped)
fn remember_footprint(uv: vec2f) {
    uv_across = dpdx(uv);
    uv_down = dpdy(uv);
}

@if(color_map)
fn color_at(uv: vec2f) -> vec4f {
    return textureSampleGrad(color_map, map_sampler, uv, uv_across, uv_down);
}

// In tangent space. Bytes stand for (byte - 128) / 127, so that (128, 128, 255) is flat and not nearly so.
@if(normal_map)
fn normal_at(uv: vec2f) -> vec3f {
    let bytes = textureSampleGrad(normal_map, map_sampler, uv, uv_across, uv_down).xyz * 255.0;
    return (bytes - 128.0) / 127.0;
}

// x: roughness, y: metallic.
@if(metallic_roughness_map)
fn roughness_metallic_at(uv: vec2f) -> vec2f {
    return textureSampleGrad(metallic_roughness_map, map_sampler, uv, uv_across, uv_down).yz;
}

@if(occlusion_map)
fn occlusion_at(uv: vec2f) -> f32 {
    return textureSampleGrad(occlusion_map, map_sampler, uv, uv_across, uv_down).x;
}

@if(emissive_map)
fn emission_at(uv: vec2f) -> vec3f {
    return textureSampleGrad(emissive_map, map_sampler, uv, uv_across, uv_down).rgb;
}
