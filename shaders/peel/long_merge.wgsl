// S-buffer, long runs, step 3, once for every doubling of the sorted length: merges neighbours of `sorted_length` slots.
//
// A thread writes a chunk of what is merged. Where its inputs begin, a binary search along a diagonal finds (merge path, Odeh et al. 2012).
// Loops: 2: WINDOW slots; a binary search over 22 bits.
import package::peel::long_runs::{Chunk, before, chunk_of, depths, triangles, windows};

// x: the sorted length.
@group(0) @binding(5) var<uniform> step: vec4u;
@group(0) @binding(6) var<storage, read> sorted: array<u32>;
@group(0) @binding(7) var<storage, read_write> merged: array<u32>;

// Behind every fragment.
const NOWHERE: f32 = 3.4e38;

// The first of what is left of a sorted part.
struct Head {
    slot: u32,
    depth: f32,
}

fn head(i: u32, end: u32) -> Head {
    if i >= end {
        return Head(0u, NOWHERE);
    }
    let slot = sorted[i];
    return Head(slot, depths[slot]);
}

fn merge(chunk: Chunk) {
    if chunk.begin == chunk.end {
        return;
    }
    // The slots begin .. middle and middle .. end are sorted.
    let begin = chunk.begin - (chunk.begin - chunk.run_begin) % (2u * step.x);
    let middle = min(begin + step.x, chunk.run_end);
    let end = min(middle + step.x, chunk.run_end);
    // Of the fragments before the chunk, `least` come from the left.
    let ahead = chunk.begin - begin;
    var least = max(ahead, end - middle) - (end - middle);
    var most = min(ahead, middle - begin);
    while least < most {
        let half = (least + most) / 2u;
        if before(sorted[begin + half], sorted[middle + ahead - 1u - half]) {
            least = half + 1u;
        } else {
            most = half;
        }
    }
    var left = begin + least;
    var right = middle + ahead - least;
    var near = head(left, middle);
    var far = head(right, end);
    for (var i = chunk.begin; i < chunk.end; i++) {
        let from_left = near.depth < far.depth || (near.depth == far.depth && triangles[near.slot] < triangles[far.slot]);
        merged[i] = select(far.slot, near.slot, from_left);
        left += u32(from_left);
        right += u32(!from_left);
        // One read for both sides: neighbouring threads rarely agree.
        let next = head(select(right, left, from_left), select(end, middle, from_left));
        near.slot = select(near.slot, next.slot, from_left);
        near.depth = select(near.depth, next.depth, from_left);
        far.slot = select(next.slot, far.slot, from_left);
        far.depth = select(next.depth, far.depth, from_left);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let window = id.y * groups.x * 64u + id.x;
    if window >= arrayLength(&windows) {
        return;
    }
    merge(chunk_of(windows[window].x, window));
    merge(chunk_of(windows[window].y, window));
}
