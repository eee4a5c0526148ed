// S-buffer: whether every long run is sorted. Keys differ, so an order that ascends strictly within its run's slots names each slot once.
import package::peel::faults::Faults;
import package::peel::long_runs::{NO_PIXEL, before, chunk_of, windows};

@group(0) @binding(5) var<storage, read> order: array<u32>;
@group(0) @binding(6) var<storage, read_write> faults: Faults;

fn check(pixel: u32, window: u32) {
    let chunk = chunk_of(pixel, window);
    var unsorted = 0u;
    for (var i = chunk.begin; i < chunk.end; i++) {
        let is_inside = order[i] >= chunk.run_begin && order[i] < chunk.run_end;
        let is_sorted = i == chunk.run_begin || before(order[i - 1u], order[i]);
        unsorted += u32(!(is_inside && is_sorted));
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
