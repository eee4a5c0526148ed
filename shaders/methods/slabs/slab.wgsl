// Where in its pixel's slabs a fragment lies, and the levels that keep a slab's nearest and farthest fragment; twin of
// peelnet_core::methods::slabs.
import package::helpers::absorbance::absorbance;

// Fragments of less opacity are composited, but are never a slab's nearest or farthest.
const FAINT: f32 = 0.003921569;
// Levels of the range of depths, less one.
const RANGE_TOP: f32 = 255.0;
// Bins of depth in a slab, and levels of opacity in each.
const BINS: f32 = 1920.0;
const OPACITIES: f32 = 32.0;
// The least half: level 0.
const EMPTY: f32 = -65504.0;

const CHANNELS: vec4f = vec4f(0.0, 1.0, 2.0, 3.0);

struct Place {
    absorbance: f32,
    // 0, the nearest, to 3.
    slab: f32,
    // In the slab, -1 .. 1.
    inside: f32,
    bin: f32,
    // Levels as the slab's nearest, counted from the far end, and as its farthest.
    near: f32,
    far: f32,
}

// What a fragment writes of the pixel's range: level of depth from the far end, rounded down, and from the near end, rounded up.
fn range_of(zeta: f32) -> vec2f {
    let level = RANGE_TOP * (zeta * 0.5 + 0.5);
    return vec2f(RANGE_TOP - floor(level), ceil(level)) / RANGE_TOP;
}

fn place_of(alpha: f32, zeta: f32, range: vec2f) -> Place {
    let ends = floor(range * RANGE_TOP + 0.5);
    let low = RANGE_TOP - ends.x;
    let t = clamp((RANGE_TOP * (zeta * 0.5 + 0.5) - low) / max(ends.y - low, 1.0), 0.0, 1.0);
    let b = absorbance(alpha);
    // Borders at 0.2, 0.5 and 0.8.
    let far_half = t >= 0.5;
    let second = select(t >= 0.2, t >= 0.8, far_half);
    let slab = select(0.0, 2.0, far_half) + select(0.0, 1.0, second);
    let begin = select(select(0.0, 0.2, second), select(0.5, 0.8, second), far_half);
    let end = select(select(0.2, 0.5, second), select(0.8, 1.0, second), far_half);
    let inside = (t - begin) / (end - begin);
    let bin = min(floor(inside * BINS), BINS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (OPACITIES - 1.0)) + 0.5);
    let near = (BINS - 1.0 - bin) * OPACITIES + opacity;
    return Place(b, slab, 2.0 * inside - 1.0, bin, near, bin * OPACITIES + opacity);
}

// The half floats that stand for levels: all normal halves in ascending order. A step of a half's bits is 8192 in those of 32 bits.
fn halves_of(levels: vec2f) -> vec2f {
    let from_middle = levels - 30719.5;
    return sign(from_middle) * bitcast<vec2f>(vec2i(abs(from_middle) * 8192.0 + 947908608.0));
}

fn levels_of(halves: vec2f) -> vec2f {
    let from_middle = vec2f(bitcast<vec2i>(abs(halves))) * 0.0001220703125 - 115711.5;
    return 30719.5 + sign(halves) * from_middle;
}

// The absorbance that a level stands for.
fn absorbance_of(level: f32) -> f32 {
    let share = (level - floor(level / OPACITIES) * OPACITIES) / (OPACITIES - 1.0);
    return share / (1.0625 - share);
}

// The depth in a slab in the middle of a bin.
fn middle_of(bin: f32) -> f32 {
    return (bin + 0.5) * (2.0 / BINS) - 1.0;
}

// A slab's channel. Not by products: sums of 16 bits may be infinite.
fn of_slab(values: vec4f, slab: f32) -> f32 {
    return select(select(values.x, values.y, slab == 1.0), select(values.z, values.w, slab == 3.0), slab >= 2.0);
}

fn in_slab(value: f32, slab: f32, elsewhere: f32) -> vec4f {
    return select(vec4f(elsewhere), vec4f(value), CHANNELS == vec4f(slab));
}
