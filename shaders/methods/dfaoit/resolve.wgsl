// dfaoit: the exported text's resolve of the exact front over the tail.
import package::helpers::screen::screen_corner;
import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var front: texture_2d<f32>;
@group(0) @binding(2) var tail: texture_2d<f32>;
@group(0) @binding(3) var sums: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let near = textureLoad(front, pixel, 0);
    let behind = textureLoad(background, pixel, 0).rgb;
    return peelnet_resolve(near, textureLoad(tail, pixel, 0), textureLoad(sums, pixel, 0).xy, behind);
}
