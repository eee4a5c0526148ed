// mboit-trig, pass 1: absorbance and its trigonometric moments.
// Variants: none | upper
import package::helpers::absorbance::{absorbance, warped_depth};
import package::methods::mboit::trigonometric::circle::{angle, times, turn};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Moments {
    @location(0) zeroth: f32,
    // First and second.
    @location(1) lower: vec4f,
    // The third.
    @if(upper) @location(2) upper: vec2f,
}

@fragment
fn fragment_main(surface: Surface) -> Moments {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface));
    let first = turn(angle(warped_depth(surface.depth_linear)));
    let second = times(first, first);
    @if(!upper) return Moments(b, b * vec4f(first, second));
    @if(upper) return Moments(b, b * vec4f(first, second), b * times(second, first));
}
