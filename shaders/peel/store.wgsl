// S-buffer, pass 2: every fragment into its pixel's own run of slots.
// Variants: none | tinted | layered | named | dataset | half_colors | byte_colors | tinted half_colors
@if(half_colors || byte_colors) import package::helpers::stored::{restored, stored};
import package::scene::camera::camera;
@if(dataset) import package::scene::shade::radiance as shade;
@if(layered) import package::scene::shade::layered as shade;
@if(!dataset && !layered && !named) import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;
import package::peel::tile::Tile;

@group(1) @binding(0) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(1) var<storage, read> offsets: array<u32>;
@group(1) @binding(2) var<storage, read_write> depths: array<f32>;
@group(1) @binding(3) var<storage, read_write> triangles: array<u32>;
// Where light takes a colour two of a fragment: its colour, and what it covers of each channel. `named`: material and side instead.
@group(1) @binding(4) var<storage, read_write> colors: array<vec4f>;
@group(1) @binding(5) var<uniform> tile: Tile;

// As the linked list keeps colours.
fn rounded(color: vec4f) -> vec4f {
    @if(half_colors || byte_colors) return restored(stored(color));
    @if(!half_colors && !byte_colors) return color;
}

@fragment
fn fragment_main(surface: Surface, @if(named) @builtin(front_facing) is_front: bool) {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let index = pixel.y * camera.frame_size.x + pixel.x;
    if index < tile.begin || index >= tile.end {
        discard;
    }
    // Counting down to zero gives every fragment of the pixel another slot and needs no second counter.
    let slot = offsets[index] - offsets[tile.begin] + atomicSub(&counts[index], 1u) - 1u;
    // Storage made for another frame may be too small: the counts show it, and the next frame has room.
    if slot >= tile.capacity {
        discard;
    }
    depths[slot] = surface.depth_linear;
    triangles[slot] = surface.triangle;
    @if(named) colors[slot] = vec4f(f32(surface.material), f32(is_front), 0.0, 0.0);
    @if(!tinted && !named) colors[slot] = rounded(shade(surface));
    @if(tinted) {
        colors[2u * slot] = rounded(shade(surface));
        colors[2u * slot + 1u] = rounded(vec4f(covering(surface), 0.0));
    }
}
