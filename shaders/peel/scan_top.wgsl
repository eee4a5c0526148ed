// Prefix sum, step 2: turns the blocks' sums into their offsets, one workgroup; writes the total in 64 bits and the largest count.
// Loops: 3: LANES; blocks of a frame by LANES, 16,384 of 2^28 pixels.
import package::peel::scan_blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read_write> blocks: array<vec2u>;
// x, z: number of fragments, low and high word; y: the most in one pixel.
@group(0) @binding(2) var<storage, read_write> total: vec3u;

const LANES: u32 = 64u;

var<workgroup> sums: array<vec3u, 64>;

// Adds a count; z carries.
fn plus(sum: vec3u, count: u32, most: u32) -> vec3u {
    let low = sum.x + count;
    return vec3u(low, max(sum.y, most), sum.z + u32(low < count));
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
    let share = (extent.size.y + LANES - 1u) / LANES;
    let begin = min(lane * share, extent.size.y);
    let end = min(begin + share, extent.size.y);
    var sum = vec3u(0u);
    for (var i = begin; i < end; i++) {
        sum = plus(sum, blocks[i].x, blocks[i].y);
    }
    sums[lane] = sum;
    workgroupBarrier();
    var before = 0u;
    var all = vec3u(0u);
    for (var i = 0u; i < LANES; i++) {
        if i == lane {
            before = all.x;
        }
        all = plus(all, sums[i].x, sums[i].y) + vec3u(0u, 0u, sums[i].z);
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
