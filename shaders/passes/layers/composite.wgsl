// The view of layers (of a renderer of ageing materials, 2018): the nearest fragment of the highlighted layer takes the share
// HIGHLIGHT_SHARE of the pixel, all in front of it the rest in equal parts, and what lies behind is not seen. `printed` is that
// renderer's formula as it stands in print: all others are seen, and the rest is divided by the number of all fragments.
// Loops: 1: PIECE fragments, or SHORT.
// Variants: none | increasing | printed | increasing printed | long | long increasing | long printed | long increasing printed
import package::parameters::{HIGHLIGHT, HIGHLIGHT_SHARE};
import package::peel::runs::{Run, background, carried, carry, fragments, is_in_pieces, last_piece, run_of, slot_at};

struct State {
    // The sum of the others, and their number.
    others: vec3f,
    count: f32,
    // Of the highlighted layer, the nearest one.
    highlighted: vec3f,
    found: bool,
    // The largest number of a layer so far.
    deepest: f32,
}

fn begun() -> State {
    return State(vec3f(0.0), 0.0, vec3f(0.0), false, -1.0);
}

fn with_fragment(state: State, slot: u32) -> State {
    var next = state;
    // Radiance and number of the layer.
    let fragment = fragments[slot];
    @if(!printed) {
        // Behind it nothing is seen.
        if state.found {
            return state;
        }
    }
    // Inwards only: the object's own far side is no further layer.
    @if(increasing) {
        if fragment.a <= state.deepest {
            return state;
        }
        next.deepest = fragment.a;
    }
    if !state.found && fragment.a == HIGHLIGHT {
        next.highlighted = fragment.rgb;
        next.found = true;
        return next;
    }
    next.others += fragment.rgb;
    next.count += 1.0;
    return next;
}

@if(long)
fn carry_on(run: Run, state: State) {
    carry(run, 0u, state.others);
    carry(run, 1u, state.highlighted);
    carry(run, 2u, vec3f(state.count, f32(state.found), state.deepest));
}

@if(long)
fn resumed(run: Run) -> State {
    let rest = carried(run, 2u);
    return State(carried(run, 0u), rest.x, carried(run, 1u), rest.y > 0.0, rest.z);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let run = run_of(pixel);
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
    if !state.found && state.count == 0.0 {
        return vec4f(textureLoad(background, pixel, 0).rgb, 0.0);
    }
    @if(printed) {
        let all = state.count + f32(state.found);
        return vec4f(HIGHLIGHT_SHARE * state.highlighted + (1.0 - HIGHLIGHT_SHARE) / all * state.others, 1.0);
    }
    @else {
        let rest = state.others / max(state.count, 1.0);
        let share = select(1.0, HIGHLIGHT_SHARE, state.count > 0.0);
        return vec4f(mix(rest, state.highlighted, select(0.0, share, state.found)), 1.0);
    }
}
