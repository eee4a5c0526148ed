// Slabs, pass 3: the exported text's weight of each fragment.
// Variants: none | few | apart | tinted | few tinted | apart tinted | frame | few frame | apart frame | tinted frame | few tinted frame | apart tinted frame
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_fragment, peelnet_zeta_in};
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var absorbances: texture_2d<f32>;
@group(1) @binding(1) var nearest: texture_2d<f32>;
@group(1) @binding(2) var farthest: texture_2d<f32>;
@group(1) @binding(3) var firsts: texture_2d<f32>;
@if(!frame) @group(1) @binding(4) var range: texture_2d<f32>;

struct Sums {
    @location(0) between: vec4f,
    @if(apart) @location(1) ends: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted && !apart) @location(1) covering: vec4f,
    @if(tinted && apart) @location(2) covering: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let zeta = peelnet_zeta_in(surface.depth_linear, transparent_range());
    @if(frame) let span = vec2f(1.0);
    @else let span = textureLoad(range, pixel, 0).xy;
    let a = textureLoad(absorbances, pixel, 0);
    let n = textureLoad(nearest, pixel, 0);
    let b = textureLoad(firsts, pixel, 0).xy;
    @if(few) let f = textureLoad(farthest, pixel, 0).x;
    @else let f = textureLoad(farthest, pixel, 0);
    let w = peelnet_fragment(color.a, zeta, span, a, n, f, b);
    let sum = color * w.x;
    @if(tinted) let covers = vec4f(covering(surface), 0.0);
    @if(apart) {
        let known = w.y > 0.0;
        let between = select(sum, vec4f(0.0), known);
        let ends = select(vec4f(0.0), sum, known);
        @if(tinted) return Sums(between, ends, covers);
        @else return Sums(between, ends);
    }
    @else {
        @if(tinted) return Sums(sum, covers);
        @else return Sums(sum);
    }
}
