// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 15.927986 in training.
// Input 1: depth_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 5: root_own (root of the fragment's absorbance), 0.031630483 .. 2.4929142 in training.
// Input 6: half_extent (half of the depth between the slab's ends, in slabs), 0.00052083336 .. 1.0 in training.
// Input 7: of_own (absorbance between the ends, of that and the fragment's), 0.0 .. 0.9999888 in training.
// Input 8: of_nearest (absorbance between the ends, of that and the nearer end's), 0.0 .. 1.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000155, validation 0.000167, test 0.000143.
// Held-out error, mean |T - T_exact|: boxes-held 0.00482, cups-held 0.00254, foliage-held 0.00078, panes-held 0.00016, sixteen-held 0.00063, smoke-held 0.00572.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(3.1536086, 0.34473258, 0.33871156, 0.35519254, 0.24246675, 1.3484817, 0.24470124, 0.5180234, 0.22806776) = 0.056587335
// peelnet_weight(1.9897641, 0.025055587, 0.3786413, 0.595821, 0.28249002, 0.7963256, 0.6240396, 0.40492046, 0.91731685) = 0.10302619
// peelnet_weight(2.0278628, 0.2162394, 0.7240006, 0.37958002, 0.26558614, 2.0352807, 0.5804378, 0.90978783, 0.04841405) = 0.21207522
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target range: 1.0, 1.0
//    target absorbances: 0.6931472, 0.6931472, 0.6931472, 2.302585
//    target nearest: 64928.0, -3.4101562, -3.4101562, -64768.0
//    target farthest: -65088.0, 3.4003906, 3.4003906, 65248.0
//    target firsts: -0.6931472, 0.3630771, 0.3630771, 2.302585
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "range": draw all transparent surfaces, in any order. let r = peelnet_pixel_range(zeta);
//    range: rg8unorm, cleared to 0, blending MAX, from r
// 2. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta, range);
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    farthest: rgba16float, cleared to -65504, blending MAX, from s.farthest
//    firsts: rgba16float, cleared to 0, blending ADD, from s.firsts
// 3. Pass "weights": draw all transparent surfaces, in any order. let w = peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest, firsts).x;
//    sums: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * w
// 4. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background) is the colour of the pixel, and its coverage in alpha.
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

// Fragments of less opacity are composited, but are never a slab's nearest or farthest.
const PEELNET_FAINT: f32 = 0.003921569;
// Levels of the range of depths, less one.
const PEELNET_RANGE_TOP: f32 = 255.0;
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

// What a fragment writes of the pixel's range, into 8 bits under MAX: its level of depth counted from the far end, rounded down, and
// from the near end, rounded up.
fn peelnet_pixel_range(zeta: f32) -> vec2f {
    let level = PEELNET_RANGE_TOP * (zeta * 0.5 + 0.5);
    return vec2f(PEELNET_RANGE_TOP - floor(level), ceil(level)) / PEELNET_RANGE_TOP;
}

fn peelnet_place(alpha: f32, zeta: f32, range: vec2f) -> PeelnetPlace {
    let ends = floor(range * PEELNET_RANGE_TOP + 0.5);
    let low = PEELNET_RANGE_TOP - ends.x;
    let t = clamp((PEELNET_RANGE_TOP * (zeta * 0.5 + 0.5) - low) / max(ends.y - low, 1.0), 0.0, 1.0);
    let b = peelnet_absorbance(alpha);
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

// Where a slab ends and the next begins, in the pixel's range, and the number of the last slab.
const PEELNET_FIRST_END: f32 = 0.12;
const PEELNET_SECOND_END: f32 = 0.4;
const PEELNET_THIRD_END: f32 = 0.75;
const PEELNET_LAST_SLAB: f32 = 3.0;

struct PeelnetStatistics {
    // Absorbance of each of four slabs.
    absorbances: vec4f,
    // Levels of the slabs' nearest and farthest fragments.
    nearest: vec4f,
    farthest: vec4f,
    // Absorbance times depth in the slab.
    firsts: vec4f,
}

// What a fragment adds to its pixel's statistics. range: of the pixel, as the pass before left it.
fn peelnet_statistics(alpha: f32, zeta: f32, range: vec2f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, range);
    let halves = peelnet_records(alpha, place);
    let absorbances = peelnet_in_slab(place.absorbance, place.slab, 0.0);
    let nearest = peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let farthest = peelnet_in_slab(halves.y, place.slab, PEELNET_EMPTY);
    return PeelnetStatistics(absorbances, nearest, farthest, firsts);
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(
    alpha: f32,
    zeta: f32,
    range: vec2f,
    absorbances: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    firsts: vec4f,
) -> vec2f {
    let place = peelnet_place(alpha, zeta, range);
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, firsts, nearest, farthest, 4.0);
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
        sqrt(between.absorbance), between.place, between.mean, between.low, between.high, sqrt(between.own), between.extent, between.absorbance / (between.absorbance + between.own + 1e-6), between.absorbance / (between.absorbance + between.nearest + 1e-6));
}

// Where between its bounds the share of the absorbance lies that is in front, for inputs as peelnet_network evaluates them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, root_own: f32, half_extent: f32, of_own: f32, of_nearest: f32) -> f32 {
    let input_a = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let input_b = vec4f(share_high, root_own, half_extent, of_own);
    let input_c = vec4f(of_nearest, 0.0, 0.0, 0.0);
    let layer_a_a = max(vec4f(2.1840205, -6.0488615, -1.7244382, 4.7277613)
        + mat4x4f(vec4f(0.047469564, 0.23515935, 0.11767298, 0.20192647), vec4f(-1.7600293, 2.394223, -0.758209, -2.1273522), vec4f(2.0526679, 1.8895667, 2.210894, -4.212481), vec4f(-2.42305, 3.114414, -2.4845653, -3.50623)) * input_a
        + mat4x4f(vec4f(-0.35380575, 4.11892, -0.80055463, -1.7894613), vec4f(-0.050723393, -0.18910663, 1.6134852, 0.04007925), vec4f(0.1851308, -0.37078544, -0.8427393, -0.83480763), vec4f(-4.397573, -1.7329992, 1.3239111, -2.6379797)) * input_b
        + vec4f(0.40196586, -0.227467, 0.2835534, 2.2054615) * input_c.x, vec4f(0.0));
    let layer_a_b = max(vec4f(1.9635522, 4.22529, 1.7789874, 3.2397063)
        + mat4x4f(vec4f(-0.123949684, 0.1417589, -0.018165613, 0.30577102), vec4f(-2.7712479, -0.37093836, -3.3144624, 0.4114121), vec4f(-1.2387592, 0.27240995, -2.6905491, -0.2897715), vec4f(-3.0422947, 2.8530369, 0.19921339, 1.8955889)) * input_a
        + mat4x4f(vec4f(-1.7535394, 1.0183004, -2.3712957, 0.010245026), vec4f(0.41370788, -1.842587, -0.02716257, -0.41089702), vec4f(-1.352047, 0.20369291, -0.00036163072, 0.227056), vec4f(-2.7401996, -0.29923275, -0.37736642, -6.4913673)) * input_b
        + vec4f(7.169313, -4.077658, 1.7808118, 0.07814195) * input_c.x, vec4f(0.0));
    let layer_a_c = max(vec4f(4.769506, -8.370628, -7.2272587, 1.9382521)
        + mat4x4f(vec4f(-0.13895983, 0.020408038, -0.14134641, 0.12772618), vec4f(-2.391556, 1.2834508, 0.13731219, -0.86161965), vec4f(1.3833116, -3.3067873, -3.9631188, 0.8292861), vec4f(-2.9982097, -1.9966851, -3.7511098, -3.622401)) * input_a
        + mat4x4f(vec4f(-1.2489822, 2.1839437, 1.1735235, -2.4171035), vec4f(-0.3166327, -0.66815275, -0.15579033, -1.1183752), vec4f(0.55134714, 0.6089045, -0.21319966, -0.09091094), vec4f(-0.33495626, -0.9323972, 4.1316953, -5.4128723)) * input_b
        + vec4f(-4.170837, 10.21349, 7.2209086, 6.0569587) * input_c.x, vec4f(0.0));
    let layer_b_a = 1.0 / (1.0 + exp(min(-(-0.64744765
        + dot(vec4f(-1.6729233, 1.0259085, -0.40086138, -0.48241943), layer_a_a)
        + dot(vec4f(0.46246502, 0.4526373, -3.5602195, 1.6483781), layer_a_b)
        + dot(vec4f(-1.0833257, 0.46139312, -0.53797805, -0.71952), layer_a_c)), 80.0)));
    return layer_b_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, root_own: f32, half_extent: f32, of_own: f32, of_nearest: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    let share = peelnet_share(
        clamp(root_absorbance, -29206.338, 29214.236), clamp(depth_fraction, -2897.979, 2898.976), clamp(mean_fraction, -1500.4199, 1501.4175), clamp(share_low, -2251.6072, 2251.9534), clamp(share_high, -2285.6619, 2287.3152), clamp(root_own, -5866.8115, 5868.4404), clamp(half_extent, -1597.7611, 1599.4877), clamp(of_own, -1822.701, 1824.4791), clamp(of_nearest, -1809.8052, 1811.5852));
    let bounds = clamp(vec2f(share_low, share_high), vec2f(0.0), vec2f(1.0));
    return exp(-root * root * mix(bounds.x, bounds.y, share));
}
