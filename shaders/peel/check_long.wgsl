// S-buffer: whether every long run is sorted. Keys differ, so an order that ascends strictly within its run's slots names each slot once.
// Loops: 1: WINDOW slots.
import package::peel::faults::Faults;
import package::peel::long_runs::{chunk_of, depths, triangles, windows};

@group(0) @binding(5) var<storage, read> order: array<u32>;
@group(0) @binding(6) var<storage, read_write> faults: Faults;

fn check(pixel: u32, window: u32) {
    let chunk = chunk_of(pixel, window);
    var unsorted = 0u;
    // The chunk before ends where this one begins.
    var previous = order[max(chunk.begin, chunk.run_begin + 1u) - 1u];
    var nearest = depths[previous];
    for (var i = chunk.begin; i < chunk.end; i++) {
        let slot = order[i];
        let depth = depths[slot];
        let is_inside = slot >= chunk.run_begin && slot < chunk.run_end;
        let is_sorted = i == chunk.run_begin || nearest < depth || (nearest == depth && triangles[previous] < triangles[slot]);
        unsorted += u32(!(is_inside && is_sorted));
        previous = slot;
        nearest = depth;
    }
    if unsorted > 0u {
        atomicAdd(&faults.unsorted, unsorted);
        atomicMax(&faults.pixel, pixel + 1u);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let window = id.y * groups.x * 64u + id.x;
    if window >= arrayLength(&windows) {
        return;
    }
    check(windows[window].x, window);
    check(windows[window].y, window);
}
