// Sorting triangles, step 1: of each the depth of its centre, as a key that is smallest for the farthest.
import package::passes::sort::blocks::Extent;
import package::scene::camera::Camera;

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> extent: Extent;
// A triangle's centre, and the bits of the number of its first vertex.
@group(0) @binding(2) var<storage, read> centers: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> sorted: array<vec2u>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let at = (group.y * groups.x + group.x) * 64u + lane;
    if at >= extent.count {
        return;
    }
    let center = centers[at];
    let depth = bitcast<u32>((camera.clip_from_world * vec4f(center.xyz, 1.0)).w);
    // Bits of floats in ascending order, turned round.
    let ascending = select(depth | 0x80000000u, ~depth, depth >= 0x80000000u);
    sorted[at] = vec2u(~ascending, bitcast<u32>(center.w));
}
