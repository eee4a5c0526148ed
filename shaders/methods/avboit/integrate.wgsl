// avboit, between its passes: a column's sums become the transmittance behind each slice.
// Loops: 1: the parameter slices, at most 1,024.
import package::methods::avboit::grid::{UNIT, columns};
import package::parameters::SLICES;

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let count = columns(frame.xy);
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    var sum = 0.0;
    for (var slice = index * SLICES; slice < (index + 1u) * SLICES; slice++) {
        sum += f32(voxels[slice]) * UNIT;
        voxels[slice] = bitcast<u32>(exp(-sum));
    }
}
