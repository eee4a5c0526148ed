// stochastic, pass 2: eq 6 with the share of samples that see the fragment as its weighted opacity. The resolve scales
// their sum to the coverage, which is exact (Enderton et al. 2010, "alpha correction").
// Loops: 1: SAMPLES, at most 256.
import package::methods::stochastic::samples::{covered, sample};
import package::parameters::SAMPLES;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read> nearest: array<u32>;

// Where no sample sees anything, the average colour stands in: a share of opacity that adds nothing visible elsewhere.
const UNSEEN: f32 = 0.000244140625;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let c = covered(surface, color.a);
    var seen = 0u;
    for (var t = 0u; t < c.count; t++) {
        seen += select(0u, 1u, nearest[sample(pixel, c, t)] == ~bitcast<u32>(surface.depth_linear));
    }
    let weight = f32(seen) / f32(SAMPLES) + UNSEEN * color.a;
    // The share that is seen stands for the opacity.
    return vec4f(color.rgb / max(color.a, 1e-6), 1.0) * weight;
}
