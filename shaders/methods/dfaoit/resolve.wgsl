// dfaoit: the exact front over the tail's colour that the exported network gives.
import package::helpers::screen::screen_corner;
import package::learned::weight::peelnet_tail;

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
    let s = textureLoad(sums, pixel, 0).xy;
    if s.y == 0.0 {
        return vec4f(near.rgb + near.a * behind, 1.0 - near.a);
    }
    let t = peelnet_tail(near, textureLoad(tail, pixel, 0), s);
    let color = near.rgb + near.a * mix(t.color, behind, t.transmittance);
    return vec4f(color, 1.0 - near.a * t.transmittance);
}
