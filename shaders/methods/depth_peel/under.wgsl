// Depth peeling: puts one peeled layer under what is composited so far. Ping-pong between two targets, because
// 32-bit targets cannot be blended everywhere.
// Variants: none | counted

// rgb: colour so far, a: transmittance so far.
@group(0) @binding(0) var before: texture_2d<f32>;
@group(0) @binding(1) var layer: texture_2d<f32>;
@group(0) @binding(2) var key: texture_2d<u32>;
// 0: whether anything was peeled, 1: how much.
@group(0) @binding(3) var<storage, read_write> found: array<atomic<u32>, 2>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let under = textureLoad(before, pixel, 0);
    if textureLoad(key, pixel, 0).x == 0xffffffffu {
        return under;
    }
    atomicStore(&found[0], 1u);
    @if(counted) {
        atomicAdd(&found[1], 1u);
    }
    let peeled = textureLoad(layer, pixel, 0);
    return vec4f(under.rgb + under.a * peeled.rgb, under.a * (1.0 - peeled.a));
}
