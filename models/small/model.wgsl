// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.
// Network: 5-1 (Relu hidden, Sigmoid last), 6 parameters, 5 multiply-adds. Recipe small, seed 1, 40 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 21.413115 in training.
// Input 1: place_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000179, validation 0.000166, test 0.000172.
// Held-out error, mean |T - T_exact|: boxes-held 0.00404, cups-held 0.00393, foliage-held 0.00262, panes-held 0.00095, sixteen-held 0.00166, smoke-held 0.00442.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(8.333773, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.28606492
// peelnet_weight(3.268195, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.42661902
// peelnet_weight(3.7688715, 0.5225114, 0.08770603, 0.111551285, 0.022744834) = 0.23633718
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target absorbances: 1.3862944, 0.6931472, 2.302585, -0.44323698
//    target nearest: 64928.0, -0.014541626, -64768.0, 0.11407471
//    target firsts: 0.18153855, 2.302585
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with several times the error.
//    quantiles: rgba8unorm, a texture of one texel for 8 by 8 pixels, read with linear interpolation; peelnet_even() where it is not drawn.
//    At its size, draw all transparent surfaces, in any order. let bins = peelnet_tile_bins(alpha, zeta);
//    bins_a: rgba8unorm, cleared to 0, blending ADD, from bins[0]
//    bins_b: rgba8unorm, cleared to 0, blending ADD, from bins[1]
//    bins_c: rgba8unorm, cleared to 0, blending ADD, from bins[2]
//    bins_d: rg8unorm, cleared to 0, blending ADD, from bins[3].xy
//    bins_e: rg8unorm, cleared to 0, blending ADD, from bins[3].zw
//    tile_nearest: r16float, cleared to -65504, blending MAX, from peelnet_tile_nearest(alpha, zeta)
//    Then each of its texels is peelnet_quantiles(sum): sum adds, over the 3 by 3 texels around it, peelnet_tile_seen(mat4x4f(bins_a, bins_b, bins_c, vec4f(bins_d, bins_e)), tile_nearest).
// 1. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta, quantiles);
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    firsts: rg16float, cleared to 0, blending ADD, from s.firsts
// 2. Pass "weights": draw all transparent surfaces, in any order. let w = peelnet_fragment(alpha, zeta, quantiles, absorbances, nearest, firsts).x;
//    sums: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

// A range of depths: 1 / near, 0 where depths are on a linear scale; near; 2 / its extent on the scale, 0 for a flat range.
struct PeelnetRange {
    inverse_near: f32,
    near: f32,
    scale: f32,
}

// near, far: the nearest and the farthest z that transparent surfaces have in this frame. The same for all fragments: it may be
// computed once a frame and passed in.
fn peelnet_range(near: f32, far: f32) -> PeelnetRange {
    let linear = near <= 0.0;
    let inverse_near = select(1.0 / max(near, 1.17549435e-38), 0.0, linear);
    let extent = select(log(max(far * inverse_near, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = extent <= select(1e-6, 0.0, linear);
    return PeelnetRange(inverse_near, near, select(2.0 / max(extent, 1e-30), 0.0, flat));
}

// The depth z on the scale of a range, -1 at near and 1 at far.
fn peelnet_zeta_in(z: f32, range: PeelnetRange) -> f32 {
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let logarithmic = log(max(z * range.inverse_near, 1.0));
    let from_near = select(logarithmic, z - range.near, range.inverse_near == 0.0);
    return clamp(from_near * range.scale - 1.0, -1.0, 1.0);
}

// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. Where near is not above 0 the scale is
// linear: with an orthographic camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    return peelnet_zeta_in(z, peelnet_range(near, far));
}

// -log(1 - alpha), at most 16: opaque, but finite.
fn peelnet_absorbance(alpha: f32) -> f32 {
    return -log(max(1.0 - alpha, 1.1253517e-7));
}

// The half floats that stand for levels: all normal halves in ascending order, so that MAX blending of 16-bit targets
// distinguishes 61440 levels. A step of a half's bits is 8192 in those of 32 bits; no step here rounds. No level is in the middle.
fn peelnet_halves(levels: vec3f) -> vec3f {
    let from_middle = levels - 30719.5;
    return sign(from_middle) * bitcast<vec3f>(vec3i(abs(from_middle) * 8192.0 + 947908608.0));
}

fn peelnet_levels(halves: vec3f) -> vec3f {
    let from_middle = vec3f(bitcast<vec3i>(abs(halves))) * 0.0001220703125 - 115711.5;
    return 30719.5 + sign(halves) * from_middle;
}

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

// Bins of depth, and levels of opacity in each, of the nearest fragment of a tile's pixel.
const PEELNET_TILE_DEPTHS: f32 = 240.0;
const PEELNET_TILE_OPACITIES: f32 = 256.0;

// The quantiles of a frame of which only near and far are known.
fn peelnet_even() -> vec4f {
    return vec4f(0.06, 0.35, 0.65, 0.94);
}

// Where a depth, 0 .. 1 of the frame's, lies among quantiles, 0 .. 1.
fn peelnet_place_among(depth: f32, quantiles: vec4f) -> f32 {
    let begin = vec4f(0.0, quantiles.xyz);
    let parts = clamp((vec4f(depth) - begin) / max(quantiles - begin, vec4f(1e-4)), vec4f(0.0), vec4f(1.0));
    let last = clamp((depth - quantiles.w) / max(1.0 - quantiles.w, 1e-4), 0.0, 1.0);
    return dot(parts, vec4f(0.06, 0.29, 0.3, 0.29)) + 0.06 * last;
}

// What a level adds to sixteen bins of depth: four in a column, nearest first.
fn peelnet_tile_levels(level: f32, depth: f32) -> mat4x4f {
    let place = clamp(depth * 16.0 - 0.5, 0.0, 15.0);
    return mat4x4f(
        peelnet_in_bins(level, place, 0.0),
        peelnet_in_bins(level, place, 4.0),
        peelnet_in_bins(level, place, 8.0),
        peelnet_in_bins(level, place, 12.0),
    );
}

// What a fragment adds to the bins of its tile, of 8 bits.
fn peelnet_tile_bins(alpha: f32, zeta: f32) -> mat4x4f {
    return peelnet_tile_levels(peelnet_level(peelnet_absorbance(alpha)), 0.5 * zeta + 0.5);
}

// What a fragment writes as the nearest of its tile's pixel, where the most is kept.
fn peelnet_tile_nearest(alpha: f32, zeta: f32) -> f32 {
    let b = peelnet_absorbance(alpha);
    let bin = min(floor((0.5 * zeta + 0.5) * PEELNET_TILE_DEPTHS), PEELNET_TILE_DEPTHS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (PEELNET_TILE_OPACITIES - 1.0)) + 0.5);
    return peelnet_halves(vec3f((PEELNET_TILE_DEPTHS - 1.0 - bin) * PEELNET_TILE_OPACITIES + opacity)).x;
}

// What the columns of bins before each hold together.
fn peelnet_before(bins: mat4x4f) -> vec4f {
    let all = vec4f(1.0) * bins;
    return vec4f(0.0, all.x, all.x + all.y, all.x + all.y + all.z);
}

// Of four bins what is seen behind the nearest fragment. before: what all bins before them hold.
fn peelnet_seen(bins: vec4f, taken: vec4f, before: f32) -> vec4f {
    let through = peelnet_seen_behind(before, bins);
    let seen = vec4f(exp(before * (-255.0 / PEELNET_BIN_LEVELS)), through.xyz) - through;
    return seen * max(bins - taken, vec4f(0.0)) / max(bins, vec4f(1.0 / 255.0));
}

// What is seen in a tile's pixel behind its nearest fragment. bins, nearest: as the targets hold them.
fn peelnet_tile_seen(bins: mat4x4f, nearest: f32) -> mat4x4f {
    let level = max(peelnet_levels(vec3f(nearest)).x, 0.0);
    let back = floor(level * (1.0 / PEELNET_TILE_OPACITIES));
    let opacity = (level - back * PEELNET_TILE_OPACITIES) * (1.0 / (PEELNET_TILE_OPACITIES - 1.0));
    let depth = (PEELNET_TILE_DEPTHS - back - 0.5) / PEELNET_TILE_DEPTHS;
    let taken = peelnet_tile_levels(peelnet_level(opacity / (1.0625 - opacity)), depth);
    let before = peelnet_before(bins);
    return mat4x4f(
        peelnet_seen(bins[0], taken[0], before.x),
        peelnet_seen(bins[1], taken[1], before.y),
        peelnet_seen(bins[2], taken[2], before.z),
        peelnet_seen(bins[3], taken[3], before.w),
    );
}

// How many of four bins lie before a share. before: what the bins before them hold.
fn peelnet_passed(share: f32, before: f32, bins: vec4f) -> f32 {
    let two = bins.x + bins.y;
    let begin = vec4f(before) + vec4f(0.0, bins.x, two, two + bins.z);
    return dot(clamp((vec4f(share) - begin) / max(bins, vec4f(1e-9)), vec4f(0.0), vec4f(1.0)), vec4f(1.0));
}

// The depth before which a share of sixteen bins lies. before: as of peelnet_before.
fn peelnet_depth_at(share: f32, bins: mat4x4f, before: vec4f) -> f32 {
    let front = peelnet_passed(share, before.x, bins[0]) + peelnet_passed(share, before.y, bins[1]);
    return 0.0625 * (front + peelnet_passed(share, before.z, bins[2]) + peelnet_passed(share, before.w, bins[3]));
}

// The quantiles of what is seen in nine pixels together.
fn peelnet_quantiles(seen: mat4x4f) -> vec4f {
    // Evenly spread where nothing is known.
    let even = vec4f(0.00125);
    let bins = seen + mat4x4f(even, even, even, even);
    let before = peelnet_before(bins);
    let shares = peelnet_even() * (before.w + dot(bins[3], vec4f(1.0)));
    return vec4f(
        peelnet_depth_at(shares.x, bins, before),
        peelnet_depth_at(shares.y, bins, before),
        peelnet_depth_at(shares.z, bins, before),
        peelnet_depth_at(shares.w, bins, before),
    );
}

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

// Where a slab ends and the next begins, in the pixel, and the number of the last slab.
const PEELNET_FIRST_END: f32 = 0.49;
const PEELNET_SECOND_END: f32 = 0.77;
const PEELNET_THIRD_END: f32 = 1.0;
const PEELNET_LAST_SLAB: f32 = 2.0;

struct PeelnetStatistics {
    // Absorbance of each of three slabs; absorbance times depth in the slab, of the first.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments, and of the farthest of the first.
    nearest: vec4f,
    // Absorbance times depth in the slab, of the other two.
    firsts: vec2f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32, quantiles: vec4f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, quantiles);
    let halves = peelnet_records(alpha, place);
    let absorbances = peelnet_in_slab(place.absorbance, place.slab, 0.0);
    let nearest = peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let farthest = select(halves.y, PEELNET_EMPTY, place.slab > 0.0);
    return PeelnetStatistics(vec4f(absorbances.xyz, firsts.x), vec4f(nearest.xyz, farthest), firsts.yz);
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(alpha: f32, zeta: f32, quantiles: vec4f, absorbances: vec4f, nearest: vec4f, firsts: vec2f) -> vec2f {
    let place = peelnet_place(alpha, zeta, quantiles);
    let means = vec4f(absorbances.w, firsts, 0.0);
    let last = vec4f(nearest.w, vec3f(PEELNET_EMPTY));
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, means, nearest, last, 1.0);
}

// The colour and coverage of a pixel with 16-bit sums, which may become infinite. absorbance: the pixel's total.
fn peelnet_resolve(sums: vec4f, absorbance: f32, background: vec3f) -> vec4f {
    let transmittance = exp(-absorbance);
    return peelnet_composite(min(sums, vec4f(65504.0)), 1.0 - transmittance, vec3f(transmittance), background);
}

// The colour and coverage of a pixel. sums: alpha * rgb * w and alpha * w of all fragments, finite. transmittance: of red, green
// and blue light; coverage: 1 less their mean. Where nothing is covered the background stays as it is.
fn peelnet_composite(sums: vec4f, coverage: f32, transmittance: vec3f, background: vec3f) -> vec4f {
    let average = select(vec3f(0.0), sums.rgb / max(sums.a, 1.17549435e-38), sums.a > 0.0 && coverage > 0.0);
    return vec4f(average * coverage + background * transmittance, coverage);
}

// The network's answer for what is known of a fragment.
fn peelnet_network(between: PeelnetBetween) -> f32 {
    return peelnet_share(
        sqrt(between.absorbance), between.place, between.mean, between.low, between.high);
}

// Where between its bounds the share of the absorbance lies that is in front, for inputs as peelnet_network evaluates them.
fn peelnet_share(root_absorbance: f32, place_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let input_a = vec4f(root_absorbance, place_fraction, mean_fraction, share_low);
    let input_b = vec4f(share_high, 0.0, 0.0, 0.0);
    let layer_a_a = 1.0 / (1.0 + exp(min(-(-2.3941505
        + dot(vec4f(-0.1540126, 0.85447216, -0.4019599, 4.09488), input_a)
        + 1.8473954 * input_b.x), 80.0)));
    return layer_a_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, place_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    let share = peelnet_share(
        clamp(root_absorbance, -47076.56, 47088.934), clamp(place_fraction, -2684.1946, 2685.5208), clamp(mean_fraction, -1983.4043, 1984.7168), clamp(share_low, -1842.8657, 1843.1003), clamp(share_high, -2216.2056, 2217.918));
    let bounds = clamp(vec2f(share_low, share_high), vec2f(0.0), vec2f(1.0));
    return exp(-root * root * mix(bounds.x, bounds.y, share));
}
