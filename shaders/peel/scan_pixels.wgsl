// Prefix sum, step 3: every pixel's offset; entry n is the total.
// Loops: 1: BLOCK pixels.
import package::peel::scan_blocks::Extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> offsets: array<u32>;

const BLOCK: u32 = 256u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let block = id.y * extent.size.z * 64u + id.x;
    if block >= extent.size.y {
        return;
    }
    var offset = blocks[block].x;
    let end = min((block + 1u) * BLOCK, extent.size.x);
    for (var i = block * BLOCK; i < end; i++) {
        offsets[i] = offset;
        offset += counts[i];
    }
    if end == extent.size.x {
        offsets[end] = offset;
    }
}
