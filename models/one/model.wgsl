// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe one, seed 1, 40 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of twice the absorbance in front, by the formula), 0.000093077906 .. 15.9079275 in training.
// Input 1: root_total (root of the absorbance of all sums), 0.02891372 .. 21.513378 in training.
// Input 2: share_before (of the absorbance of all sums), 0.0 .. 0.9999994 in training.
// Input 3: share_own (of the absorbance of all sums), 1.7657054e-9 .. 1.0 in training.
// Input 4: share_previous (of the absorbance of all sums), 0.0 .. 0.97727245 in training.
// Input 5: share_next (of the absorbance of all sums), 0.0 .. 0.99999946 in training.
// Input 6: nearest_alpha (1), 0.0007731032 .. 0.99905795 in training.
// Input 7: nearest_place (among the quantiles), 0.00012485312 .. 0.99942017 in training.
// Input 8: number (0 for the first, 1 for the last sum), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000611, validation 0.000593, test 0.000615.
// Held-out error, mean |T - T_exact|: boxes-held 0.02373, cups-held 0.02206, foliage-held 0.01878, panes-held 0.00820, sixteen-held 0.01624, smoke-held 0.01757.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.36191413, 14.441937, 0.1688791, 0.7373583, 0.18772307, 0.034303825, 0.12910137, 0.435657, 0.7663156) = 0.8772337
// peelnet_weight(3.9770136, 18.642227, 0.7144341, 0.43257523, 0.14753379, 0.62058616, 0.794909, 0.9875111, 0.36102802) = 0.47685304
// peelnet_weight(1.9873397, 0.5672196, 0.37864107, 0.595821, 0.2760697, 0.3106894, 0.6235468, 0.40476447, 0.91731685) = 0.052649572
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.49703375
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.2812811
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.108837925
//    colour of the pixel: 0.61373997, 0.352721, 0.24796969
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with several times the error. noise is any number in 0 .. 1 that is the same for all of a pixel, such as peelnet_noise(pixel): it hides the steps of what is kept of the nearest fragment; 0.5 where that does not matter.
//    quantiles: rgba8unorm, a texture of one texel for 8 by 8 pixels, read with linear interpolation; peelnet_even() where it is not drawn.
//    At its size, draw all transparent surfaces, in any order. let bins = peelnet_tile_bins(alpha, zeta);
//    bins_a: rgba8unorm, cleared to 0, blending ADD, from bins[0]
//    bins_b: rgba8unorm, cleared to 0, blending ADD, from bins[1]
//    bins_c: rgba8unorm, cleared to 0, blending ADD, from bins[2]
//    bins_d: rg8unorm, cleared to 0, blending ADD, from bins[3].xy
//    bins_e: rg8unorm, cleared to 0, blending ADD, from bins[3].zw
//    tile_nearest: r16float, cleared to -65504, blending MAX, from peelnet_tile_nearest(alpha, zeta)
//    Then each of its texels is peelnet_quantiles(sum): sum adds, over the 3 by 3 texels around it, peelnet_tile_seen(mat4x4f(bins_a, bins_b, bins_c, vec4f(bins_d, bins_e)), tile_nearest).
//    Or make it without that pass from what the last frame kept of the pixel in the middle of each of them, of peelnet_last_seen(sum_a, sum_b, sum_c, absorbances, quantiles, noise), but for the first frame and after jumps of the camera.
// 1. Pass "gather": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, rgb, zeta, quantiles, noise);
//    sum_a: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_a
//    sum_b: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_b
//    sum_c: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_c
//    absorbances: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.absorbances
// 2. Resolve: peelnet_resolve(sum_a, sum_b, sum_c, absorbances, quantiles, noise, background) is the colour of the pixel, and its coverage in alpha.
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

// Levels of depth, and of a value in each, that a pixel's nearest fragment is kept with.
const PEELNET_DEPTHS: f32 = 480.0;
const PEELNET_VALUES: f32 = 128.0;
// b / (1 + b) of the most absorbance.
const PEELNET_MOST: f32 = 0.941176471;

// What is known of how much lies in front of one of a pixel's sums.
struct PeelnetAhead {
    // By the formula.
    absorbance: f32,
    // Absorbance of all sums, and the shares of it in the sums before, in this one, and in those before and behind it.
    total: f32,
    before: f32,
    own: f32,
    previous: f32,
    next: f32,
    // Opacity of the nearest fragment, and where it lies among the quantiles.
    alpha: f32,
    place: f32,
    // 0 for the first sum, 1 for the last.
    number: f32,
}

struct PeelnetNearest {
    color: vec3f,
    absorbance: f32,
    place: f32,
    // Coverage of the pixel, the nearest fragment's part of it, and what is left for the sums.
    coverage: f32,
    alpha: f32,
    left: f32,
}

// The noise of a pixel, 0 .. 1: neighbours' lie far apart (Roberts 2018, the sequence R2).
fn peelnet_noise(pixel: vec2u) -> f32 {
    return f32((pixel.x * 12664746u + pixel.y * 9560334u) & 16777215u) * (1.0 / 16777216.0);
}

// Values without bound in 0 .. 1, in even steps of a root, and back.
fn peelnet_to_unit(values: vec4f) -> vec4f {
    let kept = max(values, vec4f(0.0));
    return sqrt(min(kept / (vec4f(1.0) + kept) * (1.0 / PEELNET_MOST), vec4f(1.0)));
}

fn peelnet_from_unit(units: vec4f) -> vec4f {
    let shares = units * units * PEELNET_MOST;
    return shares / (vec4f(1.0) - shares);
}

// What a fragment writes as its pixel's nearest: red, green, blue and absorbance, each behind its depth, where the most is kept.
fn peelnet_record(b: f32, rgb: vec3f, depth: f32, place: f32, noise: f32) -> vec4f {
    let bin = clamp(floor(0.5 * (depth + place) * PEELNET_DEPTHS), 0.0, PEELNET_DEPTHS - 1.0);
    let top = PEELNET_VALUES - 1.0;
    let values = min(floor(peelnet_to_unit(vec4f(rgb, b)) * top + noise), vec4f(top));
    let levels = values + (PEELNET_DEPTHS - 1.0 - bin) * PEELNET_VALUES;
    return vec4f(peelnet_halves(levels.xyz), peelnet_halves(levels.www).x);
}

// The nearest fragment. halves: as the targets hold it. sums: of all sums red, green, blue and absorbance.
fn peelnet_nearest(halves: vec4f, sums: vec4f, quantiles: vec4f, noise: f32) -> PeelnetNearest {
    let levels = max(vec4f(peelnet_levels(halves.xyz), peelnet_levels(halves.www).x), vec4f(0.0));
    let back = floor(levels * (1.0 / PEELNET_VALUES));
    let top = PEELNET_VALUES - 1.0;
    let steps = levels - back * PEELNET_VALUES + (0.5 - noise);
    let units = clamp(steps / top, vec4f(0.0), vec4f(1.0));
    let values = peelnet_from_unit(units);
    let on_scale = (PEELNET_DEPTHS - back.w - 0.5) / PEELNET_DEPTHS;
    let place = peelnet_place_among(on_scale, 0.5 * (quantiles + peelnet_even()));
    let one = 1.0 + values.w;
    let slack = 2.0 * peelnet_to_unit(values.wwww).x * PEELNET_MOST * one * one / top;
    // All there is, as far as roundings can tell: its colour is the mean.
    let alone = sums.w - values.w <= slack + sums.w * 0.0009765625;
    let color = select(values.xyz, sums.xyz / max(sums.w, 1e-6), alone);
    let absorbance = select(values.w, sums.w, alone);
    let coverage = 1.0 - exp(-sums.w);
    let alpha = min(1.0 - exp(-absorbance), coverage);
    return PeelnetNearest(color, absorbance, place, coverage, alpha, coverage - alpha);
}

// A sum without the nearest fragment: red, green, blue and absorbance.
fn peelnet_behind(rgb: vec3f, b: f32, share: f32, nearest: PeelnetNearest) -> vec4f {
    let taken = nearest.absorbance * share;
    return vec4f(max(min(rgb, vec3f(65504.0)) - taken * nearest.color, vec3f(0.0)), max(b - taken, 0.0));
}

// What an even mixture of some absorbance has in front of itself: log(b / (1 - exp(-b))).
fn peelnet_inside(b: f32) -> f32 {
    let some = max(b, 0.02);
    return select(log(some / (1.0 - exp(-some))), b * (0.5 - b / 24.0), b < 0.02);
}

// How much of a sum is seen. before, previous, next: absorbances of the sums before, of the one before and of the one behind.
fn peelnet_part(own: f32, before: f32, previous: f32, next: f32, total: f32, number: f32, nearest: PeelnetNearest) -> f32 {
    let ahead = before + peelnet_inside(own);
    let scale = 1.0 / max(total, 1e-6);
    let known = PeelnetAhead(
        ahead,
        total,
        before * scale,
        own * scale,
        previous * scale,
        next * scale,
        nearest.alpha,
        nearest.place,
        number,
    );
    return exp(-2.0 * ahead * peelnet_network(known));
}

// What is seen of three sums by the formula. before: absorbance of the sums before them.
fn peelnet_seen_of(b: vec3f, before: f32) -> vec3f {
    let ahead = vec3f(before + peelnet_inside(b.x), before + b.x + peelnet_inside(b.y), before + b.x + b.y + peelnet_inside(b.z));
    return b * exp(-ahead);
}

// What three sums that are even between two places hold in front of four depths.
fn peelnet_until(depths: vec4f, seen: vec3f, begins: vec3f, ends: vec3f, quantiles: vec4f) -> vec4f {
    let scale = 1.0 / (ends - begins);
    return vec4f(
        dot(seen, clamp((vec3f(peelnet_place_among(depths.x, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.y, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.z, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.w, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
    );
}

// The same by sixteen bins of depth; as of peelnet_tile_seen.
fn peelnet_spread(seen: vec3f, begins: vec3f, ends: vec3f, quantiles: vec4f) -> mat4x4f {
    let depths = vec4f(0.0625, 0.125, 0.1875, 0.25);
    let a = peelnet_until(depths, seen, begins, ends, quantiles);
    let b = peelnet_until(depths + 0.25, seen, begins, ends, quantiles);
    let c = peelnet_until(depths + 0.5, seen, begins, ends, quantiles);
    let d = peelnet_until(depths + 0.75, seen, begins, ends, quantiles);
    return mat4x4f(a - vec4f(0.0, a.xyz), b - vec4f(a.w, b.xyz), c - vec4f(b.w, c.xyz), d - vec4f(c.w, d.xyz));
}

// The pixel's colour over black, and its coverage. seen: of all sums what is seen of red, green, blue and absorbance.
fn peelnet_over_black(nearest: PeelnetNearest, seen: vec4f) -> vec4f {
    let rest = select(nearest.color, seen.rgb / max(seen.a, 1.17549435e-38), seen.a > 0.0);
    return vec4f(nearest.alpha * nearest.color + nearest.left * rest, nearest.coverage);
}

struct PeelnetStatistics {
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    absorbances: vec4f,
}

// How a fragment at a place among the quantiles is shared between the sums.
fn peelnet_shares(place: f32) -> vec3f {
    let off = (vec3f(place) - vec3f(0.224, 0.485, 1.028)) * (1.0 / vec3f(0.158, 0.168, 0.191));
    let bumps = exp(-0.5 * off * off);
    return bumps * (1.0 / (bumps.x + bumps.y + bumps.z));
}

// What a fragment writes.
fn peelnet_statistics(alpha: f32, rgb: vec3f, zeta: f32, quantiles: vec4f, noise: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let depth = 0.5 * zeta + 0.5;
    let place = peelnet_place_among(depth, quantiles);
    let record = peelnet_record(b, rgb, depth, place, noise);
    let shares = b * peelnet_shares(place);
    return PeelnetStatistics(
        vec4f(rgb * shares.x, record.x),
        vec4f(rgb * shares.y, record.y),
        vec4f(rgb * shares.z, record.z),
        vec4f(shares, record.w),
    );
}

// A finished pixel: its nearest fragment, and its sums without it.
struct PeelnetRest {
    nearest: PeelnetNearest,
    first: vec4f,
    second: vec4f,
    third: vec4f,
}

fn peelnet_rest(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> PeelnetRest {
    let b = min(absorbances.xyz, vec3f(65504.0));
    let all = vec4f(sum_a.rgb + sum_b.rgb + sum_c.rgb, b.x + b.y + b.z);
    let nearest = peelnet_nearest(vec4f(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all, quantiles, noise);
    let shares = peelnet_shares(nearest.place);
    return PeelnetRest(
        nearest,
        peelnet_behind(sum_a.rgb, b.x, shares.x, nearest),
        peelnet_behind(sum_b.rgb, b.y, shares.y, nearest),
        peelnet_behind(sum_c.rgb, b.z, shares.z, nearest),
    );
}

// The colour of a pixel over black, and its coverage.
fn peelnet_pixel(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> vec4f {
    let r = peelnet_rest(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    let two = r.first.w + r.second.w;
    let total = two + r.third.w;
    let seen = r.first * peelnet_part(r.first.w, 0.0, 0.0, r.second.w, total, 0.0, r.nearest)
        + r.second * peelnet_part(r.second.w, r.first.w, r.first.w, r.third.w, total, 0.5, r.nearest)
        + r.third * peelnet_part(r.third.w, two, r.second.w, 0.0, total, 1.0, r.nearest);
    return peelnet_over_black(r.nearest, seen);
}

// What is seen behind the nearest fragment of a finished pixel, by sixteen bins of depth, for the quantiles of the next frame: by the formula,
// each sum taken as even between two places.
fn peelnet_last_seen(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> mat4x4f {
    let r = peelnet_rest(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    let b = vec3f(r.first.w, r.second.w, r.third.w);
    let seen = peelnet_seen_of(b, 0.0);
    let scale = r.nearest.left / max(dot(seen, vec3f(1.0)), 1.17549435e-38);
    let begins = vec3f(0.0, 0.345, 0.738);
    return peelnet_spread(seen * scale, begins, vec3f(0.345, 0.738, 1.0), quantiles);
}

// The colour and coverage of a pixel.
fn peelnet_resolve(
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    absorbances: vec4f,
    quantiles: vec4f,
    noise: f32,
    background: vec3f,
) -> vec4f {
    let pixel = peelnet_pixel(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    return vec4f(pixel.rgb + (1.0 - pixel.a) * background, pixel.a);
}

// The network's answer for what is known of a fragment.
fn peelnet_network(ahead: PeelnetAhead) -> f32 {
    return peelnet_share(
        sqrt(2.0 * ahead.absorbance), sqrt(ahead.total), ahead.before, ahead.own, ahead.previous, ahead.next, ahead.alpha, ahead.place, ahead.number);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_network evaluates them.
fn peelnet_share(root_absorbance: f32, root_total: f32, share_before: f32, share_own: f32, share_previous: f32, share_next: f32, nearest_alpha: f32, nearest_place: f32, number: f32) -> f32 {
    let input_a = vec4f(root_absorbance, root_total, share_before, share_own);
    let input_b = vec4f(share_previous, share_next, nearest_alpha, nearest_place);
    let input_c = vec4f(number, 0.0, 0.0, 0.0);
    let layer_a_a = max(vec4f(-0.3643585, -1.6444997, 2.879028, 3.969859)
        + mat4x4f(vec4f(-0.035856757, -0.06817013, -0.18471625, -0.73033863), vec4f(0.077753864, 0.097871795, 0.19670647, -0.3498375), vec4f(-1.0399143, -3.8017354, -0.4186011, -1.4764334), vec4f(0.34179458, 2.3682005, 0.757651, 0.8526551)) * input_a
        + mat4x4f(vec4f(-2.1066976, 6.9736977, -1.2470212, -1.7055901), vec4f(-2.6102562, 2.377847, 0.67324764, -0.75044966), vec4f(0.08623841, 0.060396902, -0.1687638, 0.9640445), vec4f(4.040672, 0.270934, -4.6773195, -2.5334377)) * input_b
        + vec4f(0.1935029, -0.73336715, -3.3349328, -1.212692) * input_c.x, vec4f(0.0));
    let layer_a_b = max(vec4f(0.21330349, -0.02656817, -0.16447073, 1.1548687)
        + mat4x4f(vec4f(0.02052927, -0.92279875, -0.089854464, -0.646571), vec4f(0.0017290202, 0.022043811, 0.070165455, 0.2522591), vec4f(-7.6991463, 0.83759165, -8.330793, -10.267181), vec4f(0.248631, 0.7580159, 0.82532406, 2.7728171)) * input_a
        + mat4x4f(vec4f(7.0652976, -2.2109723, 9.127621, -3.1035454), vec4f(1.6437272, 0.1328044, 0.10455265, -0.36131564), vec4f(-0.13505335, 1.3599367, -0.112846546, 2.5116642), vec4f(-0.5268424, -1.7431964, 0.059136257, 2.7708263)) * input_b
        + vec4f(-0.097574115, 2.234713, -0.41646186, -3.6041784) * input_c.x, vec4f(0.0));
    let layer_a_c = max(vec4f(0.23459977, 1.5284905, -0.33104283, -0.90826887)
        + mat4x4f(vec4f(-1.4310397, 0.50795686, -1.1753677, 0.30261093), vec4f(0.24343121, -0.11405239, 0.2738383, 0.5665453), vec4f(0.67151386, -3.5867555, -0.616056, -1.4708247), vec4f(-3.8027723, -0.91791475, -2.1488001, -1.4649061)) * input_a
        + mat4x4f(vec4f(1.8115171, 2.7251132, 0.99894553, 3.4080665), vec4f(1.7032629, -0.6312258, 2.37076, -1.3196673), vec4f(1.8095148, 0.7401302, 0.91098684, -1.0051945), vec4f(2.2262223, -4.9366107, 3.2235591, 2.1454048)) * input_b
        + vec4f(-2.0792654, -1.3673354, -0.037428267, 0.11669109) * input_c.x, vec4f(0.0));
    let layer_b_a = 1.0 / (1.0 + exp(min(-(-0.050200883
        + dot(vec4f(-0.33934435, 2.134865, -1.0937227, -0.56847894), layer_a_a)
        + dot(vec4f(0.91362965, 0.58325267, 4.8532796, 2.4492927), layer_a_b)
        + dot(vec4f(-2.5263038, 0.6588748, -0.92443925, 0.5552326), layer_a_c)), 80.0)));
    return layer_b_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, root_total: f32, share_before: f32, share_own: f32, share_previous: f32, share_next: f32, nearest_alpha: f32, nearest_place: f32, number: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    let share = peelnet_share(
        clamp(root_absorbance, -13561.853, 13564.8545), clamp(root_total, -30128.404, 30134.768), clamp(share_before, -2667.907, 2668.264), clamp(share_own, -3112.036, 3112.7146), clamp(share_previous, -2008.2643, 2008.5392), clamp(share_next, -3296.4385, 3297.0293), clamp(nearest_alpha, -3215.6423, 3216.4802), clamp(nearest_place, -1974.1545, 1974.4336), clamp(number, -4064.0708, 4065.088));
    return exp(-root * root * share);
}
