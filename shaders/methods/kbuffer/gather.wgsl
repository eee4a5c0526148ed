// kbuffer and hybrid, pass 2: a fragment among the K nearest stores its colour in its place, any other one is blended.
// Loops: 2: K, at most 64; ATTEMPTS.
// Variants: unweighted | eq7 | eq8 | eq9 | unweighted half_colors | eq9 byte_colors
import package::helpers::stored::{Stored, stored};
import package::helpers::weights::{weight_eq7, weight_eq8, weight_eq9};
import package::methods::kbuffer::key::{first_place, nearness};
import package::parameters::K;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read> nearest: array<u32>;
// Triangle + 1 of the fragment in each place; 0 while it is free.
@group(1) @binding(1) var<storage, read_write> triangles: array<atomic<u32>>;
@group(1) @binding(2) var<storage, read_write> colors: array<Stored>;

struct Tail {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @location(1) alpha: f32,
}

// Weak exchanges may fail though the place is free. A fragment that fails as often as this is blended into the tail.
const ATTEMPTS: u32 = 64u;

// Takes a place of this nearness; coplanar fragments have several. False where all are taken.
fn placed(first: u32, own: u32, triangle: u32, color: vec4f) -> bool {
    for (var i = first; i < first + K; i++) {
        if nearest[i] != own {
            continue;
        }
        for (var attempt = 0u; attempt < ATTEMPTS; attempt++) {
            let claim = atomicCompareExchangeWeak(&triangles[i], 0u, triangle + 1u);
            if claim.exchanged {
                colors[i] = stored(color);
                return true;
            }
            if claim.old_value != 0u {
                break;
            }
        }
    }
    return false;
}

@fragment
fn fragment_main(surface: Surface) -> Tail {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    let first = first_place(surface);
    let own = nearness(surface);
    if own >= nearest[first + K - 1u] && placed(first, own, surface.triangle, color) {
        return Tail(vec4f(0.0), 0.0);
    }
    @if(unweighted) let weight = 1.0;
    @if(eq7) let weight = weight_eq7(surface.depth_linear, color.a);
    @if(eq8) let weight = weight_eq8(surface.depth_linear, color.a);
    @if(eq9) let weight = weight_eq9(surface.depth_linear, color.a);
    return Tail(color * weight, color.a);
}
