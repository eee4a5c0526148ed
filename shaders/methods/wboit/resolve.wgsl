// Eq 6's resolve, shared by every method that accumulates (sum C w, sum alpha w) and T.
// Variants: none | packed | tinted
@if(!tinted) import package::helpers::resolve::normalised;
@if(tinted) import package::helpers::resolve::normalised_by_channel;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@if(!packed) @group(0) @binding(2) var transmittances: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let behind = textureLoad(background, pixel, 0).rgb;
    let found = textureLoad(sums, pixel, 0);
    @if(packed) return normalised(found.xxxy, found.w, behind);
    @if(tinted) return normalised_by_channel(found, textureLoad(transmittances, pixel, 0).rgb, behind);
    @if(!packed && !tinted) return normalised(found, textureLoad(transmittances, pixel, 0).x, behind);
}
