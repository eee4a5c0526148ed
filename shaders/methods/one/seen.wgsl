// One pass, for the quantiles: what is seen behind the nearest fragments of each tile, of its pixel in the small targets, or of the pixel in
// its middle that has just been drawn, for the next frame.
// Variants: tiles | none | wide
@if(tiles) import package::learned::weight::peelnet_tile_seen;
@if(!tiles) import package::helpers::one::{between, tiles_around};
@if(!tiles) import package::learned::weight::{peelnet_last_seen, peelnet_noise};

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@if(tiles) @group(0) @binding(1) var bins_a: texture_2d<f32>;
@if(tiles) @group(0) @binding(2) var bins_b: texture_2d<f32>;
@if(tiles) @group(0) @binding(3) var bins_c: texture_2d<f32>;
@if(tiles) @group(0) @binding(4) var bins_d: texture_2d<f32>;
@if(tiles) @group(0) @binding(5) var bins_e: texture_2d<f32>;
@if(tiles) @group(0) @binding(6) var tile_nearest: texture_2d<f32>;
@if(!tiles) @group(0) @binding(7) var sum_a: texture_2d<f32>;
@if(!tiles) @group(0) @binding(8) var sum_b: texture_2d<f32>;
@if(!tiles) @group(0) @binding(9) var sum_c: texture_2d<f32>;
@if(wide) @group(0) @binding(10) var sum_d: texture_2d<f32>;
@if(wide) @group(0) @binding(11) var sum_e: texture_2d<f32>;
@if(wide) @group(0) @binding(12) var sum_f: texture_2d<f32>;
@if(!tiles) @group(0) @binding(13) var absorbances: texture_2d<f32>;
@if(wide) @group(0) @binding(14) var absorbances_back: texture_2d<f32>;
@if(!tiles) @group(0) @binding(15) var<storage, read> quantiles: array<u32>;
@group(0) @binding(16) var<storage, read_write> seen: array<mat4x4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let count = (frame.xy + 7u) / 8u;
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    let tile = vec2u(index % count.x, index / count.x);
    @if(tiles) {
        let bins = mat4x4f(
            textureLoad(bins_a, tile, 0),
            textureLoad(bins_b, tile, 0),
            textureLoad(bins_c, tile, 0),
            vec4f(textureLoad(bins_d, tile, 0).xy, textureLoad(bins_e, tile, 0).xy),
        );
        seen[index] = peelnet_tile_seen(bins, textureLoad(tile_nearest, tile, 0).x);
    }
    @else {
        let pixel = min(8u * tile + 4u, frame.xy - 1u);
        let tiles = tiles_around(pixel, frame.xy);
        let at = tiles.numbers;
        let around = between(vec4u(quantiles[at.x], quantiles[at.y], quantiles[at.z], quantiles[at.w]), tiles.part);
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
}
