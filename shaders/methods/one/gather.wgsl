// One pass: the exported text's sums of each fragment, and the nearest fragment with its colour.
// Variants: none | wide | frame | wide frame
@if(!frame) import package::helpers::quantiles::around_of;
import package::helpers::quantiles::zeta_of;
@if(frame) import package::learned::weight::peelnet_even;
import package::learned::weight::{peelnet_noise, peelnet_statistics};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@if(!frame) @group(1) @binding(0) var quantiles: texture_2d<f32>;
@if(!frame) @group(1) @binding(1) var bilinear: sampler;

struct Sums {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
    @if(wide) @location(4) e: vec4f,
    @if(wide) @location(5) f: vec4f,
    @if(wide) @location(6) g: vec4f,
    @if(wide) @location(7) h: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    let pixel = vec2u(surface.position.xy);
    @if(frame) let around = peelnet_even();
    @else let around = around_of(quantiles, bilinear, surface.position.xy);
    // Not multiplied by the opacity.
    let rgb = color.rgb / max(color.a, 1e-6);
    let s = peelnet_statistics(color.a, rgb, zeta_of(surface.depth_linear), around, peelnet_noise(pixel));
    @if(wide) return Sums(s.sum_a, s.sum_b, s.sum_c, s.sum_d, s.sum_e, s.sum_f, s.absorbances, s.absorbances_back);
    @else return Sums(s.sum_a, s.sum_b, s.sum_c, s.absorbances);
}
