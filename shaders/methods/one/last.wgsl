// One pass, after it: what is seen behind the nearest fragment of the pixel in the middle of each tile, for the quantiles of the next frame.
// Variants: none | wide
import package::helpers::quantiles::around_of;
import package::learned::weight::{peelnet_last_seen, peelnet_noise};

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var sum_a: texture_2d<f32>;
@group(0) @binding(2) var sum_b: texture_2d<f32>;
@group(0) @binding(3) var sum_c: texture_2d<f32>;
@if(wide) @group(0) @binding(4) var sum_d: texture_2d<f32>;
@if(wide) @group(0) @binding(5) var sum_e: texture_2d<f32>;
@if(wide) @group(0) @binding(6) var sum_f: texture_2d<f32>;
@group(0) @binding(7) var absorbances: texture_2d<f32>;
@if(wide) @group(0) @binding(8) var absorbances_back: texture_2d<f32>;
@group(0) @binding(9) var quantiles: texture_2d<f32>;
@group(0) @binding(10) var bilinear: sampler;
@group(0) @binding(11) var<storage, read_write> seen: array<mat4x4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let count = (frame.xy + 7u) / 8u;
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    let tile = vec2u(index % count.x, index / count.x);
    let pixel = min(8u * tile + 4u, frame.xy - 1u);
    let around = around_of(quantiles, bilinear, vec2f(pixel) + 0.5);
    let a = textureLoad(sum_a, pixel, 0);
    let b = textureLoad(sum_b, pixel, 0);
    let c = textureLoad(sum_c, pixel, 0);
    let of_sums = textureLoad(absorbances, pixel, 0);
    let noise = peelnet_noise(pixel);
    @if(wide) {
        let d = textureLoad(sum_d, pixel, 0);
        let e = textureLoad(sum_e, pixel, 0);
        let f = textureLoad(sum_f, pixel, 0);
        let of_back = textureLoad(absorbances_back, pixel, 0);
        seen[index] = peelnet_last_seen(a, b, c, d, e, f, of_sums, of_back, around, noise);
    }
    @else {
        seen[index] = peelnet_last_seen(a, b, c, of_sums, around, noise);
    }
}
