// splat, between passes 0 and 1: of each tile of 8 by 8 pixels the quantiles of what is seen in the nine around it.
// Loops: 3: three rows and three columns of sixteen bins.
import package::learned::weight::peelnet_quantiles;

@group(0) @binding(0) var tile_a: texture_2d<f32>;
@group(0) @binding(1) var tile_b: texture_2d<f32>;
@group(0) @binding(2) var tile_c: texture_2d<f32>;
@group(0) @binding(3) var tile_d: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let last = vec2i(textureDimensions(tile_a)) - 1;
    var seen = mat4x4f();
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let at = clamp(vec2i(position.xy) + vec2i(x, y), vec2i(0), last);
            let bins = mat4x4f(
                textureLoad(tile_a, at, 0),
                textureLoad(tile_b, at, 0),
                textureLoad(tile_c, at, 0),
                textureLoad(tile_d, at, 0),
            );
            var through = 1.0;
            for (var k = 0u; k < 16u; k++) {
                let behind = through * exp(-bins[k / 4u][k % 4u]);
                seen[k / 4u][k % 4u] += through - behind;
                through = behind;
            }
        }
    }
    return peelnet_quantiles(seen);
}
