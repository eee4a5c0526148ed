// Levels of 8 bits that an absorbance of 1 is.
const PEELNET_BIN_LEVELS: f32 = 64.0;

// A depth on a scale without two gaps in which no transparent surface lies, -1 .. 1 again. gaps: the ends of the nearer and of the farther one, as
// zeta; four times 1 where there is none. The same in all passes of a frame.
fn peelnet_cut(zeta: f32, gaps: vec4f) -> f32 {
    let lengths = gaps.yw - gaps.xz;
    let passed = clamp(vec2f(zeta) - gaps.xz, vec2f(0.0), lengths);
    let kept = zeta + 1.0 - passed.x - passed.y;
    return kept * (2.0 / (2.0 - lengths.x - lengths.y)) - 1.0;
}

// An absorbance as a level of 8 bits. At least one: a bin with any fragment is not empty.
fn peelnet_level(absorbance: f32) -> f32 {
    return max(floor(absorbance * PEELNET_BIN_LEVELS + 0.5), 1.0);
}

// What a level adds to four bins from a first one, 0 .. 1. It is shared between the two bins whose middles it lies between, so that little
// changes as it moves from one to the other, and in whole levels, so that no order of adding changes a sum. place: 0 in the middle of bin 0,
// 1 in that of the next.
fn peelnet_in_bins(level: f32, place: f32, first: f32) -> vec4f {
    let middles = vec4f(first, first + 1.0, first + 2.0, first + 3.0);
    let shares = max(vec4f(1.0) - abs(vec4f(place) - middles), vec4f(0.0));
    return floor(level * shares + 0.5) / 255.0;
}

// What is let through by each of four bins and by what is before it.
fn peelnet_seen_behind(before: f32, bins: vec4f) -> vec4f {
    let two = bins.x + bins.y;
    let levels = vec4f(before) + vec4f(bins.x, two, two + bins.z, two + bins.z + bins.w);
    return exp(levels * (-255.0 / PEELNET_BIN_LEVELS));
}
