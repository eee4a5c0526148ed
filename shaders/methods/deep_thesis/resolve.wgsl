// deep-thesis: the exported text's resolve.
// Variants: none | full_sums
@if(full_sums) import package::learned::weight::peelnet_composite;
@if(!full_sums) import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var transmittances: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let found = textureLoad(sums, pixel, 0);
    let transmittance = textureLoad(transmittances, pixel, 0).x;
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(full_sums) return peelnet_composite(found, 1.0 - transmittance, vec3f(transmittance), behind);
    @if(!full_sums) return peelnet_resolve(found, transmittance, behind);
}
