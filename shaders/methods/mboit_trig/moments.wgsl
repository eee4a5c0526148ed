// mboit-trig, pass 1: absorbance and its trigonometric moments. Four moments in 32 bits take two such passes.
// Variants: lower | lower upper | upper
import package::helpers::absorbance::{absorbance, warped_depth};
import package::methods::mboit_trig::circle::{angle, times, turn};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Moments {
    @if(lower) @location(0) zeroth: f32,
    // First and second.
    @if(lower) @location(1) lower: vec4f,
    // Third and, where there is one, fourth.
    @if(upper && lower) @location(2) upper: vec4f,
    @if(upper && !lower) @location(0) upper: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Moments {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface));
    let first = turn(angle(warped_depth(surface.depth_linear)));
    let second = times(first, first);
    @if(lower && !upper) return Moments(b, b * vec4f(first, second));
    @if(upper) {
        let higher = b * vec4f(times(second, first), times(second, second));
        @if(lower) return Moments(b, b * vec4f(first, second), higher);
        @else return Moments(higher);
    }
}
