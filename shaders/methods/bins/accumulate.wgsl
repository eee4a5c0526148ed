// bins, pass 2: every fragment's absorbance, in its bin and all behind it. With 32-bit targets sixteen bins take two such passes.
// Variants: none | two | two four | pixel_bounds | two pixel_bounds | two four pixel_bounds
@if(pixel_bounds) import package::helpers::range_of_pixel::place_in_pixel;
@if(!pixel_bounds) import package::helpers::range_of_pixel::place_in_frame;
import package::methods::bins::bin::{bin_of, capped_absorbance};
import package::parameters::{BINS, FIRST};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@if(pixel_bounds) @group(1) @binding(0) var bounds: texture_2d<f32>;

// Four bins a target, from bin FIRST on.
struct Bins {
    @location(0) a: vec4f,
    @if(two) @location(1) b: vec4f,
    @if(four) @location(2) c: vec4f,
    @if(four) @location(3) d: vec4f,
}

fn from_bin(b: f32, bin: f32, first: f32) -> vec4f {
    let bins = vec4f(0.0, 1.0, 2.0, 3.0) + first;
    return select(vec4f(0.0), vec4f(b), bins >= vec4f(bin));
}

@fragment
fn fragment_main(surface: Surface) -> Bins {
    if !visible(surface) {
        discard;
    }
    @if(pixel_bounds) let place = place_in_pixel(surface.depth_linear, textureLoad(bounds, vec2u(surface.position.xy), 0).xy);
    @if(!pixel_bounds) let place = place_in_frame(surface.depth_linear);
    let bin = bin_of(place).x;
    let b = capped_absorbance(opacity(surface));
    let first = f32(FIRST);
    let a = from_bin(b, bin, first);
    @if(!two) return Bins(a);
    @if(two && !four) return Bins(a, from_bin(b, bin, first + 4.0));
    @if(four) return Bins(a, from_bin(b, bin, first + 4.0), from_bin(b, bin, first + 8.0), from_bin(b, bin, first + 12.0));
}
