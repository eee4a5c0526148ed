// bins, pass 3: eq 6 with the transmittance that follows from the absorbance between the ends of the fragment's bin.
// Variants: none | two | two four | pixel_bounds | two pixel_bounds | two four pixel_bounds
import package::helpers::guards::WEIGHT_FLOOR;
@if(pixel_bounds) import package::helpers::range_of_pixel::place_in_pixel;
@if(!pixel_bounds) import package::helpers::range_of_pixel::place_in_frame;
import package::helpers::sums::{Sums, sums_of};
import package::methods::bins::bin::{bin_of, capped_absorbance};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var bins_a: texture_2d<f32>;
@if(two) @group(1) @binding(1) var bins_b: texture_2d<f32>;
@if(four) @group(1) @binding(2) var bins_c: texture_2d<f32>;
@if(four) @group(1) @binding(3) var bins_d: texture_2d<f32>;
@if(pixel_bounds) @group(1) @binding(4) var bounds: texture_2d<f32>;

// Absorbance up to the far end of a bin; nothing before the first.
fn up_to(pixel: vec2u, bin: i32) -> f32 {
    if bin < 0 {
        return 0.0;
    }
    var four = textureLoad(bins_a, pixel, 0);
    @if(two) {
        if bin >= 4 {
            four = textureLoad(bins_b, pixel, 0);
        }
    }
    @if(four) {
        if bin >= 8 {
            four = textureLoad(bins_c, pixel, 0);
        }
        if bin >= 12 {
            four = textureLoad(bins_d, pixel, 0);
        }
    }
    return four[bin & 3];
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    @if(pixel_bounds) let place = place_in_pixel(surface.depth_linear, textureLoad(bounds, pixel, 0).xy);
    @if(!pixel_bounds) let place = place_in_frame(surface.depth_linear);
    let bin = bin_of(place);
    let before = up_to(pixel, i32(bin.x) - 1);
    let after = up_to(pixel, i32(bin.x));
    // Without the fragment's own share, which its bin holds at its far end.
    let in_front = before + (after - before - capped_absorbance(color.a)) * bin.y;
    let weight = clamp(exp(-in_front), WEIGHT_FLOOR, 1.0);
    return sums_of(color * weight, vec3f(color.a));
}
