// S-buffer, long runs, step 1: which long runs each window touches.
// Loops: 1: a binary search over 32 bits.
import package::peel::long_runs::{NO_PIXEL, WINDOW, is_long, slot_of, tile, windows};

// The pixel whose run holds a slot. Halves at most 32 times.
fn pixel_at(slot: u32) -> u32 {
    var least = tile.begin;
    var most = tile.end;
    while most - least > 1u {
        let middle = least + (most - least) / 2u;
        if slot_of(middle) <= slot {
            least = middle;
        } else {
            most = middle;
        }
    }
    return least;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let window = id.y * groups.x * 64u + id.x;
    let slots = slot_of(tile.end);
    if window >= arrayLength(&windows) {
        return;
    }
    var found = vec2u(NO_PIXEL);
    if window * WINDOW < slots {
        let first = pixel_at(window * WINDOW);
        let last = pixel_at(min(window * WINDOW + WINDOW, slots) - 1u);
        if is_long(first) {
            found.x = first;
        }
        if last != first && is_long(last) {
            found.y = last;
        }
    }
    windows[window] = found;
}
