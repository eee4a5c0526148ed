// Finished pixels onto a target, blended over what it holds by the pipeline.
import package::helpers::screen::screen_corner;

// rgb: premultiplied colour, a: coverage.
@group(0) @binding(0) var image: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return textureLoad(image, vec2u(position.xy), 0);
}
