// mboit4, pass 2: eq 6 with the transmittance that follows from the moments.
// Variants: none | own_share_out | tinted
import package::helpers::absorbance::{absorbance, warped_depth};
import package::helpers::estimated::{Sums, sums_of};
import package::methods::mboit::four::reconstruct::transmittance_from_moments;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var zeroth: texture_2d<f32>;
@group(1) @binding(1) var higher: texture_2d<f32>;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let zeta = warped_depth(surface.depth_linear);
    var total = textureLoad(zeroth, pixel, 0).x;
    var moments = textureLoad(higher, pixel, 0);
    @if(own_share_out) {
        let b = absorbance(color.a);
        let z2 = zeta * zeta;
        total -= b;
        moments -= b * vec4f(zeta, z2, z2 * zeta, z2 * z2);
    }
    return sums_of(surface, color, transmittance_from_moments(total, moments, zeta));
}
