// Puts what one pass of dual peeling found into each pixel's run: fronts from the left, backs from the right.
import package::peel::tile::Tile;

struct Step {
    // Peeling pass, from 0.
    pass_index: u32,
    width: u32,
    pad0: u32,
    pad1: u32,
}

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<uniform> peel_step: Step;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read_write> depths: array<f32>;
@group(0) @binding(4) var<storage, read_write> colors: array<vec4f>;
@group(0) @binding(5) var range: texture_2d<f32>;
@group(0) @binding(6) var front: texture_2d<f32>;
@group(0) @binding(7) var back: texture_2d<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let index = tile.begin + id.y * tile.groups * 64u + id.x;
    if index >= tile.end {
        return;
    }
    let pixel = vec2u(index % peel_step.width, index / peel_step.width);
    let left = textureLoad(range, pixel, 0).xy;
    let nearest = -left.x;
    let farthest = left.y;
    if nearest > farthest {
        return;
    }
    let begin = offsets[index] - offsets[tile.begin] + peel_step.pass_index;
    let end = offsets[index + 1u] - offsets[tile.begin] - peel_step.pass_index;
    depths[begin] = nearest;
    colors[begin] = textureLoad(front, pixel, 0);
    if farthest > nearest {
        depths[end - 1u] = farthest;
        colors[end - 1u] = textureLoad(back, pixel, 0);
    }
}
