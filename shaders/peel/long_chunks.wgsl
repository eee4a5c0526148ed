// S-buffer, long runs, step 2: sorts every chunk by insertion.
import package::peel::long_runs::{Chunk, before, chunk_of, windows};

@group(0) @binding(5) var<storage, read_write> order: array<u32>;

fn sort_chunk(chunk: Chunk) {
    for (var slot = chunk.begin; slot < chunk.end; slot++) {
        var i = slot;
        while i > chunk.begin && before(slot, order[i - 1u]) {
            order[i] = order[i - 1u];
            i--;
        }
        order[i] = slot;
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let window = id.y * groups.x * 64u + id.x;
    if window >= arrayLength(&windows) {
        return;
    }
    sort_chunk(chunk_of(windows[window].x, window));
    sort_chunk(chunk_of(windows[window].y, window));
}
