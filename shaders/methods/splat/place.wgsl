// Where in its pixel a fragment lies: its place among the quantiles around the pixel, and its slab. Eight slabs lie between nine borders: the
// nearest fragment, seven places and the depth behind which nothing is seen.
import package::helpers::quantiles::{around_of, zeta_of};
import package::learned::weight::peelnet_place_among;

// Bins of places.
const BINS: f32 = 16.0;

struct Slab {
    // 0, the nearest, to 7.
    number: f32,
    // In the slab, 0 .. 1.
    inside: f32,
}

// Among the quantiles of what is seen around the pixel, 0 .. 1.
fn place_of(depth_linear: f32, quantiles: texture_2d<f32>, bilinear: sampler, position: vec2f) -> f32 {
    let around = around_of(quantiles, bilinear, position);
    return peelnet_place_among(0.5 * zeta_of(depth_linear) + 0.5, around);
}

// near, far: the seven borders between slabs, the last of which stands twice. ends: the first border and the last.
fn slab_of(place: f32, near: vec4f, far: vec4f, ends: vec2f) -> Slab {
    let passed_near = select(vec4f(0.0), vec4f(1.0), vec4f(place) >= near);
    let passed_far = select(vec3f(0.0), vec3f(1.0), vec3f(place) >= far.xyz);
    let number = dot(passed_near, vec4f(1.0)) + dot(passed_far, vec3f(1.0));
    // The last border passed, and the first that is not. They ascend.
    let begins = max(select(vec4f(ends.x), near, passed_near > vec4f(0.5)), vec4f(select(vec3f(ends.x), far.xyz, passed_far > vec3f(0.5)), ends.x));
    let next = min(select(vec4f(ends.y), near, passed_near < vec4f(0.5)), vec4f(select(vec3f(ends.y), far.xyz, passed_far < vec3f(0.5)), ends.y));
    let begin = max(max(begins.x, begins.y), max(begins.z, begins.w));
    let end = min(min(next.x, next.y), min(next.z, next.w));
    return Slab(number, clamp((place - begin) / max(end - begin, 1e-6), 0.0, 1.0));
}

// What a fragment adds to four of eight channels, from a first one.
fn in_channels(value: f32, number: f32, first: f32) -> vec4f {
    let channels = vec4f(first) + vec4f(0.0, 1.0, 2.0, 3.0);
    return select(vec4f(0.0), vec4f(value), channels == vec4f(number));
}
