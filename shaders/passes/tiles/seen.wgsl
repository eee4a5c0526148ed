// Tiles, pass 2: what is seen of each tile's pixel behind its nearest fragment.
import package::learned::weight::peelnet_tile_seen;

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var bins_a: texture_2d<f32>;
@group(0) @binding(2) var bins_b: texture_2d<f32>;
@group(0) @binding(3) var bins_c: texture_2d<f32>;
@group(0) @binding(4) var bins_d: texture_2d<f32>;
@group(0) @binding(5) var bins_e: texture_2d<f32>;
@group(0) @binding(6) var tile_nearest: texture_2d<f32>;
@group(0) @binding(7) var<storage, read_write> seen: array<mat4x4f>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let count = (frame.xy + 7u) / 8u;
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    let tile = vec2u(index % count.x, index / count.x);
    let bins = mat4x4f(
        textureLoad(bins_a, tile, 0),
        textureLoad(bins_b, tile, 0),
        textureLoad(bins_c, tile, 0),
        vec4f(textureLoad(bins_d, tile, 0).xy, textureLoad(bins_e, tile, 0).xy),
    );
    seen[index] = peelnet_tile_seen(bins, textureLoad(tile_nearest, tile, 0).x);
}
