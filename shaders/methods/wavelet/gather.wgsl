// wavelet, last pass: eq 6 with the transmittance that follows from the wavelets, between the averages of two bins.
// Variants: none | own_share_out | eighths | own_share_out pixel_bounds | eighths own_share_out pixel_bounds
import package::helpers::absorbance::absorbance;
import package::helpers::guards::WEIGHT_FLOOR;
@if(pixel_bounds) import package::helpers::range_of_pixel::place_in_pixel;
@if(!pixel_bounds) import package::helpers::range_of_pixel::place_in_frame;
import package::helpers::sums::{Sums, sums_of};
import package::methods::wavelet::haar::{Coefficients, average, in_bins};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var whole: texture_2d<f32>;
@group(1) @binding(1) var quarters: texture_2d<f32>;
@if(eighths) @group(1) @binding(2) var near_eighths: texture_2d<f32>;
@if(eighths) @group(1) @binding(3) var far_eighths: texture_2d<f32>;
@if(pixel_bounds) @group(1) @binding(4) var bounds: texture_2d<f32>;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    var c = Coefficients(
        textureLoad(whole, pixel, 0),
        textureLoad(quarters, pixel, 0),
        vec4f(0.0),
        vec4f(0.0),
    );
    @if(eighths) {
        c.near_eighths = textureLoad(near_eighths, pixel, 0);
        c.far_eighths = textureLoad(far_eighths, pixel, 0);
    }
    @if(pixel_bounds) let place = place_in_pixel(surface.depth_linear, textureLoad(bounds, pixel, 0).xy);
    @if(!pixel_bounds) let place = place_in_frame(surface.depth_linear);
    let position = in_bins(place);
    let bin = i32(position);
    let t = fract(position);
    var in_front = mix(average(c, bin - 1), average(c, bin), t);
    // The fragment itself: nothing before its bin, and what of its bin lies behind it.
    @if(own_share_out) in_front -= absorbance(color.a) * t * (1.0 - t);
    let weight = clamp(exp(-in_front), WEIGHT_FLOOR, 1.0);
    return sums_of(color * weight, vec3f(color.a));
}
