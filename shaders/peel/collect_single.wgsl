// Puts what one pass of front-to-back peeling found into the next slot of each pixel's run.
import package::peel::tile::Tile;
import package::peel::collect_dual::Step;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<uniform> peel_step: Step;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read_write> depths: array<f32>;
@group(0) @binding(4) var<storage, read_write> colors: array<vec4f>;
@group(0) @binding(5) var key: texture_2d<u32>;
@group(0) @binding(6) var color: texture_2d<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let index = tile.begin + id.y * tile.groups * 64u + id.x;
    if index >= tile.end {
        return;
    }
    let slot = offsets[index] - offsets[tile.begin] + peel_step.pass_index;
    if slot >= offsets[index + 1u] - offsets[tile.begin] {
        return;
    }
    let pixel = vec2u(index % peel_step.width, index / peel_step.width);
    depths[slot] = bitcast<f32>(textureLoad(key, pixel, 0).x);
    colors[slot] = textureLoad(color, pixel, 0);
}
