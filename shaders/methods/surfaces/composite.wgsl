// Two hashes of the names of a pixel's surfaces in sorted order, and the number of its fragments.
import package::helpers::hash::pcg;
import package::helpers::screen::screen_corner;
import package::peel::runs::{fragments, run_of};

// Bits that a hash loses: 22 are left, so that four of them add up exactly in 32-bit floats.
const LOST_BITS: u32 = 10u;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let run = run_of(vec2u(position.xy));
    var first = 0u;
    var second = 1u;
    for (var i = run.begin; i < run.end; i++) {
        // Number of the material, of which every part of an object has its own, and side.
        let name = 2u * u32(fragments[i].x) + u32(fragments[i].y);
        first = pcg(first ^ name);
        second = pcg(second + name);
    }
    return vec4f(f32(first >> LOST_BITS), f32(second >> LOST_BITS), 0.0, f32(run.end - run.begin));
}
