// The sorted runs of a tile's pixels, for passes over them that composite each over C_0. Their scissor is the tile.
import package::peel::tile::Tile;
import package::scene::camera::Camera;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> fragments: array<vec4f>;
@group(0) @binding(4) var background: texture_2d<f32>;

// Fragments of a pixel, front to back.
struct Run {
    begin: u32,
    end: u32,
}

fn run_of(pixel: vec2u) -> Run {
    let index = pixel.y * camera.frame_size.x + pixel.x;
    let base = offsets[tile.begin];
    return Run(
        min(offsets[index] - base, tile.capacity),
        min(offsets[index + 1u] - base, tile.capacity),
    );
}
