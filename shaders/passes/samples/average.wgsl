// Frames of four samples a pixel: a quarter of one repetition, added to those before.
import package::helpers::screen::screen_corner;

@group(0) @binding(0) var repetition: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return 0.25 * textureLoad(repetition, vec2u(position.xy), 0);
}
