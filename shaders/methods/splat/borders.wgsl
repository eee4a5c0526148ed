// splat, between passes 1 and 2: the borders of the pixel's slabs, and the depth behind which nothing is seen.
// Loops: 1: sixteen bins.
import package::helpers::quantiles::around_of;
import package::learned::weight::peelnet_even;
import package::methods::splat::place::BINS;
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

struct Borders {
    @location(0) near: vec4f,
    @location(1) far: vec4f,
    @location(2) ends: vec2f,
    @builtin(frag_depth) limit: f32,
}

// The share of what is seen that lies before a border: of n slabs the rest is ((n - k) / n)^2. Where little light is left it counts less, and
// a slab may hold the more of it.
fn share_before(border: vec4f) -> vec4f {
    let rest = 1.0 - border / 8.0;
    return 1.0 - rest * rest;
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
fn fragment_main(@builtin(position) position: vec4f) -> Borders {
    let pixel = vec2u(position.xy);
    let bins = mat4x4f(
        textureLoad(bins_a, pixel, 0),
        textureLoad(bins_b, pixel, 0),
        textureLoad(bins_c, pixel, 0),
        textureLoad(bins_d, pixel, 0),
    );
    let total = dot(vec4f(1.0) * bins, vec4f(1.0));
    let all = 1.0 - exp(-total);
    let shares_near = share_before(vec4f(1.0, 2.0, 3.0, 4.0)) * all;
    let shares_far = share_before(vec4f(5.0, 6.0, 7.0, 7.0)) * all;
    var near = vec4f(0.0);
    var far = vec4f(0.0);
    var begin = BINS;
    var end = BINS;
    var through = 1.0;
    for (var k = 0u; k < 16u; k++) {
        let bin = bins[k / 4u][k % 4u];
        let behind = through * exp(-bin);
        // How much of the bin lies before each border: what is seen counts as spread evenly in it.
        let seen = max(through - behind, 1e-9);
        near += clamp((shares_near - (1.0 - through)) / seen, vec4f(0.0), vec4f(1.0));
        far += clamp((shares_far - (1.0 - through)) / seen, vec4f(0.0), vec4f(1.0));
        begin = select(begin, min(begin, f32(k)), bin > 0.0);
        end = select(end, min(end, f32(k + 1u)), behind <= UNSEEN);
        through = behind;
    }
    let around = around_of(quantiles, bilinear, position.xy);
    let limit = window_depth_of(depth_of(end / BINS, around));
    let ends = vec2f(floor(begin / BINS * 255.0), ceil(end / BINS * 255.0)) / 255.0;
    return Borders(near / BINS, far / BINS, ends, select(limit, 1.0, end == BINS));
}
