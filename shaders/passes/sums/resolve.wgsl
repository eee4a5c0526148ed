// The sums that a method of weighted blending makes of a pixel, as they are: to look at its weights.
// Variants: none | separate_ends

// Binding 0 is C_0.
@group(0) @binding(1) var sums: texture_2d<f32>;
@if(separate_ends) @group(0) @binding(2) var ends: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    var all = textureLoad(sums, pixel, 0);
    @if(separate_ends) all += textureLoad(ends, pixel, 0);
    return all;
}
