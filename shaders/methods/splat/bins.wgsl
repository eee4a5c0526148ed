// splat, passes 0 and 1 over the surfaces: absorbance in sixteen bins, of one pixel in 64 by its depth on the frame's scale, of every pixel by
// its place among what those say.
// Variants: none | tiles
import package::helpers::absorbance::absorbance;
@if(tiles) import package::helpers::quantiles::zeta_of;
@if(!tiles) import package::methods::splat::place::place_of;
import package::methods::splat::place::{BINS, in_channels};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@if(!tiles) @group(1) @binding(0) var quantiles: texture_2d<f32>;
@if(!tiles) @group(1) @binding(1) var bilinear: sampler;

struct Bins {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Bins {
    if !visible(surface) {
        discard;
    }
    @if(tiles) let place = 0.5 * zeta_of(surface.depth_linear) + 0.5;
    @else let place = place_of(surface.depth_linear, quantiles, bilinear, surface.position.xy);
    let bin = min(floor(BINS * place), BINS - 1.0);
    let b = absorbance(opacity(surface));
    return Bins(b * in_channels(bin, 0.0), b * in_channels(bin, 4.0), b * in_channels(bin, 8.0), b * in_channels(bin, 12.0));
}
