// mboit8, last pass: eq 6 with the transmittance that follows from the moments.
// Variants: none | own_share_out | tinted
import package::helpers::absorbance::{absorbance, warped_depth};
import package::helpers::estimated::{Sums, sums_of};
import package::methods::mboit::eight::reconstruct::transmittance_from_moments;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var zeroth: texture_2d<f32>;
@group(1) @binding(1) var lower: texture_2d<f32>;
@group(1) @binding(2) var upper: texture_2d<f32>;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let z = warped_depth(surface.depth_linear);
    var total = textureLoad(zeroth, pixel, 0).x;
    var m1234 = textureLoad(lower, pixel, 0);
    var m5678 = textureLoad(upper, pixel, 0);
    @if(own_share_out) {
        let b = absorbance(color.a);
        let z2 = z * z;
        let powers = vec4f(z, z2, z2 * z, z2 * z2);
        total -= b;
        m1234 -= b * powers;
        m5678 -= b * powers.w * powers;
    }
    return sums_of(surface, color, transmittance_from_moments(total, m1234, m5678, z));
}
