// mboit-trig, last pass: eq 6 with the transmittance that follows from the moments.
// Variants: none | upper | own_share_out | own_share_out upper | tinted | tinted upper
import package::helpers::absorbance::{absorbance, warped_depth};
import package::helpers::estimated::{Sums, sums_of};
import package::methods::mboit::trigonometric::circle::{angle, times, turn};
import package::methods::mboit::trigonometric::reconstruct::transmittance_from_moments;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var zeroth: texture_2d<f32>;
@group(1) @binding(1) var lower: texture_2d<f32>;
@if(upper) @group(1) @binding(2) var upper: texture_2d<f32>;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let phi = angle(warped_depth(surface.depth_linear));
    var total = textureLoad(zeroth, pixel, 0).x;
    var m12 = textureLoad(lower, pixel, 0);
    var m3 = vec2f(0.0);
    @if(upper) m3 = textureLoad(upper, pixel, 0).xy;
    @if(own_share_out) {
        let b = absorbance(color.a);
        let first = turn(phi);
        let second = times(first, first);
        total -= b;
        m12 -= b * vec4f(first, second);
        m3 -= b * times(second, first);
    }
    return sums_of(surface, color, transmittance_from_moments(total, m12, m3, phi));
}
