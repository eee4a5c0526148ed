// splat: eq 6's resolve; the transmittance of the whole pixel follows from the absorbance around all knots.
// Variants: none | tinted
import package::helpers::guards::HALF_MAX;
@if(!tinted) import package::helpers::resolve::normalised;
@if(tinted) import package::helpers::resolve::normalised_by_channel;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var absorbances_a: texture_2d<f32>;
@group(0) @binding(3) var absorbances_b: texture_2d<f32>;
@group(0) @binding(4) var absorbances_c: texture_2d<f32>;
@group(0) @binding(5) var absorbances_d: texture_2d<f32>;
@if(tinted) @group(0) @binding(6) var tinted: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let found = textureLoad(sums, pixel, 0);
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(tinted) {
        return normalised_by_channel(found, textureLoad(tinted, pixel, 0).rgb, behind);
    }
    @else {
        let near = textureLoad(absorbances_a, pixel, 0) + textureLoad(absorbances_b, pixel, 0);
        let far = textureLoad(absorbances_c, pixel, 0) + textureLoad(absorbances_d, pixel, 0);
        return normalised(found, exp(-dot(min(near + far, vec4f(HALF_MAX)), vec4f(1.0))), behind);
    }
}
