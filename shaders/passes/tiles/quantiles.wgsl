// Tiles, pass 3: the quantiles of each tile, of what is seen in the nine around it.
// Loops: 2: three rows, and three columns.
import package::learned::weight::peelnet_quantiles;

// Width and height of the frame.
@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var<storage, read> seen: array<mat4x4f>;
@group(0) @binding(2) var<storage, read_write> quantiles: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let count = (frame.xy + 7u) / 8u;
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= count.x * count.y {
        return;
    }
    let tile = vec2i(vec2u(index % count.x, index / count.x));
    var sum = mat4x4f();
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let at = vec2u(clamp(tile + vec2i(x, y), vec2i(0), vec2i(count) - 1));
            sum += seen[at.y * count.x + at.x];
        }
    }
    quantiles[index] = pack4x8unorm(peelnet_quantiles(sum));
}
