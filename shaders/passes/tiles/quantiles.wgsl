// Tiles, pass 3: the quantiles of each tile, of what is seen in the nine around it.
// Loops: 2: three rows, and three columns.
import package::learned::weight::peelnet_quantiles;

@group(0) @binding(0) var<storage, read> seen: array<mat4x4f>;
@group(0) @binding(1) var tile_nearest: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let count = textureDimensions(tile_nearest);
    let tile = vec2i(position.xy);
    var sum = mat4x4f();
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let at = vec2u(clamp(tile + vec2i(x, y), vec2i(0), vec2i(count) - 1));
            sum += seen[at.y * count.x + at.x];
        }
    }
    return peelnet_quantiles(sum);
}
