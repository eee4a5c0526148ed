// Learned methods with anchors, pass 2: the exported text's weight of each fragment.
// Variants: none | separate_ends | tinted | separate_ends tinted
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_fragment, peelnet_zeta_in};
import package::scene::camera::camera;
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var moments: texture_2d<f32>;
@group(1) @binding(1) var extent: texture_2d<f32>;

struct Sums {
    @location(0) between: vec4f,
    @if(separate_ends)
    @location(1) ends: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted && !separate_ends) @location(1) covering: vec4f,
    @if(tinted && separate_ends) @location(2) covering: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let zeta = peelnet_zeta_in(surface.depth_linear, transparent_range());
    let m = textureLoad(moments, pixel, 0);
    let e = textureLoad(extent, pixel, 0);
    let w = peelnet_fragment(color.a, zeta, m, e);
    let sum = color * w.x;
    @if(tinted) let covers = vec4f(covering(surface), 0.0);
    @if(separate_ends) {
        let between = select(sum, vec4f(0.0), w.y > 0.0);
        let end = select(vec4f(0.0), sum, w.y > 0.0);
        @if(tinted) return Sums(between, end, covers);
        @else return Sums(between, end);
    }
    @else {
        @if(tinted) return Sums(sum, covers);
        @else return Sums(sum);
    }
}
