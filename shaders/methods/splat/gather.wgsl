// splat, pass 3: eq 6 with the transmittance that follows from the absorbance around the knots, without the fragment's own.
// Variants: none | tinted
import package::helpers::absorbance::absorbance;
import package::helpers::estimated::{Sums, sums_of};
import package::helpers::guards::HALF_MAX;
import package::methods::splat::place::{coordinate_of, in_channels, place_of, sixteen};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var quantiles: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;
@group(1) @binding(2) var knots_a: texture_2d<f32>;
@group(1) @binding(3) var knots_b: texture_2d<f32>;
@group(1) @binding(4) var knots_c: texture_2d<f32>;
@group(1) @binding(5) var knots_d: texture_2d<f32>;
@group(1) @binding(6) var absorbances_a: texture_2d<f32>;
@group(1) @binding(7) var absorbances_b: texture_2d<f32>;
@group(1) @binding(8) var absorbances_c: texture_2d<f32>;
@group(1) @binding(9) var absorbances_d: texture_2d<f32>;

// The share of what lies around each of four knots, from a first one, in front of a coordinate: its density falls linearly from the knot to its
// neighbours, and the share is the integral of that.
fn shares_in_front(coordinate: f32, first: f32) -> vec4f {
    let d = clamp(vec4f(coordinate - first) - vec4f(0.0, 1.0, 2.0, 3.0), vec4f(-1.0), vec4f(1.0));
    return 0.5 + d - 0.5 * d * abs(d);
}

// What others have around four knots. Sums of 16-bit targets may become infinite.
fn others(sums: texture_2d<f32>, pixel: vec2u, own: vec4f) -> vec4f {
    return max(min(textureLoad(sums, pixel, 0), vec4f(HALF_MAX)) - own, vec4f(0.0));
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let place = place_of(surface.depth_linear, quantiles, bilinear, surface.position.xy);
    let knots = sixteen(knots_a, knots_b, knots_c, knots_d, pixel);
    let at = coordinate_of(place, knots);
    let b = absorbance(color.a);
    // What lies around the first knot and the last is on one side of them.
    var first = shares_in_front(at, 0.0);
    first.x = 2.0 * first.x - 1.0;
    var last = shares_in_front(at, 12.0);
    last.w *= 2.0;
    var in_front = dot(others(absorbances_a, pixel, b * in_channels(at, 0.0)), first);
    in_front += dot(others(absorbances_b, pixel, b * in_channels(at, 4.0)), shares_in_front(at, 4.0));
    in_front += dot(others(absorbances_c, pixel, b * in_channels(at, 8.0)), shares_in_front(at, 8.0));
    in_front += dot(others(absorbances_d, pixel, b * in_channels(at, 12.0)), last);
    return sums_of(surface, color, exp(-in_front));
}
