// wavelet, pass 2: eq 6 with the transmittance that follows from the wavelets, between the averages of two bins.
// Variants: none | own_share_out
import package::helpers::absorbance::absorbance;
import package::helpers::guards::WEIGHT_FLOOR;
import package::methods::wavelet::haar::{Coefficients, average, in_bins};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var whole: texture_2d<f32>;
@group(1) @binding(1) var quarters: texture_2d<f32>;
@group(1) @binding(2) var near: texture_2d<f32>;
@group(1) @binding(3) var far: texture_2d<f32>;

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
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let c = Coefficients(
        textureLoad(whole, pixel, 0),
        textureLoad(quarters, pixel, 0),
        textureLoad(near, pixel, 0),
        textureLoad(far, pixel, 0),
    );
    let position = in_bins(surface);
    let bin = i32(position);
    let t = fract(position);
    var in_front = mix(average(c, bin - 1), average(c, bin), t);
    // The fragment itself: nothing before its bin, and what of its bin lies behind it.
    @if(own_share_out) in_front -= absorbance(color.a) * t * (1.0 - t);
    let weight = clamp(exp(-in_front), WEIGHT_FLOOR, 1.0);
    return Sums(color * weight, color.a);
}
