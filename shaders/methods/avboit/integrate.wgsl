// avboit, between its passes: a column's sums become the mean absorbance of its pixels from the near end to the far end of each slice.
// Loops: 1: the parameter slices, at most 1,024.
import package::methods::avboit::grid::{UNIT, columns, first_slice};
import package::parameters::{CELL, SLICES};

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let size = frame.xy;
    let count = columns(size);
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    let column = vec2u(index % count.x, index / count.x);
    // Columns at the frame's edge have fewer pixels.
    let pixels = min(vec2u(CELL), size - column * CELL);
    let unit = UNIT / f32(pixels.x * pixels.y);
    let first = first_slice(column, size);
    var sum = 0.0;
    for (var slice = 0u; slice < SLICES; slice++) {
        sum += f32(voxels[first + slice]) * unit;
        voxels[first + slice] = bitcast<u32>(sum);
    }
}
