// Sorting triangles, step 3: turns counts into places, one workgroup.
// Loops: 3: four values of 3,907 blocks, a million keys, and LANES.
import package::passes::sort::blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read_write> counts: array<u32>;

const LANES: u32 = 64u;

var<workgroup> sums: array<u32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
    let share = 4u * extent.blocks;
    var sum = 0u;
    for (var i = lane * share; i < (lane + 1u) * share; i++) {
        sum += counts[i];
    }
    sums[lane] = sum;
    workgroupBarrier();
    var before = 0u;
    for (var i = 0u; i < LANES; i++) {
        before += select(0u, sums[i], i < lane);
    }
    for (var i = lane * share; i < (lane + 1u) * share; i++) {
        let count = counts[i];
        counts[i] = before;
        before += count;
    }
}
