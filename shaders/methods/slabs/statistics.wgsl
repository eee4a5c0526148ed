// slabs, pass 2: each slab's absorbance and mean depth, by adding, and its nearest and farthest fragment, by MAX blending.
// Variants: none | few
import package::helpers::absorbance::warped_depth;
import package::methods::slabs::slab::{EMPTY, FAINT, halves_of, in_slab, place_of};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var range: texture_2d<f32>;

struct Statistics {
    @location(0) absorbances: vec4f,
    // Absorbance times depth in the slab: of all slabs, or of the two nearest.
    @if(!few) @location(1) firsts: vec4f,
    @if(few) @location(1) firsts: vec2f,
    @location(2) nearest: vec4f,
    // Of the three nearest slabs, or of the nearest.
    @if(!few) @location(3) farthest: vec2f,
    @if(!few) @location(4) farthest_third: f32,
    @if(few) @location(3) farthest: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let alpha = opacity(surface);
    let ends = textureLoad(range, vec2u(surface.position.xy), 0).xy;
    let place = place_of(alpha, warped_depth(surface.depth_linear), ends);
    let halves = select(halves_of(vec2f(place.near, place.far)), vec2f(EMPTY), alpha < FAINT);
    let absorbances = in_slab(place.absorbance, place.slab, 0.0);
    let firsts = in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let nearest = in_slab(halves.x, place.slab, EMPTY);
    let farthest = in_slab(halves.y, place.slab, EMPTY);
    @if(few) return Statistics(absorbances, firsts.xy, nearest, farthest.x);
    @else return Statistics(absorbances, firsts, nearest, farthest.xy, farthest.z);
}
