// Prefix sum, step 1: the sum and the maximum of each block of counts.
// Loops: 1: BLOCK pixels.
struct Extent {
    // x: number of pixels, y: number of blocks, z: groups along x of this dispatch.
    size: vec4u,
}

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> blocks: array<vec2u>;

const BLOCK: u32 = 256u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let block = id.y * extent.size.z * 64u + id.x;
    if block >= extent.size.y {
        return;
    }
    var sum = 0u;
    var most = 0u;
    let end = min((block + 1u) * BLOCK, extent.size.x);
    for (var i = block * BLOCK; i < end; i++) {
        sum += counts[i];
        most = max(most, counts[i]);
    }
    blocks[block] = vec2u(sum, most);
}
