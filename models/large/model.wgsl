// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 15.056216 in training.
// Input 1: depth_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 5: root_own (root of the fragment's absorbance), 0.031630483 .. 2.5770967 in training.
// Input 6: half_extent (half of the depth between the slab's ends, in slabs), 0.00052083336 .. 1.0 in training.
// Input 7: of_own (absorbance between the ends, of that and the fragment's), 0.0 .. 0.9999869 in training.
// Input 8: of_nearest (absorbance between the ends, of that and the nearer end's), 0.0 .. 1.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000181, validation 0.000203, test 0.000176.
// Held-out error, mean |T - T_exact|: boxes-held 0.00561, cups-held 0.00460, foliage-held 0.00128, panes-held 0.00048, sixteen-held 0.00060, smoke-held 0.00902.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0, 0.031630483, 0.00052083336, 0.0, 0.0) = 1.0
// Self-test: peelnet_weight(7.528108, 0.5, 0.5, 0.5, 0.5, 1.3043636, 0.5002604, 0.49999344, 0.5) = 4.9401726e-13
// Self-test: peelnet_weight(15.056216, 1.0, 1.0, 1.0, 1.0, 2.5770967, 1.0, 0.9999869, 1.0) = 0.0
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "range": draw all transparent surfaces, in any order. let r = peelnet_pixel_range(zeta);
//    range: rg8unorm, cleared to 0, blending MAX, from r
// 2. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta, range);
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    farthest: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.farthest
//    firsts: rg16float, cleared to 0, blending ADD, from s.firsts
// 3. Pass "weights": draw all transparent surfaces, in any order. let f = peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest, firsts); let w = f.x; let known = f.y > 0.0;
//    sums: rgba16float, cleared to 0, blending ADD, from select(vec4f(alpha * rgb, alpha) * w, vec4f(0.0), known)
//    ends: rgba16float, cleared to 0, blending ADD, from select(vec4f(0.0), vec4f(alpha * rgb, alpha) * w, known)
// 4. Resolve: peelnet_resolve(sums, ends, dot(absorbances, vec4f(1.0)), background) is the colour of the pixel, and its coverage in alpha.
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
    // 0, the nearest, to 3.
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
    // Mean depth of the absorbance; a half where the slab does not keep it.
    mean: f32,
    // The least and the most of the absorbance that can lie in front of the fragment, as shares.
    low: f32,
    high: f32,
    // Half of what the two ends are apart, in slabs.
    extent: f32,
    // Absorbance of the fragment.
    own: f32,
    // Absorbance of the nearer end; 0 where it does not lie in front.
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
    // Borders at 0.2, 0.5 and 0.8.
    let far_half = t >= 0.5;
    let second = select(t >= 0.2, t >= 0.8, far_half);
    let slab = select(0.0, 2.0, far_half) + select(0.0, 1.0, second);
    let begin = select(select(0.0, 0.2, second), select(0.5, 0.8, second), far_half);
    let end = select(select(0.2, 0.5, second), select(0.8, 1.0, second), far_half);
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

// The absorbance that a level stands for.
fn peelnet_absorbance_of(level: f32) -> f32 {
    let share = (level - floor(level / PEELNET_OPACITIES) * PEELNET_OPACITIES) / (PEELNET_OPACITIES - 1.0);
    return share / (1.0625 - share);
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

// total and first: the slab's sums. levels: its nearest and its farthest fragment, -1 where it keeps none. keeps_mean: whether first is kept.
fn peelnet_between(place: PeelnetPlace, total: f32, first: f32, levels: vec2f, keeps_mean: bool) -> PeelnetBetween {
    let b = place.absorbance;
    let others = max(total - b, 0.0);
    // Where the rest is no more than the rounding of 16-bit sums, its mean is noise.
    let noise = max(total * 0.0009765625, 1e-6);
    let near_back = floor(levels.x / PEELNET_OPACITIES);
    let near_bin = PEELNET_BINS - 1.0 - near_back;
    let near_level = levels.x + (near_bin - near_back) * PEELNET_OPACITIES;
    let known = peelnet_absorbance_of(levels.x);
    // All others, as far as the level's rounding and the sum's can tell.
    let step = 0.6 / (PEELNET_OPACITIES - 1.0);
    let all = known > others - (step * (1.0 + known) * (1.0 + known) + noise);
    let near = select(select(known, others, all), 0.0, near_bin > place.bin);
    let far_bin = floor(levels.y / PEELNET_OPACITIES);
    let is_one = levels.y == near_level || levels.y < 0.0;
    let far = select(peelnet_absorbance_of(levels.y), 0.0, is_one || far_bin < place.bin);
    var begin = peelnet_middle_of(near_bin);
    var end = select(peelnet_middle_of(far_bin), 1.0, is_one);
    let rest = total - b - near - far;
    let moment = first - b * place.inside - near * begin - far * end;
    begin = select(begin, -1.0, begin > place.inside);
    end = select(end, 1.0, end < place.inside);
    let extent = max(end - begin, 2.0 / PEELNET_BINS);
    let x = clamp((place.inside - begin) / extent, 0.0, 1.0);
    let depth = clamp(moment / max(rest, noise), begin, end);
    let mean = select(0.5, clamp((depth - begin) / extent, 0.0, 1.0), keeps_mean);
    // Markov's bounds of the share in front.
    let before = x < mean;
    let low = select((x - mean) / max(x, 1e-6), 0.0, before || !keeps_mean);
    let high = select(1.0, (1.0 - mean) / max(1.0 - x, 1e-6), before && keeps_mean);
    return PeelnetBetween(max(rest, 0.0), x, mean, low, high, 0.5 * extent, b, near);
}

// The weight of a fragment, and whether it is known without the network: 1 where it is its slab's nearest or farthest. absorbances, firsts,
// nearest, farthest: by slab. keeps: how many of the nearer slabs keep a mean depth and a farthest fragment.
fn peelnet_weigh(
    place: PeelnetPlace,
    counts: bool,
    absorbances: vec4f,
    firsts: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    keeps: vec2f,
) -> vec2f {
    // Sums of 16-bit targets may become infinite.
    let sums = min(absorbances, vec4f(65504.0));
    let total = peelnet_of_slab(sums, place.slab);
    let first = clamp(peelnet_of_slab(firsts, place.slab), -65504.0, 65504.0);
    let halves = vec2f(peelnet_of_slab(nearest, place.slab), peelnet_of_slab(farthest, place.slab));
    let decoded = peelnet_levels(vec3f(halves, halves.y)).xy;
    let levels = select(vec2f(decoded.x, -1.0), decoded, place.slab < keeps.y);
    let before = select(0.0, sums.x, place.slab > 0.0)
        + select(0.0, sums.y, place.slab > 1.0)
        + select(0.0, sums.z, place.slab > 2.0);
    let is_near = counts && place.near == levels.x;
    let is_far = counts && place.far == levels.y && !is_near;
    let known = is_near || is_far;
    // No branch around it: neighbouring fragments are rarely all known, and then it only costs.
    let between = peelnet_between(place, total, first, levels, place.slab < keeps.x);
    let share = between.low + (between.high - between.low) * peelnet_network(between);
    let at_end = select(0.0, max(total - place.absorbance, 0.0), is_far);
    let inside = select(between.nearest + between.absorbance * share, at_end, known);
    // The nearest fragment's weight is 1: their sum cannot vanish.
    return vec2f(exp(-(before + inside)), select(0.0, 1.0, known));
}

struct PeelnetStatistics {
    // Absorbance of each slab.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments.
    nearest: vec4f,
    // Levels of the farthest fragments of the three nearer slabs; absorbance times depth in the slab, of the third.
    farthest: vec4f,
    // Absorbance times depth in the slab, of the first two.
    firsts: vec2f,
}

// What a fragment adds to its pixel's statistics. range: of the pixel, as the pass before left it.
fn peelnet_statistics(alpha: f32, zeta: f32, range: vec2f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, range);
    let halves = peelnet_records(alpha, place);
    let farthest = peelnet_in_slab(halves.y, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    return PeelnetStatistics(
        peelnet_in_slab(place.absorbance, place.slab, 0.0),
        peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY),
        vec4f(farthest.xyz, firsts.z),
        firsts.xy,
    );
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(
    alpha: f32,
    zeta: f32,
    range: vec2f,
    absorbances: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    firsts: vec2f,
) -> vec2f {
    let place = peelnet_place(alpha, zeta, range);
    let last = vec4f(farthest.xyz, PEELNET_EMPTY);
    let means = vec4f(firsts, farthest.w, 0.0);
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, means, nearest, last, vec2f(3.0, 3.0));
}

// The colour and coverage of a pixel. sums, ends: alpha * rgb * w and alpha * w of the fragments between the pixel's ends and at
// them, finite. transmittance: of red, green and blue light; coverage: 1 less their mean. Where nothing is covered the background
// stays as it is.
fn peelnet_composite(sums: vec4f, ends: vec4f, coverage: f32, transmittance: vec3f, background: vec3f) -> vec4f {
    // The ends never take more than the coverage, and what lies between no more than it can fill, 16 times its sum. Both then fill
    // what is missing.
    let own = min(ends.a, coverage);
    let left = min(coverage - own, 16.0 * sums.a);
    let fill = coverage / max(own + left, 1.17549435e-38);
    let shares = fill * vec2f(own / max(ends.a, 1.17549435e-38), left / max(sums.a, 1.17549435e-38));
    return vec4f(ends.rgb * shares.x + sums.rgb * shares.y + background * transmittance, coverage);
}

// The same with 16-bit sums, which may become infinite. absorbance: the pixel's total, moments.x.
fn peelnet_resolve(sums: vec4f, ends: vec4f, absorbance: f32, background: vec3f) -> vec4f {
    let transmittance = exp(-absorbance);
    let most = vec4f(65504.0);
    return peelnet_composite(min(sums, most), min(ends, most), 1.0 - transmittance, vec3f(transmittance), background);
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
    let layer_a_a = max(vec4f(2.368875, 0.3913847, 5.415646, 1.9873959)
        + mat4x4f(vec4f(0.017826673, -0.0053044287, -0.15036094, -0.14193912), vec4f(-1.1625398, 0.08669376, -2.0270157, -2.9763188), vec4f(0.547583, -1.9552368, 2.0993612, -3.4800358), vec4f(-10.337134, -2.2244542, -8.845943, 2.904093)) * input_a
        + mat4x4f(vec4f(-0.4019977, -0.79810035, -4.3965087, 2.7923615), vec4f(0.03813074, 1.8160514, -0.017146224, 0.33617225), vec4f(0.16078469, 0.83931893, -0.1939912, -0.32587856), vec4f(-2.0893579, -1.3904935, 0.43216157, 0.36038062)) * input_b
        + vec4f(-0.30666736, -0.00015370557, 0.21397634, -0.1964543) * input_c.x, vec4f(0.0));
    let layer_a_b = max(vec4f(3.216821, 4.6470704, 1.4003404, 12.429225)
        + mat4x4f(vec4f(-0.12567464, -0.2405271, -0.09074601, 0.12623976), vec4f(-4.558416, 3.0400066, -4.8597503, -0.25810423), vec4f(0.5099648, -6.6139245, 0.20172262, -9.127631), vec4f(-6.3277974, 1.5409485, -0.34529635, 0.17802975)) * input_a
        + mat4x4f(vec4f(-3.3718984, -1.2237256, -0.189875, -6.168496), vec4f(0.030233469, 0.3369155, 0.04083388, -0.060819693), vec4f(0.7848685, -0.06040595, -0.28653228, -0.67080796), vec4f(2.1757562, -0.5308588, -0.39988232, -1.695564)) * input_b
        + vec4f(1.6821176, 0.14973816, -0.048501562, -0.15770353) * input_c.x, vec4f(0.0));
    let layer_a_c = max(vec4f(-1.3570657, 4.097497, -3.1296165, 11.222946)
        + mat4x4f(vec4f(-0.027243802, -0.15349945, 0.1897883, -0.12912524), vec4f(2.0289052, 2.827727, -0.92791486, -1.3222561), vec4f(-2.456995, -1.0325302, -5.1163487, -6.9060726), vec4f(-6.3569746, 0.5508331, -5.157092, -2.6430993)) * input_a
        + mat4x4f(vec4f(-3.0537522, -1.4546108, -0.5663827, -6.8303432), vec4f(0.18427883, 0.7136996, 0.90086013, -0.38728818), vec4f(-0.4166438, -0.6735062, -0.33255994, -0.6890928), vec4f(-0.3149763, -0.9991773, 0.18490332, 1.6945696)) * input_b
        + vec4f(5.0540524, -1.5379622, 5.8668327, -1.6567909) * input_c.x, vec4f(0.0));
    let layer_b_a = 1.0 / (1.0 + exp(min(-(-0.7338535
        + dot(vec4f(-2.307776, 0.62114954, -0.8359471, -0.6763625), layer_a_a)
        + dot(vec4f(0.7556141, 0.73002625, -4.5136495, 0.92134523), layer_a_b)
        + dot(vec4f(-1.1076574, 0.38000172, -0.8763953, -0.75769585), layer_a_c)), 80.0)));
    return layer_b_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, root_own: f32, half_extent: f32, of_own: f32, of_nearest: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    let share = peelnet_share(
        clamp(root_absorbance, -27918.258, 27925.832), clamp(depth_fraction, -2977.1558, 2978.1875), clamp(mean_fraction, -1281.7662, 1282.7777), clamp(share_low, -2033.9182, 2034.1716), clamp(share_high, -2115.3406, 2117.0774), clamp(root_own, -5845.956, 5847.581), clamp(half_extent, -1640.4662, 1642.1823), clamp(of_own, -1812.09, 1813.8597), clamp(of_nearest, -1805.0753, 1806.8461));
    let bounds = clamp(vec2f(share_low, share_high), vec2f(0.0), vec2f(1.0));
    return exp(-root * root * mix(bounds.x, bounds.y, share));
}
