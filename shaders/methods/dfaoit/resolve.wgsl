// dfaoit: the exported text's resolve.
import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var front: texture_2d<f32>;
@group(0) @binding(2) var behind: texture_2d<f32>;
@group(0) @binding(3) var all: texture_2d<f32>;
@group(0) @binding(4) var count: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    return peelnet_resolve(
        textureLoad(front, pixel, 0),
        textureLoad(behind, pixel, 0),
        textureLoad(all, pixel, 0),
        textureLoad(count, pixel, 0).x,
        textureLoad(background, pixel, 0).rgb,
    );
}
