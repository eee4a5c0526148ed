// Frames of four samples a pixel: a quarter of one repetition, added to those before.

@group(0) @binding(0) var repetition: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return 0.25 * textureLoad(repetition, vec2u(position.xy), 0);
}
