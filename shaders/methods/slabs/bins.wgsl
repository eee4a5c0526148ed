// Slabs over the pixel's own range, pass 1 of three over the surfaces: absorbance in sixteen bins among the quantiles around the pixel.
import package::helpers::quantiles::{around_of, zeta_of};
import package::learned::weight::{peelnet_absorbance, peelnet_place_among};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var quantiles: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

struct Bins {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
}

fn of_bin(b: f32, bin: f32, first: f32) -> vec4f {
    let bins = vec4f(first) + vec4f(0.0, 1.0, 2.0, 3.0);
    return select(vec4f(0.0), vec4f(b), bins == vec4f(bin));
}

@fragment
fn fragment_main(surface: Surface) -> Bins {
    if !visible(surface) {
        discard;
    }
    let around = around_of(quantiles, bilinear, surface.position.xy);
    let place = peelnet_place_among(0.5 * zeta_of(surface.depth_linear) + 0.5, around);
    let bin = min(floor(16.0 * place), 15.0);
    let b = peelnet_absorbance(opacity(surface));
    return Bins(of_bin(b, bin, 0.0), of_bin(b, bin, 4.0), of_bin(b, bin, 8.0), of_bin(b, bin, 12.0));
}
