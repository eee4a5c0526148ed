// kbuffer and hybrid: the K nearest exactly, in front of the blended tail, in front of C_0.
// Loops: 2: K, at most 64.
// Variants: none | half_colors | byte_colors
import package::helpers::resolve::normalised;
import package::helpers::stored::{Stored, restored};
import package::parameters::K;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var transmittances: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> nearest: array<u32>;
@group(0) @binding(4) var<storage, read> triangles: array<u32>;
@group(0) @binding(5) var<storage, read> colors: array<Stored>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let first = (pixel.y * textureDimensions(sums).x + pixel.x) * K;
    var color = vec3f(0.0);
    var transmittance = 1.0;
    // Places of one depth, from `run` on, are composited by triangle: `last` is that of the one before.
    var run = first;
    var last = 0u;
    for (var i = first; i < first + K && nearest[i] != 0u; i++) {
        if nearest[i] != nearest[run] {
            run = i;
            last = 0u;
        }
        var place = i;
        var least = 0xffffffffu;
        for (var j = run; j < first + K && nearest[j] == nearest[i]; j++) {
            if triangles[j] > last && triangles[j] < least {
                least = triangles[j];
                place = j;
            }
        }
        last = least;
        let fragment = restored(colors[place]);
        color += transmittance * fragment.rgb;
        transmittance *= 1.0 - fragment.a;
    }
    let tail = textureLoad(transmittances, pixel, 0).x;
    let behind = normalised(textureLoad(sums, pixel, 0), tail, textureLoad(background, pixel, 0).rgb);
    return vec4f(color + transmittance * behind.rgb, 1.0 - transmittance * tail);
}
