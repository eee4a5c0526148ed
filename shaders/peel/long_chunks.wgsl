// S-buffer, long runs, step 2: sorts every chunk. A fragment's place is the number of those that come before it, four fragments at a time:
// every thread of a group does the same number of comparisons, in registers, whatever the order.
// Loops: 2: WINDOW slots.
import package::peel::long_runs::{Chunk, chunk_of, depths, triangles, windows};

@group(0) @binding(5) var<storage, read_write> order: array<u32>;

fn sort_chunk(chunk: Chunk) {
    for (var first = chunk.begin; first < chunk.end; first += 4u) {
        let slots = min(vec4u(first, first + 1u, first + 2u, first + 3u), vec4u(chunk.end - 1u));
        let own = vec4f(depths[slots.x], depths[slots.y], depths[slots.z], depths[slots.w]);
        let own_triangles = vec4u(triangles[slots.x], triangles[slots.y], triangles[slots.z], triangles[slots.w]);
        var places = vec4u(chunk.begin);
        for (var other = chunk.begin; other < chunk.end; other++) {
            let depth = vec4f(depths[other]);
            places += vec4u(depth < own);
            let tied = depth == own;
            // At least with itself.
            if any(tied) {
                places += vec4u(tied & (vec4u(triangles[other]) < own_triangles));
            }
        }
        // Beyond the end the last one is written again.
        order[places.x] = slots.x;
        order[places.y] = slots.y;
        order[places.z] = slots.z;
        order[places.w] = slots.w;
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
