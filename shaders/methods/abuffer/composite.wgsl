// S-buffer: composites each sorted run front to back over C_0 (under-blending).
//
// Where runs are long, sums are compensated (Kahan 1965): their error does not grow with the number of fragments.
// Loops: 1: PIECE fragments, or SHORT.
// Variants: none | tinted | long | tinted long
import package::peel::runs::{Run, background, camera, carried, carry, fragments, is_in_pieces, last_piece, run_of, slot_at};

@if(tinted) alias Transmittance = vec3f;
@if(!tinted) alias Transmittance = f32;

struct State {
    color: vec3f,
    transmittance: Transmittance,
    // By how much they are too large.
    @if(long) color_excess: vec3f,
    @if(long) transmittance_excess: Transmittance,
}

fn begun() -> State {
    @if(long) return State(vec3f(0.0), Transmittance(1.0), vec3f(0.0), Transmittance(0.0));
    @if(!long) return State(vec3f(0.0), Transmittance(1.0));
}

// Zero, which no compiler knows: frames are smaller. Compilers take (a + b) - a for b, which rounding makes false here.
@if(long)
fn unknown_zero() -> u32 {
    return camera.frame_size.x >> 31u;
}

@if(long)
fn rounded(sum: Transmittance) -> Transmittance {
    @if(tinted) return rounded_color(sum);
    @if(!tinted) return bitcast<f32>(bitcast<u32>(sum) ^ unknown_zero());
}

@if(long)
fn rounded_color(sum: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(sum) ^ vec3u(unknown_zero()));
}

fn with_fragment(state: State, slot: u32) -> State {
    @if(!tinted) let fragment = fragments[slot];
    @if(!tinted) let covering = fragment.a;
    @if(tinted) let fragment = fragments[2u * slot];
    @if(tinted) let covering = fragments[2u * slot + 1u].rgb;
    var next = state;
    @if(!long) {
        next.color += state.transmittance * fragment.rgb;
        next.transmittance *= 1.0 - covering;
    }
    @else {
        let shown = state.transmittance * fragment.rgb - state.color_excess;
        next.color = rounded_color(state.color + shown);
        next.color_excess = rounded_color(next.color - state.color) - shown;
        let hidden = state.transmittance * covering + state.transmittance_excess;
        next.transmittance = rounded(state.transmittance - hidden);
        next.transmittance_excess = rounded(next.transmittance - state.transmittance) + hidden;
    }
    return next;
}

@if(long)
fn carry_on(run: Run, state: State) {
    carry(run, 0u, state.color);
    carry(run, 1u, state.color_excess);
    carry(run, 2u, vec3f(state.transmittance));
    carry(run, 3u, vec3f(state.transmittance_excess));
}

@if(long)
fn resumed(run: Run) -> State {
    @if(tinted) return State(carried(run, 0u), carried(run, 2u), carried(run, 1u), carried(run, 3u));
    @if(!tinted) return State(carried(run, 0u), carried(run, 2u).x, carried(run, 1u), carried(run, 3u).x);
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
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(!tinted) let covered = 1.0 - state.transmittance;
    @if(tinted) let covered = 1.0 - dot(state.transmittance, vec3f(1.0 / 3.0));
    return vec4f(state.color + state.transmittance * behind, covered);
}
