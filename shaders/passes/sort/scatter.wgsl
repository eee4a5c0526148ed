// Sorting triangles, step 4: puts each key where it belongs by one byte, those that are alike in their order; the last time the numbers of
// its triangle's vertices.
// Variants: none | last
// Loops: 4: four keys, four keys, 256 of a block for each, and three vertices.
import package::parameters::SHIFT;
import package::passes::sort::blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> sorted: array<vec2u>;
@group(0) @binding(2) var<storage, read> counts: array<u32>;
@if(!last) @group(0) @binding(3) var<storage, read_write> next: array<vec2u>;
@if(last) @group(0) @binding(3) var<storage, read_write> indices: array<u32>;

var<workgroup> values: array<u32, 256>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = group.y * groups.x + group.x;
    let first = block * 256u;
    for (var k = 4u * lane; k < 4u * lane + 4u; k++) {
        // No byte beyond the last key.
        values[k] = 256u;
        if first + k < extent.count {
            values[k] = (sorted[first + k].x >> SHIFT) & 255u;
        }
    }
    workgroupBarrier();
    for (var k = 4u * lane; k < 4u * lane + 4u; k++) {
        let value = values[k];
        if value > 255u {
            return;
        }
        var place = counts[value * extent.blocks + block];
        for (var i = 0u; i < k; i++) {
            place += select(0u, 1u, values[i] == value);
        }
        let key = sorted[first + k];
        @if(last) {
            for (var i = 0u; i < 3u; i++) {
                indices[3u * place + i] = key.y + i;
            }
        }
        @else {
            next[place] = key;
        }
    }
}
