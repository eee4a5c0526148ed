// Sorting triangles, step 2, for each of a key's four bytes: how often each value occurs in each block.
// Loops: 2: four keys.
import package::parameters::SHIFT;
import package::passes::sort::blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> sorted: array<vec2u>;
// Value by value, its blocks.
@group(0) @binding(2) var<storage, read_write> counts: array<u32>;

var<workgroup> found: array<atomic<u32>, 256>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = group.y * groups.x + group.x;
    for (var k = 0u; k < 4u; k++) {
        let at = block * 256u + 4u * lane + k;
        if at < extent.count {
            atomicAdd(&found[(sorted[at].x >> SHIFT) & 255u], 1u);
        }
    }
    workgroupBarrier();
    for (var k = 0u; k < 4u; k++) {
        let value = 4u * lane + k;
        if block < extent.blocks {
            counts[value * extent.blocks + block] = atomicLoad(&found[value]);
        }
    }
}
