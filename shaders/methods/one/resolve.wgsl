// One pass: the exported text's resolve; its colour over black alone where light takes a colour.
// Variants: none | wide | frame | wide frame | tinted | wide tinted | frame tinted | wide frame tinted
@if(!frame) import package::helpers::quantiles::around_of;
@if(frame) import package::learned::weight::peelnet_even;
import package::learned::weight::peelnet_noise;
@if(tinted) import package::learned::weight::peelnet_pixel;
@if(!tinted) import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sum_a: texture_2d<f32>;
@group(0) @binding(2) var sum_b: texture_2d<f32>;
@group(0) @binding(3) var sum_c: texture_2d<f32>;
@if(wide) @group(0) @binding(4) var sum_d: texture_2d<f32>;
@if(wide) @group(0) @binding(5) var sum_e: texture_2d<f32>;
@if(wide) @group(0) @binding(6) var sum_f: texture_2d<f32>;
@group(0) @binding(7) var absorbances: texture_2d<f32>;
@if(wide) @group(0) @binding(8) var absorbances_back: texture_2d<f32>;
@if(!frame) @group(0) @binding(9) var quantiles: texture_2d<f32>;
@if(!frame) @group(0) @binding(10) var bilinear: sampler;
@if(tinted) @group(0) @binding(11) var tinted: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(frame) let around = peelnet_even();
    @else let around = around_of(quantiles, bilinear, position.xy);
    let noise = peelnet_noise(pixel);
    let a = textureLoad(sum_a, pixel, 0);
    let b = textureLoad(sum_b, pixel, 0);
    let c = textureLoad(sum_c, pixel, 0);
    let of_sums = textureLoad(absorbances, pixel, 0);
    @if(wide) let d = textureLoad(sum_d, pixel, 0);
    @if(wide) let e = textureLoad(sum_e, pixel, 0);
    @if(wide) let f = textureLoad(sum_f, pixel, 0);
    @if(wide) let of_back = textureLoad(absorbances_back, pixel, 0);
    @if(tinted) {
        @if(wide) let seen = peelnet_pixel(a, b, c, d, e, f, of_sums, of_back, around, noise);
        @else let seen = peelnet_pixel(a, b, c, of_sums, around, noise);
        let passing = textureLoad(tinted, pixel, 0).rgb;
        let coverage = 1.0 - dot(passing, vec3f(1.0 / 3.0));
        return vec4f(seen.rgb * (coverage / max(seen.a, 1.17549435e-38)) + passing * behind, coverage);
    }
    @else {
        @if(wide) return peelnet_resolve(a, b, c, d, e, f, of_sums, of_back, around, noise, behind);
        @else return peelnet_resolve(a, b, c, of_sums, around, noise, behind);
    }
}
