// dfaoit: sums over the fragments behind the two nearest.
import package::learned::weight::peelnet_statistics;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// Key of the second fragment: bits of the linear depth, triangle + 1; all ones where there is none.
@group(1) @binding(0) var second: texture_2d<u32>;

struct Sums {
    @location(0) color: vec4f,
    @location(1) absorbance: vec2f,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let before = textureLoad(second, vec2u(surface.position.xy), 0).xy;
    let depth = bitcast<u32>(surface.depth_linear);
    if depth < before.x || (depth == before.x && surface.triangle + 1u <= before.y) {
        discard;
    }
    let s = peelnet_statistics(shade(surface));
    return Sums(s.tail, s.sums);
}
