// Slabs, pass 1: the exported text's statistics: each slab's absorbance and mean depth, by adding, and its nearest and farthest fragment,
// by MAX blending.
// Variants: none | small | medium | frame | small frame | medium frame | boxes | small boxes | medium boxes
@if(!frame && !boxes) import package::helpers::quantiles::around_of;
@if(boxes) import package::helpers::quantiles::in_range;
import package::helpers::quantiles::zeta_of;
@if(frame) import package::learned::weight::peelnet_even;
import package::learned::weight::peelnet_statistics;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@if(boxes) @group(1) @binding(0) var range: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(1) var quantiles: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(2) var bilinear: sampler;

struct Statistics {
    @location(0) absorbances: vec4f,
    @location(1) nearest: vec4f,
    @if(small) @location(2) firsts: vec2f,
    @if(!small) @location(2) farthest: vec4f,
    @if(!small && !medium) @location(3) firsts: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let zeta = zeta_of(surface.depth_linear);
    let pixel = vec2u(surface.position.xy);
    @if(frame) let around = peelnet_even();
    @elif(boxes) let around = in_range(textureLoad(range, pixel, 0).xy);
    @else let around = around_of(quantiles, bilinear, surface.position.xy);
    let s = peelnet_statistics(opacity(surface), zeta, around);
    @if(small) return Statistics(s.absorbances, s.nearest, s.firsts);
    @elif(medium) return Statistics(s.absorbances, s.nearest, s.farthest);
    @else return Statistics(s.absorbances, s.nearest, s.farthest, s.firsts);
}
