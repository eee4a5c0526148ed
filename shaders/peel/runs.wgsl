// The sorted runs of a tile's pixels, for shaders that composite them over C_0.
import package::peel::tile::Tile;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> fragments: array<vec4f>;
@group(0) @binding(3) var background: texture_2d<f32>;
@group(0) @binding(4) var image: texture_storage_2d<rgba32float, write>;

// Fragments of a pixel, front to back.
struct Run {
    inside: bool,
    begin: u32,
    end: u32,
    pixel: vec2u,
}

// The run of an invocation in workgroups of 64; outside of the tile there is none.
fn run_of(id: vec3u) -> Run {
    let index = tile.begin + id.y * tile.groups * 64u + id.x;
    if index >= tile.end {
        return Run(false, 0u, 0u, vec2u(0u));
    }
    let width = textureDimensions(image).x;
    let base = offsets[tile.begin];
    return Run(
        true,
        min(offsets[index] - base, tile.capacity),
        min(offsets[index + 1u] - base, tile.capacity),
        vec2u(index % width, index / width),
    );
}
