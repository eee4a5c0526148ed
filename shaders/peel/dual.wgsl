// Dual depth peeling (Bavoil & Myers 2008): every pass peels the nearest and the farthest of what is left.
//
// `range` holds (-nearest, farthest) of what was left before this pass; MAX blending forms the next one. A fragment
// that is neither goes on to the next pass; the first pass has an open range and only initialises it.
// Variants: none | counted | dataset
@if(dataset) import package::scene::shade::radiance as shade;
@if(!dataset) import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var range: texture_2d<f32>;
// 1: how much was peeled.
@if(counted) @group(1) @binding(1) var<storage, read_write> found: array<atomic<u32>, 2>;

struct Peeled {
    @location(0) range: vec2f,
    // Blended under what the layer holds of coincident fragments, dst.a * src + dst, alpha dst.a * (1 - src.a): zero changes nothing.
    // In a dataset un-premultiplied radiance and alpha, of which MAX blending over zero keeps that of the one fragment that matches.
    @location(1) front: vec4f,
    @location(2) back: vec4f,
}

// No depth is below it, so that MAX blending ignores it.
const NOTHING: f32 = -3.0e38;

@fragment
fn fragment_main(surface: Surface) -> Peeled {
    if !visible(surface) {
        discard;
    }
    let depth = surface.depth_linear;
    var out = Peeled(vec2f(NOTHING), vec4f(0.0), vec4f(0.0));
    let left = textureLoad(range, vec2u(surface.position.xy), 0).xy;
    let nearest = -left.x;
    let farthest = left.y;
    if depth < nearest || depth > farthest {
        discard;
    }
    // Where the two fronts meet, the last fragment counts as front.
    if depth == nearest {
        out.front = shade(surface);
    } else if depth == farthest {
        out.back = shade(surface);
    } else {
        out.range = vec2f(-depth, depth);
        return out;
    }
    @if(counted) atomicAdd(&found[1], 1u);
    return out;
}
