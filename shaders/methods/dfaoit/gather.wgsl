// dfaoit: sums over all fragments, and over those behind the two nearest.
import package::learned::weight::peelnet_statistics;
import package::scene::shade::radiance;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// Key of the second fragment: bits of the linear depth, triangle + 1; all ones where there is none.
@group(1) @binding(0) var second: texture_2d<u32>;

struct Sums {
    @location(0) behind: vec4f,
    // Colour adds, alpha is blended multiplicatively: dst * (1 - src).
    @location(1) all: vec4f,
    @location(2) count: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let before = textureLoad(second, vec2u(surface.position.xy), 0).xy;
    let depth = bitcast<u32>(surface.depth_linear);
    let front = depth < before.x || (depth == before.x && surface.triangle + 1u <= before.y);
    let s = peelnet_statistics(radiance(surface), front);
    return Sums(s.behind, s.all, s.count);
}
