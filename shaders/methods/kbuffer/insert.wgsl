// kbuffer and hybrid, pass 1: the K nearest depths of every pixel, by a chain of atomic maxima.
//
// Each value goes to the first place where it is larger and carries what it displaces on to the next (the way of nvpro's
// "Loop32" sample): whatever the order in which fragments arrive, the places end up sorted.
// Loops: 1: K, at most 64.
import package::parameters::K;
import package::methods::kbuffer::key::{first_place, nearness};
import package::scene::surface::Surface;
import package::scene::visible::visible;

// Nearness of the K nearest fragments, the nearest first; 0 for none.
@group(1) @binding(0) var<storage, read_write> nearest: array<atomic<u32>>;

@fragment
fn fragment_main(surface: Surface) {
    if !visible(surface) {
        discard;
    }
    let first = first_place(surface);
    var carried = nearness(surface);
    // Behind K others: into the tail.
    if carried <= atomicLoad(&nearest[first + K - 1u]) {
        discard;
    }
    for (var i = first; i < first + K; i++) {
        let before = atomicMax(&nearest[i], carried);
        if before == 0u {
            break;
        }
        carried = min(carried, before);
    }
}
