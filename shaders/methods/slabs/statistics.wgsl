// Slabs, pass 2: the exported text's statistics: each slab's absorbance and mean depth, by adding, and its nearest and farthest fragment,
// by MAX blending.
// Variants: none | small | medium | frame | small frame | medium frame
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_statistics, peelnet_zeta_in};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// The range of the frame needs no pass of its own: it is the whole.
@if(!frame) @group(1) @binding(0) var range: texture_2d<f32>;

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
    let zeta = peelnet_zeta_in(surface.depth_linear, transparent_range());
    @if(frame) let span = vec2f(1.0);
    @else let span = textureLoad(range, vec2u(surface.position.xy), 0).xy;
    let s = peelnet_statistics(opacity(surface), zeta, span);
    @if(small) return Statistics(s.absorbances, s.nearest, s.firsts);
    @elif(medium) return Statistics(s.absorbances, s.nearest, s.farthest);
    @else return Statistics(s.absorbances, s.nearest, s.farthest, s.firsts);
}
