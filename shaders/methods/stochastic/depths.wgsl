// stochastic, pass 1: the nearest depth of every sample, and the transmittance of the whole pixel.
// Loops: 1: SAMPLES, at most 256.
import package::methods::stochastic::samples::{covered, sample};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

// All bits inverted, so that the nearest is the largest and 0 is none.
@group(1) @binding(0) var<storage, read_write> nearest: array<atomic<u32>>;

@fragment
fn fragment_main(surface: Surface) -> @location(0) f32 {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let alpha = opacity(surface);
    let c = covered(surface, alpha);
    for (var t = 0u; t < c.count; t++) {
        atomicMax(&nearest[sample(pixel, c, t)], ~bitcast<u32>(surface.depth_linear));
    }
    return alpha;
}
