// Depth peeling front to back (Everitt 2001): the depth test keeps the nearest fragment behind the last one peeled.
//
// The test runs on linear depth scaled by a power of two, which loses no bit, so its key is the one key of the
// project. Coplanar fragments follow one another by triangle: triangles are drawn in order, and the test (LESS)
// keeps the first of equals. Unlike in the original, none is lost.
// Variants: none | dataset
import package::scene::camera::camera;
@if(dataset) import package::scene::shade::radiance as shade;
@if(!dataset) import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// x: bits of the linear depth, y: triangle + 1 of what the last pass peeled. 0, 0 before the first pass; all ones
// where the last pass found nothing, so that nothing lies behind it.
@group(1) @binding(0) var last: texture_2d<u32>;

struct Peeled {
    @location(1) color: vec4f,
    @location(0) key: vec2u,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Peeled {
    if !visible(surface) {
        discard;
    }
    let before = textureLoad(last, vec2u(surface.position.xy), 0).xy;
    // Positive floats order as their bits do.
    let depth = bitcast<u32>(surface.depth_linear);
    if depth < before.x || (depth == before.x && surface.triangle + 1u <= before.y) {
        discard;
    }
    return Peeled(
        shade(surface),
        vec2u(depth, surface.triangle + 1u),
        surface.depth_linear * camera.unit_from_depth,
    );
}
