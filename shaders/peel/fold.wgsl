// Composites a piece of every run that has another piece behind it. `step` counts pieces: one dispatch for each.
// Loops: 1: PIECE fragments.
// Variants: long abuffer | long abuffer tinted | long surfaces | long layers | long layers increasing | long layers printed | long layers increasing printed
@if(abuffer) import package::methods::abuffer::composite::{begun, carry_on, resumed, with_fragment};
@if(layers) import package::passes::layers::composite::{begun, carry_on, resumed, with_fragment};
@if(surfaces) import package::passes::surfaces::composite::{begun, carry_on, resumed, with_fragment};
import package::peel::runs::{PIECE, run_at, slot_at, tile};

@group(0) @binding(6) var<uniform> step: vec4u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = tile.begin + id.y * tile.groups * 64u + id.x;
    if pixel >= tile.end {
        return;
    }
    let run = run_at(pixel);
    let begin = run.begin + step.x * PIECE;
    if begin + PIECE >= run.end {
        return;
    }
    var state = begun();
    if step.x > 0u {
        state = resumed(run);
    }
    for (var i = begin; i < begin + PIECE; i++) {
        state = with_fragment(state, slot_at(i));
    }
    carry_on(run, state);
}
