// linked-list, the one geometry pass: every fragment becomes a node of its pixel's list (Yang et al. 2010).
// Variants: none | tinted | half_colors | byte_colors | tinted half_colors
import package::helpers::stored::{Stored, stored};
import package::scene::camera::camera;
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// Node + 1 of the first in each list; 0 for an empty one.
@group(1) @binding(0) var<storage, read_write> heads: array<atomic<u32>>;
// Nodes asked for, also those beyond the pool.
@group(1) @binding(1) var<storage, read_write> found: atomic<u32>;
@group(1) @binding(2) var<storage, read_write> next: array<u32>;
@group(1) @binding(3) var<storage, read_write> depths: array<f32>;
@group(1) @binding(4) var<storage, read_write> triangles: array<u32>;
// Where light takes a colour two of a node: its colour, and what it covers of each channel.
@group(1) @binding(5) var<storage, read_write> colors: array<Stored>;

@fragment
fn fragment_main(surface: Surface) {
    if !visible(surface) {
        discard;
    }
    let node = atomicAdd(&found, 1u);
    // The pool is too small: it is made larger and the pass drawn again.
    if node >= arrayLength(&next) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    depths[node] = surface.depth_linear;
    triangles[node] = surface.triangle;
    @if(!tinted) colors[node] = stored(shade(surface));
    @if(tinted) {
        colors[2u * node] = stored(shade(surface));
        colors[2u * node + 1u] = stored(vec4f(covering(surface), 0.0));
    }
    next[node] = atomicExchange(&heads[pixel.y * camera.frame_size.x + pixel.x], node + 1u);
}
