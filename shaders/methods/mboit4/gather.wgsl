// mboit4, pass 2: eq 6 with the transmittance that follows from the moments.
// Variants: none | own_share_out | tinted
import package::helpers::absorbance::{absorbance, warped_depth};
import package::helpers::guards::WEIGHT_FLOOR;
import package::methods::mboit4::reconstruct::transmittance_from_moments;
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var zeroth: texture_2d<f32>;
@group(1) @binding(1) var higher: texture_2d<f32>;

struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted) @location(1) covering: vec4f,
}

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
    let weight = max(transmittance_from_moments(total, moments, zeta), WEIGHT_FLOOR);
    @if(tinted) return Sums(color * weight, vec4f(covering(surface), 0.0));
    @else return Sums(color * weight);
}
