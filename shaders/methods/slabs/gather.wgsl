// Slabs, pass 2: the exported text's weight of each fragment.
// Variants: none | small | medium | tinted | small tinted | medium tinted | frame | small frame | medium frame | tinted frame | small tinted frame | medium tinted frame | boxes | small boxes | medium boxes | tinted boxes | small tinted boxes | medium tinted boxes
@if(!frame && !boxes) import package::helpers::quantiles::around_of;
@if(boxes) import package::helpers::quantiles::in_range;
import package::helpers::quantiles::zeta_of;
@if(frame) import package::learned::weight::peelnet_even;
import package::learned::weight::peelnet_fragment;
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var absorbances: texture_2d<f32>;
@group(1) @binding(1) var nearest: texture_2d<f32>;
@if(!small) @group(1) @binding(2) var farthest: texture_2d<f32>;
@if(!medium) @group(1) @binding(3) var firsts: texture_2d<f32>;
@if(boxes) @group(1) @binding(4) var range: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(5) var quantiles: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(6) var bilinear: sampler;

struct Sums {
    @location(0) sum: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted) @location(1) covering: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let zeta = zeta_of(surface.depth_linear);
    @if(frame) let around = peelnet_even();
    @elif(boxes) let around = in_range(textureLoad(range, pixel, 0).xy);
    @else let around = around_of(quantiles, bilinear, surface.position.xy);
    let a = textureLoad(absorbances, pixel, 0);
    let n = textureLoad(nearest, pixel, 0);
    @if(!small) let f = textureLoad(farthest, pixel, 0);
    @if(small) let w = peelnet_fragment(color.a, zeta, around, a, n, textureLoad(firsts, pixel, 0).xy).x;
    @elif(medium) let w = peelnet_fragment(color.a, zeta, around, a, n, f).x;
    @else let w = peelnet_fragment(color.a, zeta, around, a, n, f, textureLoad(firsts, pixel, 0)).x;
    @if(tinted) return Sums(color * w, vec4f(covering(surface), 0.0));
    @else return Sums(color * w);
}
