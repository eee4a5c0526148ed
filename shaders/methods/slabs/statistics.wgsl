// Slabs, pass 2: the exported text's statistics: each slab's absorbance and mean depth, by adding, and its nearest and farthest fragment,
// by MAX blending.
// Variants: none | small | medium | frame | small frame | medium frame | boxes | small boxes | medium boxes
import package::helpers::slabs::zeta_of;
@if(frame) import package::helpers::slabs::in_frame;
@if(boxes) import package::helpers::slabs::in_boxes;
import package::learned::weight::peelnet_statistics;
@if(!frame && !boxes) import package::learned::weight::peelnet_in_pixel;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// The depth of the frame needs no pass of its own.
@if(!frame) @group(1) @binding(0) var range: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(1) var bins_front: texture_2d<f32>;
@if(!frame && !boxes) @group(1) @binding(2) var bins_back: texture_2d<f32>;

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
    @if(frame) let t = in_frame(zeta);
    @elif(boxes) let t = in_boxes(zeta, textureLoad(range, pixel, 0).xy);
    @else let t = peelnet_in_pixel(
        zeta,
        textureLoad(bins_front, pixel, 0),
        textureLoad(bins_back, pixel, 0),
        textureLoad(range, pixel, 0).xy,
    );
    let s = peelnet_statistics(opacity(surface), t);
    @if(small) return Statistics(s.absorbances, s.nearest, s.firsts);
    @elif(medium) return Statistics(s.absorbances, s.nearest, s.farthest);
    @else return Statistics(s.absorbances, s.nearest, s.farthest, s.firsts);
}
