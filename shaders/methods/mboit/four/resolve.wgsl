// mboit4: eq 6's resolve; the transmittance of the whole pixel is exp(-total absorbance).
// Variants: none | tinted
@if(!tinted) import package::helpers::resolve::normalised;
@if(tinted) import package::helpers::resolve::normalised_by_channel;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var zeroth: texture_2d<f32>;
@if(tinted) @group(0) @binding(3) var tinted: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let found = textureLoad(sums, pixel, 0);
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(tinted) return normalised_by_channel(found, textureLoad(tinted, pixel, 0).rgb, behind);
    @else return normalised(found, exp(-textureLoad(zeroth, pixel, 0).x), behind);
}
