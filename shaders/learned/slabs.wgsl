// Fragments of less opacity are composited, but are never a slab's nearest or farthest.
const PEELNET_FAINT: f32 = 0.003921569;
// Bins of depth in a slab, and levels of opacity in each, that its nearest and its farthest fragment are kept with.
const PEELNET_BINS: f32 = 1920.0;
const PEELNET_OPACITIES: f32 = 32.0;
// What targets of levels are cleared to: the least half.
const PEELNET_EMPTY: f32 = -65504.0;

// Where in its pixel's slabs a fragment lies.
struct PeelnetPlace {
    absorbance: f32,
    // 0, the nearest, to PEELNET_LAST_SLAB.
    slab: f32,
    // In the slab, -1 .. 1.
    inside: f32,
    bin: f32,
    // Levels as the slab's nearest, counted from the far end, and as its farthest.
    near: f32,
    far: f32,
}

// What lies in a fragment's slab besides the fragment and the slab's known ends. Depths are 0 at the nearer and 1 at the farther of the two.
struct PeelnetBetween {
    // Absorbance of it.
    absorbance: f32,
    // Depth of the fragment.
    place: f32,
    // Mean depth of the absorbance.
    mean: f32,
    // The least and the most of the absorbance that can lie in front of the fragment, as shares.
    low: f32,
    high: f32,
    // Half of what the two ends are apart, in slabs.
    extent: f32,
    // Absorbance of the fragment.
    own: f32,
    // Absorbance of the ends that lies in front: the nearer end's, and half of an end's in the fragment's own bin.
    nearest: f32,
}

fn peelnet_place(alpha: f32, zeta: f32, quantiles: vec4f) -> PeelnetPlace {
    let b = peelnet_absorbance(alpha);
    let t = peelnet_place_among(0.5 * zeta + 0.5, quantiles);
    let first = select(0.0, 1.0, t >= PEELNET_FIRST_END);
    let passed = first + select(0.0, 1.0, t >= PEELNET_SECOND_END) + select(0.0, 1.0, t >= PEELNET_THIRD_END);
    let slab = min(passed, PEELNET_LAST_SLAB);
    let begin = peelnet_of_slab(vec4f(0.0, PEELNET_FIRST_END, PEELNET_SECOND_END, PEELNET_THIRD_END), slab);
    let end = peelnet_of_slab(vec4f(PEELNET_FIRST_END, PEELNET_SECOND_END, PEELNET_THIRD_END, 1.0), slab);
    let inside = (t - begin) / (end - begin);
    let bin = min(floor(inside * PEELNET_BINS), PEELNET_BINS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (PEELNET_OPACITIES - 1.0)) + 0.5);
    let near = (PEELNET_BINS - 1.0 - bin) * PEELNET_OPACITIES + opacity;
    return PeelnetPlace(b, slab, 2.0 * inside - 1.0, bin, near, bin * PEELNET_OPACITIES + opacity);
}

// What a fragment writes of itself as its slab's nearest and as its farthest, into targets under MAX.
fn peelnet_records(alpha: f32, place: PeelnetPlace) -> vec2f {
    let levels = peelnet_halves(vec3f(place.near, place.far, place.far)).xy;
    return select(levels, vec2f(PEELNET_EMPTY), alpha < PEELNET_FAINT);
}

// The absorbances that two levels stand for.
fn peelnet_absorbances_of(levels: vec2f) -> vec2f {
    let share = (levels - floor(levels * (1.0 / PEELNET_OPACITIES)) * PEELNET_OPACITIES) * (1.0 / (PEELNET_OPACITIES - 1.0));
    return share / (vec2f(1.0625) - share);
}

// The depth in a slab in the middle of a bin.
fn peelnet_middle_of(bin: f32) -> f32 {
    return (bin + 0.5) * (2.0 / PEELNET_BINS) - 1.0;
}

// A slab's channel. Not by products: sums of 16 bits may be infinite.
fn peelnet_of_slab(values: vec4f, slab: f32) -> f32 {
    return select(select(values.x, values.y, slab == 1.0), select(values.z, values.w, slab == 3.0), slab >= 2.0);
}

fn peelnet_in_slab(value: f32, slab: f32, elsewhere: f32) -> vec4f {
    return vec4f(
        select(elsewhere, value, slab == 0.0),
        select(elsewhere, value, slab == 1.0),
        select(elsewhere, value, slab == 2.0),
        select(elsewhere, value, slab == 3.0),
    );
}

// total and first: the slab's sums. levels: its nearest and its farthest fragment, -1 where it keeps none.
fn peelnet_between(place: PeelnetPlace, total: f32, first: f32, levels: vec2f) -> PeelnetBetween {
    let b = place.absorbance;
    let others = max(total - b, 0.0);
    // Where the rest is no more than the rounding of 16-bit sums, its mean is noise.
    let noise = max(total * 0.0009765625, 1e-6);
    let near_back = floor(levels.x * (1.0 / PEELNET_OPACITIES));
    let near_bin = PEELNET_BINS - 1.0 - near_back;
    let near_level = levels.x + (near_bin - near_back) * PEELNET_OPACITIES;
    let known = peelnet_absorbances_of(levels);
    // All others, as far as the level's rounding and the sum's can tell.
    let step = 0.6 / (PEELNET_OPACITIES - 1.0);
    let all = known.x > others - (step * (1.0 + known.x) * (1.0 + known.x) + noise);
    let near = select(select(known.x, others, all), 0.0, near_bin > place.bin);
    let far_bin = floor(levels.y * (1.0 / PEELNET_OPACITIES));
    let is_one = levels.y == near_level || levels.y < 0.0;
    let far = select(known.y, 0.0, is_one || far_bin < place.bin);
    var begin = peelnet_middle_of(near_bin);
    var end = select(peelnet_middle_of(far_bin), 1.0, is_one);
    let rest = total - b - near - far;
    let moment = first - b * place.inside - near * begin - far * end;
    begin = select(begin, -1.0, begin > place.inside);
    end = select(end, 1.0, end < place.inside);
    // In one bin nobody knows which of two is in front: half of the other is.
    let in_front = near * select(1.0, 0.5, near_bin == place.bin) + far * select(0.0, 0.5, far_bin == place.bin);
    let extent = max(end - begin, 2.0 / PEELNET_BINS);
    let per_extent = 1.0 / extent;
    let x = clamp((place.inside - begin) * per_extent, 0.0, 1.0);
    let depth = clamp(moment / max(rest, noise), begin, end);
    let mean = clamp((depth - begin) * per_extent, 0.0, 1.0);
    // Markov's bounds of the share in front.
    let before = x < mean;
    let bound = select(x - mean, 1.0 - mean, before) / max(select(x, 1.0 - x, before), 1e-6);
    let low = select(bound, 0.0, before);
    let high = select(1.0, bound, before);
    return PeelnetBetween(max(rest, 0.0), x, mean, low, high, 0.5 * extent, b, in_front);
}

// Whether a fragment's level is the one kept. Two passes may round a depth on the edge of two bins to either, so a bin's difference counts
// as none.
fn peelnet_is_kept(own: f32, kept: f32) -> bool {
    let apart = abs(own - kept);
    return apart == 0.0 || apart == PEELNET_OPACITIES;
}

// The weight of a fragment, and whether it is known without the network: 1 where it is its slab's nearest or farthest. absorbances, firsts,
// nearest, farthest: by slab. ends: how many of the nearer slabs keep a farthest fragment.
fn peelnet_weigh(
    place: PeelnetPlace,
    counts: bool,
    absorbances: vec4f,
    firsts: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    ends: f32,
) -> vec2f {
    // Sums of 16-bit targets may become infinite.
    let sums = min(absorbances, vec4f(65504.0));
    let total = peelnet_of_slab(sums, place.slab);
    let first = clamp(peelnet_of_slab(firsts, place.slab), -65504.0, 65504.0);
    let halves = vec2f(peelnet_of_slab(nearest, place.slab), peelnet_of_slab(farthest, place.slab));
    let decoded = peelnet_levels(vec3f(halves, halves.y)).xy;
    let levels = select(vec2f(decoded.x, -1.0), decoded, place.slab < ends);
    let before = select(0.0, sums.x, place.slab > 0.0)
        + select(0.0, sums.y, place.slab > 1.0)
        + select(0.0, sums.z, place.slab > 2.0);
    let is_near = counts && peelnet_is_kept(place.near, levels.x);
    let is_far = counts && levels.y >= 0.0 && peelnet_is_kept(place.far, levels.y) && !is_near;
    let known = is_near || is_far;
    // No branch around it: neighbouring fragments are rarely all known, and then it only costs.
    let between = peelnet_between(place, total, first, levels);
    let share = between.low + (between.high - between.low) * peelnet_network(between);
    let at_end = select(0.0, max(total - place.absorbance, 0.0), is_far);
    let inside = select(between.nearest + between.absorbance * share, at_end, known);
    // The nearest fragment's weight is 1: their sum cannot vanish.
    return vec2f(exp(-(before + inside)), select(0.0, 1.0, known));
}
