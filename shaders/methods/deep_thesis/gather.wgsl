// deep-thesis (Papakostas 2022), pass 2: eq 6 with the weight that the exported network gives, or the sums as printed.
// Variants: none | printed
@if(printed) import package::helpers::sums::{Sums, printed_sums};
import package::learned::weight::peelnet_fragment;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var statistics: texture_2d<f32>;

@if(!printed)
struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @location(1) alpha: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    let sums = textureLoad(statistics, vec2u(surface.position.xy), 0).xy;
    let weight = peelnet_fragment(surface.depth_linear, sums);
    @if(printed) return printed_sums(color, weight);
    @else return Sums(color * weight, color.a);
}
