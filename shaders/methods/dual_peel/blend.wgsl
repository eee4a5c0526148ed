// Dual depth peeling: blends the two layers of one pass, the front one under, the back one over.

// What was left before the pass, and what is left after it.
@group(0) @binding(0) var before: texture_2d<f32>;
@group(0) @binding(1) var after: texture_2d<f32>;
// rgb: colour, a: transmittance of the coincident fragments of a layer.
@group(0) @binding(2) var front: texture_2d<f32>;
@group(0) @binding(3) var back: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> found: array<atomic<u32>, 2>;

struct Layers {
    // Target 0 blends dst.a * src + dst, target 1 src + (1 - src.a) * dst; alpha becomes dst.a * (1 - src.a) in both.
    @location(0) front: vec4f,
    @location(1) back: vec4f,
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> Layers {
    let pixel = vec2u(position.xy);
    let left = textureLoad(before, pixel, 0).xy;
    if -left.x > left.y {
        discard;
    }
    let next = textureLoad(after, pixel, 0).xy;
    if -next.x <= next.y {
        atomicStore(&found[0], 1u);
    }
    let nearest = textureLoad(front, pixel, 0);
    let farthest = textureLoad(back, pixel, 0);
    return Layers(
        vec4f(nearest.rgb, 1.0 - nearest.a),
        vec4f(farthest.rgb, 1.0 - farthest.a),
    );
}
