// Slabs over the pixel's own range, between passes 1 and 2: quantiles of what is seen in the pixel, and the depth behind which nothing is.
// Loops: 1: sixteen bins.
import package::helpers::quantiles::around_of;
import package::learned::weight::{peelnet_before, peelnet_depth_at, peelnet_even};
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

struct Range {
    // Depths of the pixel, 0 .. 1 of the frame's, as `around` of a tile.
    @location(0) quantiles: vec4f,
    @builtin(frag_depth) end: f32,
}

// The depth, 0 .. 1 of the frame's, of a place among quantiles: peelnet_place_among turned round.
fn depth_of(place: f32, around: vec4f) -> f32 {
    let shares = vec4f(0.06, 0.29, 0.3, 0.29);
    let begin = vec4f(0.0, 0.06, 0.35, 0.65);
    let parts = clamp((vec4f(place) - begin) / shares, vec4f(0.0), vec4f(1.0));
    let last = clamp((place - 0.94) / 0.06, 0.0, 1.0);
    return dot(parts, around - vec4f(0.0, around.xyz)) + last * (1.0 - around.w);
}

// The window depth of a depth on the frame's scale.
fn window_depth_of(depth: f32) -> f32 {
    let gaps = camera.gaps;
    var zeta = 0.5 * depth * (4.0 - 2.0 * (gaps.y - gaps.x + gaps.w - gaps.z)) - 1.0;
    zeta += select(0.0, gaps.y - gaps.x, zeta > gaps.x);
    zeta += select(0.0, gaps.w - gaps.z, zeta > gaps.z);
    let linear = exp((zeta + 1.0) / max(camera.warp_scale, 1e-6)) * camera.warp_near;
    let far = camera.window_depth_at_infinity;
    let near = camera.clip_from_world[3].w - camera.clip_from_world[3].z / far;
    return clamp(far - far * near / linear, 0.0, 1.0);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> Range {
    let pixel = vec2u(position.xy);
    let around = around_of(quantiles, bilinear, position.xy);
    let bins = mat4x4f(
        textureLoad(bins_a, pixel, 0),
        textureLoad(bins_b, pixel, 0),
        textureLoad(bins_c, pixel, 0),
        textureLoad(bins_d, pixel, 0),
    );
    var seen = mat4x4f();
    var through = 1.0;
    var end = 16.0;
    for (var k = 0u; k < 16u; k++) {
        let behind = through * exp(-bins[k / 4u][k % 4u]);
        seen[k / 4u][k % 4u] = through - behind;
        end = select(end, min(end, f32(k + 1u)), behind <= UNSEEN);
        through = behind;
    }
    let before = peelnet_before(seen);
    let shares = peelnet_even() * (before.w + dot(seen[3], vec4f(1.0)));
    let places = vec4f(
        peelnet_depth_at(shares.x, seen, before),
        peelnet_depth_at(shares.y, seen, before),
        peelnet_depth_at(shares.z, seen, before),
        peelnet_depth_at(shares.w, seen, before),
    );
    let own = vec4f(
        depth_of(places.x, around),
        depth_of(places.y, around),
        depth_of(places.z, around),
        depth_of(places.w, around),
    );
    let is_seen = through < 1.0;
    let limit = window_depth_of(depth_of(end / 16.0, around));
    return Range(select(around, own, is_seen), select(1.0, limit, is_seen && end < 16.0));
}
