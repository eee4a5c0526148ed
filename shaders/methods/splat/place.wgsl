// Where in its pixel a fragment lies: its place among the quantiles around the pixel, and its coordinate among the pixel's knots. Sixteen knots
// reach from the nearest fragment to the depth behind which nothing is seen.
import package::helpers::quantiles::{around_of, zeta_of};
import package::learned::weight::peelnet_place_among;

// Bins of places.
const BINS: f32 = 16.0;
// Between coincident knots nothing lies. Others are 1/255 apart at least.
const LEAST: f32 = 1e-6;

// Among the quantiles of what is seen around the pixel, 0 .. 1.
fn place_of(depth_linear: f32, quantiles: texture_2d<f32>, bilinear: sampler, position: vec2f) -> f32 {
    let around = around_of(quantiles, bilinear, position);
    return peelnet_place_among(0.5 * zeta_of(depth_linear) + 0.5, around);
}

// Sixteen values of a pixel, of four textures.
fn sixteen(a: texture_2d<f32>, b: texture_2d<f32>, c: texture_2d<f32>, d: texture_2d<f32>, pixel: vec2u) -> mat4x4f {
    return mat4x4f(textureLoad(a, pixel, 0), textureLoad(b, pixel, 0), textureLoad(c, pixel, 0), textureLoad(d, pixel, 0));
}

// How many of four intervals lie in front of a place, of that in which it is the part.
fn passed(place: f32, begins: vec4f, ends: vec4f) -> f32 {
    let parts = (vec4f(place) - begins) / max(ends - begins, vec4f(LEAST));
    return dot(clamp(parts, vec4f(0.0), vec4f(1.0)), vec4f(1.0));
}

// 0 .. 15: one from each knot to the next, and linear in the place between them. knots: of four textures; they ascend.
fn coordinate_of(place: f32, knots: mat4x4f) -> f32 {
    let near = passed(place, knots[0], vec4f(knots[0].yzw, knots[1].x)) + passed(place, knots[1], vec4f(knots[1].yzw, knots[2].x));
    let far = passed(place, knots[2], vec4f(knots[2].yzw, knots[3].x)) + passed(place, knots[3], vec4f(knots[3].yzw, 2.0));
    return min(near + far, 15.0);
}

// The shares of four channels, from a first one, in what lies at a coordinate: those of the two nearest, which are 1 together.
fn in_channels(coordinate: f32, first: f32) -> vec4f {
    let channels = vec4f(first) + vec4f(0.0, 1.0, 2.0, 3.0);
    return max(1.0 - abs(channels - vec4f(coordinate)), vec4f(0.0));
}
