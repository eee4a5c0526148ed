// wavelet: every fragment's absorbance as a step, in wavelets. Of rank 3 in 32 bits, eighths take a pass of their own.
// Variants: lower | eighths | lower eighths | lower pixel_bounds | eighths pixel_bounds | lower eighths pixel_bounds
import package::helpers::absorbance::absorbance;
@if(pixel_bounds) import package::helpers::range_of_pixel::place_in_pixel;
@if(!pixel_bounds) import package::helpers::range_of_pixel::place_in_frame;
import package::methods::wavelet::haar::{in_bins, step_at};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@if(pixel_bounds) @group(1) @binding(0) var bounds: texture_2d<f32>;

struct Written {
    @if(lower) @location(0) whole: vec4f,
    @if(lower) @location(1) quarters: vec4f,
    @if(eighths && lower) @location(2) near_eighths: vec4f,
    @if(eighths && lower) @location(3) far_eighths: vec4f,
    @if(eighths && !lower) @location(0) near_eighths: vec4f,
    @if(eighths && !lower) @location(1) far_eighths: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Written {
    if !visible(surface) {
        discard;
    }
    @if(pixel_bounds) let place = place_in_pixel(surface.depth_linear, textureLoad(bounds, vec2u(surface.position.xy), 0).xy);
    @if(!pixel_bounds) let place = place_in_frame(surface.depth_linear);
    let c = step_at(in_bins(place), absorbance(opacity(surface)));
    @if(lower && eighths) return Written(c.whole, c.quarters, c.near_eighths, c.far_eighths);
    @if(lower && !eighths) return Written(c.whole, c.quarters);
    @if(!lower) return Written(c.near_eighths, c.far_eighths);
}
