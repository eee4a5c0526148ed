// splat, between passes 1 and 2: the pixel's knots, and the depth behind which nothing is seen.
// Loops: 4: sixteen bins; again, four parts of each, and four knots at once.
import package::helpers::quantiles::around_of;
import package::learned::weight::peelnet_even;
import package::methods::splat::place::{BINS, sixteen};
import package::scene::camera::Camera;

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var quantiles: texture_2d<f32>;
@group(0) @binding(2) var bilinear: sampler;
@group(0) @binding(3) var bins_a: texture_2d<f32>;
@group(0) @binding(4) var bins_b: texture_2d<f32>;
@group(0) @binding(5) var bins_c: texture_2d<f32>;
@group(0) @binding(6) var bins_d: texture_2d<f32>;

// What is let through where nothing is seen any more: no step of an 8-bit display.
const UNSEEN: f32 = 1.0 / 255.0;
// The last depth is found by a logarithm and an exponential, and compared with depths that were not: a share of it, and steps of a window depth
// near 1, that no rounding reaches.
const ROUNDED: f32 = 1.00002;
const STEPS: f32 = 2.5e-7;

// Parts of a bin between which what is seen counts as spread evenly.
const PARTS: u32 = 4;

struct Knots {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
    @builtin(frag_depth) limit: f32,
}

// The share of what is seen that lies before four knots, from a first one: behind the k-th is ((15 - k) / 15)^2. Where little light is left it
// counts less, and knots may be further apart.
fn shares_before(first: f32) -> vec4f {
    let rest = 1.0 - (vec4f(first) + vec4f(0.0, 1.0, 2.0, 3.0)) / 15.0;
    return 1.0 - rest * rest;
}

// The density where two bins meet: their mean, but not so much that what is seen would decrease in one of them (Fritsch and Carlson 1980).
fn density_between(near: f32, far: f32) -> f32 {
    return min(0.5 * (near + far), 3.0 * min(near, far));
}

// The depth, 0 .. 1 of the frame's, of a place among quantiles: peelnet_place_among turned round.
fn depth_of(place: f32, around: vec4f) -> f32 {
    let shares = peelnet_even();
    let begin = vec4f(0.0, shares.xyz);
    let parts = clamp((vec4f(place) - begin) / (shares - begin), vec4f(0.0), vec4f(1.0));
    let last = clamp((place - shares.w) / (1.0 - shares.w), 0.0, 1.0);
    return dot(parts, around - vec4f(0.0, around.xyz)) + last * (1.0 - around.w);
}

// The window depth of a depth on the frame's scale.
fn window_depth_of(depth: f32) -> f32 {
    let gaps = camera.gaps;
    var zeta = depth * (2.0 - (gaps.y - gaps.x) - (gaps.w - gaps.z)) - 1.0;
    zeta += select(0.0, gaps.y - gaps.x, zeta > gaps.x);
    zeta += select(0.0, gaps.w - gaps.z, zeta > gaps.z);
    let linear = exp((zeta + 1.0) / max(camera.warp_scale, 1e-6)) * camera.warp_near * ROUNDED;
    let far = camera.window_depth_at_infinity;
    let near = camera.clip_from_world[3].w - camera.clip_from_world[3].z / far;
    return clamp(far - far * near / linear + STEPS, 0.0, 1.0);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> Knots {
    let pixel = vec2u(position.xy);
    let bins = sixteen(bins_a, bins_b, bins_c, bins_d, pixel);
    var seen = mat4x4f();
    var through = 1.0;
    var begin = BINS;
    // The end of a bin, and not a depth in it: what hides the rest may be one surface at that end.
    var end = BINS;
    for (var k = 0u; k < 16u; k++) {
        let behind = through * exp(-bins[k / 4u][k % 4u]);
        seen[k / 4u][k % 4u] = through - behind;
        begin = select(begin, min(begin, f32(k)), behind < through);
        end = select(end, min(end, f32(k + 1u)), behind <= UNSEEN);
        through = behind;
    }
    let shares = (1.0 - through) * mat4x4f(shares_before(0.0), shares_before(4.0), shares_before(8.0), shares_before(12.0));
    var knots = mat4x4f();
    var before = 0.0;
    var near = seen[0].x;
    for (var k = 0u; k < 16u; k++) {
        // What is seen before a depth in the bin is a cubic, which ascends from one bin to the next without a jump of its slope.
        let all = seen[k / 4u][k % 4u];
        let next = min(k + 1u, 15u);
        let far = density_between(all, seen[next / 4u][next % 4u]);
        let nearer = before;
        for (var part = 1u; part <= PARTS; part++) {
            let x = f32(part) / f32(PARTS);
            let now = nearer + all * x * x * (3.0 - 2.0 * x) + near * x * (1.0 - x) * (1.0 - x) - far * x * x * (1.0 - x);
            let step = max(now - before, 1e-9);
            for (var four = 0u; four < 4u; four++) {
                knots[four] += clamp((shares[four] - vec4f(before)) / step, vec4f(0.0), vec4f(1.0));
            }
            before = now;
        }
        near = far;
    }
    let around = around_of(quantiles, bilinear, position.xy);
    let limit = window_depth_of(depth_of(end / BINS, around));
    knots *= 1.0 / (BINS * f32(PARTS));
    knots[0].x = floor(begin / BINS * 255.0) / 255.0;
    knots[3].w = ceil(end / BINS * 255.0) / 255.0;
    return Knots(knots[0], knots[1], knots[2], knots[3], select(limit, 1.0, end == BINS));
}
