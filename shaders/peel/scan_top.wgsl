// Prefix sum, step 2: turns the blocks' sums into their offsets, one workgroup; writes the total and the largest count.
import package::peel::scan_blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read_write> blocks: array<vec2u>;
// x: number of fragments, y: the most in one pixel.
@group(0) @binding(2) var<storage, read_write> total: vec2u;

const LANES: u32 = 64u;

var<workgroup> sums: array<vec2u, 64>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
    let share = (extent.size.y + LANES - 1u) / LANES;
    let begin = min(lane * share, extent.size.y);
    let end = min(begin + share, extent.size.y);
    var sum = vec2u(0u);
    for (var i = begin; i < end; i++) {
        sum = vec2u(sum.x + blocks[i].x, max(sum.y, blocks[i].y));
    }
    sums[lane] = sum;
    workgroupBarrier();
    var before = 0u;
    var all = vec2u(0u);
    for (var i = 0u; i < LANES; i++) {
        if i == lane {
            before = all.x;
        }
        all = vec2u(all.x + sums[i].x, max(all.y, sums[i].y));
    }
    for (var i = begin; i < end; i++) {
        let count = blocks[i].x;
        blocks[i] = vec2u(before, 0u);
        before += count;
    }
    if lane == 0u {
        total = all;
    }
}
