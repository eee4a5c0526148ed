// splat, pass 2: the absorbance around each knot. What lies behind the last one is not drawn.
import package::helpers::absorbance::absorbance;
import package::methods::splat::place::{coordinate_of, in_channels, place_of, sixteen};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var quantiles: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;
@group(1) @binding(2) var knots_a: texture_2d<f32>;
@group(1) @binding(3) var knots_b: texture_2d<f32>;
@group(1) @binding(4) var knots_c: texture_2d<f32>;
@group(1) @binding(5) var knots_d: texture_2d<f32>;

struct Statistics {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let place = place_of(surface.depth_linear, quantiles, bilinear, surface.position.xy);
    let knots = sixteen(knots_a, knots_b, knots_c, knots_d, pixel);
    let at = coordinate_of(place, knots);
    let b = absorbance(opacity(surface));
    return Statistics(b * in_channels(at, 0.0), b * in_channels(at, 4.0), b * in_channels(at, 8.0), b * in_channels(at, 12.0));
}
