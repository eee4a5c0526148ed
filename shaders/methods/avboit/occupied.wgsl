// avboit, pass 1, of one pixel in 64: which intervals of depth hold something.
// Variants: tiles
import package::methods::avboit::grid::{INTERVALS, WORDS, interval_of};
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read_write> occupied: array<atomic<u32>, WORDS>;

@fragment
fn fragment_main(surface: Surface) {
    if !visible(surface) {
        discard;
    }
    let interval = u32(interval_of(surface.depth_linear, INTERVALS));
    atomicOr(&occupied[interval / 32u], 1u << (interval % 32u));
}
