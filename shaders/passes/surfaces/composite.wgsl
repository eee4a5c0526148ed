// Two hashes of the names of a pixel's surfaces in sorted order, and the number of its fragments.
// Loops: 1: PIECE fragments, or SHORT.
// Variants: none | long
import package::helpers::hash::pcg;
import package::peel::runs::{Run, carried, carry, fragments, is_in_pieces, last_piece, run_of, slot_at};

// Bits that a hash loses: 22 are left, so that four of them add up exactly in 32-bit floats.
const LOST_BITS: u32 = 10u;

struct State {
    first: u32,
    second: u32,
}

fn begun() -> State {
    return State(0u, 1u);
}

fn with_fragment(state: State, slot: u32) -> State {
    // Number of the material, of which every part of an object has its own, and side.
    let name = 2u * u32(fragments[slot].x) + u32(fragments[slot].y);
    return State(pcg(state.first ^ name), pcg(state.second + name));
}

// In halves, which floats hold: the bits of a hash may be those of a NaN.
@if(long)
fn carry_on(run: Run, state: State) {
    let words = vec2u(state.first, state.second);
    carry(run, 0u, vec3f(vec2f(words & vec2u(0xffffu)), 0.0));
    carry(run, 1u, vec3f(vec2f(words >> vec2u(16u)), 0.0));
}

@if(long)
fn resumed(run: Run) -> State {
    let words = vec2u(carried(run, 0u).xy) | (vec2u(carried(run, 1u).xy) << vec2u(16u));
    return State(words.x, words.y);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let run = run_of(vec2u(position.xy));
    var state = begun();
    @if(long) {
        if is_in_pieces(run) {
            state = resumed(run);
        }
    }
    let piece = last_piece(run);
    for (var i = piece.begin; i < piece.end; i++) {
        state = with_fragment(state, slot_at(i));
    }
    return vec4f(f32(state.first >> LOST_BITS), f32(state.second >> LOST_BITS), 0.0, f32(run.end - run.begin));
}
