// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 9-14-9-1 (Relu hidden, Sigmoid last), 285 parameters, 261 multiply-adds. Recipe large, seed 1, 40 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of the rest's absorbance), 0.0 .. 21.597782 in training.
// Input 1: depth_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 3: share_low (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 4: share_high (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 5: interval_low (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 6: interval_high (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 7: depth_deviation (half standard deviations), -2.0 .. 2.0 in training.
// Input 8: skewness (half skewness), -2.0 .. 2.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000236, validation 0.000238, test 0.000233.
// Held-out error, mean |T - T_exact|: boxes-held 0.02562, cups-held 0.02099, foliage-held 0.00971, panes-held 0.00809, sixteen-held 0.01011, smoke-held 0.01491.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0, -2.0) = 1.0
// Self-test: peelnet_weight(10.798891, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.0, 0.0) = 1.0921475e-23
// Self-test: peelnet_weight(21.597782, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0) = 0.0
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in both passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta);
//    moments: rgba16float, cleared to 0, blending ADD, from s.moments
//    extent: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. let f = peelnet_fragment(alpha, zeta, moments, extent); let w = f.x; let end = f.y > 0.0;
//    sums: rgba16float, cleared to 0, blending ADD, from select(vec4f(alpha * rgb, alpha) * w, vec4f(0.0), end)
//    ends: rgba16float, cleared to 0, blending ADD, from select(vec4f(0.0), vec4f(alpha * rgb, alpha) * w, end)
// 3. Resolve: peelnet_resolve(sums, ends, moments.x, background) is the colour of the pixel, and its coverage in alpha.
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

// Fragments of less opacity are composited, but are never a pixel's nearest or farthest.
const PEELNET_FAINT: f32 = 0.003921569;
// Levels of depth, less one.
const PEELNET_TOP: f32 = 61439.0;
// Bins of depth, and levels of opacity in each, that the nearest and the farthest fragment are kept with.
const PEELNET_BINS: vec2f = vec2f(240.0, 1920.0);
const PEELNET_OPACITIES: vec2f = vec2f(256.0, 32.0);
const PEELNET_OPACITY_STEP: vec2f = 1.0 / (PEELNET_OPACITIES - 1.0);

// Limits of a rest's mean powers. In narrow pixels, the rounding of the ends and of the sums takes the higher powers beyond 1;
// bounds multiply up to seven of them, which 32 bits hold.
const PEELNET_MEANS_MAX: vec4f = vec4f(1.0, 65536.0, 65536.0, 65536.0);

struct PeelnetStatistics {
    // Absorbance b and b zeta, b zeta^2, b zeta^3.
    moments: vec4f,
    // Depth of the nearest fragment, its opacity by coarse depth, the farthest's; b zeta^4.
    extent: vec4f,
}

// A fragment's place among those of its pixel.
struct PeelnetPlace {
    // 1 for the nearest, 2 for the farthest, 0 between them.
    end: f32,
    // Absorbance in front as far as it is known: nothing, all others, or the nearest fragment.
    in_front: f32,
    // Absorbance of the fragment itself, of the nearest and of the farthest where they are known.
    taken: vec3f,
    // zeta of the same.
    zeta: vec3f,
}

// The rest of a pixel, seen from a fragment: all fragments but that one and the pixel's known ends. Depths are over the pixel's
// range, -1 at the nearest and 1 at the farthest fragment.
struct PeelnetRest {
    // Root of its absorbance.
    root_absorbance: f32,
    // Depth of the fragment.
    place: f32,
    // Mean powers 1 to 4 of the rest's depth.
    means: vec4f,
    // Pull of the moments towards those of a measure that can be inverted.
    bias: f32,
}

fn peelnet_level(zeta: f32) -> f32 {
    return floor((zeta * 0.5 + 0.5) * PEELNET_TOP + 0.5);
}

// A fragment's levels as its pixel's nearest and as its farthest: coarse depth, counted from the far end for the nearest,
// then opacity, even in b / (1 + b), up to b = 16.
fn peelnet_ends(b: f32, zeta: f32) -> vec2f {
    let bins = min(floor((zeta * 0.5 + 0.5) * PEELNET_BINS), PEELNET_BINS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (PEELNET_OPACITIES - 1.0)) + 0.5);
    return vec2f(PEELNET_BINS.x - 1.0 - bins.x, bins.y) * PEELNET_OPACITIES + opacity;
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

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let square = zeta * zeta;
    // The nearest is kept as the maximum of levels counted from the far end.
    let halves = peelnet_halves(vec3f(PEELNET_TOP - peelnet_level(zeta), peelnet_ends(b, zeta)));
    return PeelnetStatistics(
        b * vec4f(1.0, zeta, square, square * zeta),
        vec4f(select(halves, vec3f(-65504.0), alpha < PEELNET_FAINT), b * square * square),
    );
}

fn peelnet_place(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> PeelnetPlace {
    let b = peelnet_absorbance(alpha);
    let level = peelnet_level(zeta);
    let levels = peelnet_levels(extent.xyz);
    let first = PEELNET_TOP - levels.x;
    let ends = levels.yz;
    let own = peelnet_ends(b, zeta);
    // Two passes may round one zeta to neighbouring levels.
    let at_end = select(select(0.0, 2.0, own.y == ends.y), 1.0, level <= first + 1.0);
    let end = select(at_end, 0.0, alpha < PEELNET_FAINT);
    let bins = floor(ends / PEELNET_OPACITIES);
    let share = (ends - bins * PEELNET_OPACITIES) * PEELNET_OPACITY_STEP;
    let known = share / (1.0625 - share);
    // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a more
    // opaque one in the same bin), stays with the rest.
    let nearest = select(0.0, known.x, level > first && own.x != ends.x);
    let farthest = select(0.0, known.y, own.y < ends.y);
    let others = max(moments.x - b, 0.0);
    return PeelnetPlace(
        end,
        select(select(nearest, others, end == 2.0), 0.0, end == 1.0),
        vec3f(b, nearest, farthest),
        vec3f(zeta, first * (2.0 / PEELNET_TOP) - 1.0, (bins.y + 0.5) * (2.0 / PEELNET_BINS.y) - 1.0),
    );
}

fn peelnet_rest(place: PeelnetPlace, moments: vec4f, extent: vec4f) -> PeelnetRest {
    let z = place.zeta;
    let square = z * z;
    let left = moments - vec4f(
        place.taken.x + place.taken.y + place.taken.z,
        dot(place.taken, z),
        dot(place.taken, square),
        dot(place.taken, square * z),
    );
    let absorbance = max(left.x, 0.0);
    // Where the rest is no more than the rounding of 16-bit sums, its moments are noise.
    let inverse_total = 1.0 / max(max(absorbance, moments.x * 0.0009765625), 1e-6);
    let mean = vec4f(left.yzw, extent.w - dot(place.taken, square * square)) * inverse_total;
    // Moments over the pixel's range as -1 .. 1: of (zeta - middle) * scale.
    let middle = 0.5 * (z.y + z.z);
    let scale = 2.0 / max(z.z - z.y, 2.0 / PEELNET_TOP);
    let scale_square = scale * scale;
    let means = vec4f(
        (mean.x - middle) * scale,
        (mean.y - middle * (2.0 * mean.x - middle)) * scale_square,
        (mean.z - middle * (3.0 * mean.y - middle * (3.0 * mean.x - middle))) * scale * scale_square,
        (mean.w - middle * (4.0 * mean.z - middle * (6.0 * mean.y - middle * (4.0 * mean.x - middle)))) * scale_square * scale_square,
    );
    return PeelnetRest(
        sqrt(absorbance),
        clamp((z.x - middle) * scale, -1.0, 1.0),
        clamp(means, -PEELNET_MEANS_MAX, PEELNET_MEANS_MAX),
        // Moved to a narrow pixel's range, moments lose their last bits.
        min(0.0009765625 + scale_square * scale_square * 0.0000152587890625, 0.25),
    );
}

// The weight of a fragment, and its end (see PeelnetPlace). The network's answer is not used for the ends, whose weights are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    // Sums of 16-bit targets may become infinite.
    let finite_moments = clamp(moments, vec4f(-65504.0), vec4f(65504.0));
    let finite_extent = vec4f(extent.xyz, min(extent.w, 65504.0));
    let place = peelnet_place(alpha, zeta, finite_moments, finite_extent);
    let rest = peelnet_rest(place, finite_moments, finite_extent);
    let share = peelnet_network(rest);
    let between = select(rest.root_absorbance * rest.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
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

// The least and the most of the rest that can lie in front of the fragment, given its first four moments, as shares
// (Muenstermann et al. 2018).
fn peelnet_moment_bounds(rest: PeelnetRest) -> vec2f {
    let x = rest.place;
    let m = mix(rest.means, vec4f(0.0, 0.375, 0.0, 0.375), rest.bias);
    // The kernel polynomial from the factors L D of the Hankel matrix, times all denominators: only its roots matter, and
    // its value at x, which is one over what lies at x itself.
    let variance = m.y - m.x * m.x;
    let third = m.z - m.x * m.y;
    let d = variance * (m.w - m.y * m.y) - third * third;
    let linear = x - m.x;
    let quadratic = (x * x - m.y) * variance - third * linear;
    let determinant = variance * d;
    let kc = quadratic * variance;
    let kb = linear * d - third * quadratic;
    let ka = determinant - m.x * kb - m.y * kc;
    // Divisors are kept from 0, and shares of noise from infinity: no real pixel has such.
    let whole = determinant + linear * linear * d + quadratic * quadratic;
    let own = clamp(determinant / select(whole, 1e-20, abs(whole) < 1e-20), -1e4, 1e4);
    // Its roots are the extreme measure's other points: the smaller one, and one over the larger, which may be infinite.
    let half = 0.5 * kb;
    let root = sqrt(max(half * half - ka * kc, 0.0));
    let inverse = select(1.0, -1.0, half >= 0.0) / max(abs(half) + root, 1e-20);
    let p = ka * inverse;
    let q = kc * inverse;
    // What lies at either.
    let apart = 1.0 - p * q;
    let at_p = clamp((1.0 - own - q * (m.x - own * x)) / select(apart, 1e-20, apart == 0.0), -1e4, 1e4);
    let at_q = 1.0 - own - at_p;
    let low = select(0.0, at_p, p < x) + select(0.0, at_q, (1.0 - x * q) * q < 0.0);
    return clamp(vec2f(low, low + own), vec2f(0.0), vec2f(1.0));
}

// A divisor that is not 0.
fn peelnet_divisor(x: f32) -> f32 {
    return select(x, 1e-20, abs(x) < 1e-20);
}

// The same from three moments and that all of the rest lies between the ends. The extreme distribution has the points x, y and one
// of the ends (Krein & Nudelman 1977).
fn peelnet_interval_bounds(rest: PeelnetRest) -> vec2f {
    let x = rest.place;
    let m = rest.means.xyz;
    // Moments of (t + 1) dm, whose points are x and y alone if the end is -1.
    let low_end = vec3f(1.0, m.xy) + m;
    let y_low = (low_end.z - x * low_end.y) / peelnet_divisor(low_end.y - x * low_end.x);
    let at_low = y_low >= -1.0 && y_low <= 1.0;
    // Else those of (1 - t) dm.
    let n = select(vec3f(1.0, m.xy) - m, low_end, at_low);
    let y_any = select((n.z - x * n.y) / peelnet_divisor(n.y - x * n.x), y_low, at_low);
    let y = clamp(y_any, -1e10, 1e10);
    let at = (n.y - y * n.x) / peelnet_divisor((x - y) * select(1.0 - x, 1.0 + x, at_low));
    let other = (n.y - x * n.x) / peelnet_divisor((y - x) * select(1.0 - y, 1.0 + y, at_low));
    // What lies at either; only noise is as large as the limits.
    let here = clamp(at, -1e4, 1e4);
    let there = clamp(other, -1e4, 1e4);
    let low = select(0.0, 1.0 - here - there, at_low) + select(0.0, there, y < x);
    // Nothing lies in front of the near end.
    return select(clamp(vec2f(low, low + here), vec2f(0.0), vec2f(1.0)), vec2f(0.0), at_low && x <= -1.0);
}

// How many half standard deviations the fragment lies behind the rest's mean, and half the rest's skewness, each in -2 .. 2.
fn peelnet_shape(rest: PeelnetRest) -> vec2f {
    let m = rest.means.xyz;
    let sigma = sqrt(max(m.y - m.x * m.x, 0.0009765625));
    let wide = max(sigma, 0.25);
    let third = m.z - m.x * (3.0 * m.y - 2.0 * m.x * m.x);
    return clamp(0.5 * vec2f((rest.place - m.x) / sigma, third / (wide * wide * wide)), vec2f(-2.0), vec2f(2.0));
}

// The network's answer for what is known of a fragment.
fn peelnet_network(rest: PeelnetRest) -> f32 {
    let bounds = peelnet_moment_bounds(rest);
    let interval = peelnet_interval_bounds(rest);
    let shape = peelnet_shape(rest);
    return peelnet_share(
        rest.root_absorbance, 0.5 * rest.place + 0.5, 0.5 * rest.means.x + 0.5, bounds.x, bounds.y, interval.x, interval.y, shape.x, shape.y);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_network evaluates them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let input_a = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let input_b = vec4f(share_high, interval_low, interval_high, depth_deviation);
    let input_c = vec4f(skewness, 0.0, 0.0, 0.0);
    let layer_a_a = max(vec4f(4.3308644, -1.6833632, -3.1557803, 4.3189783)
        + mat4x4f(vec4f(-0.11711614, 0.018201519, -0.1922688, 0.060749203), vec4f(-4.3223453, -1.3716725, -3.9893048, 3.024921), vec4f(1.0720955, 1.2786622, -1.9662219, -4.4067755), vec4f(-2.7588768, -2.4277065, 0.013504979, -5.024374)) * input_a
        + mat4x4f(vec4f(-1.9274054, 7.9188237, 5.222642, -1.5211284), vec4f(-2.3792248, 0.26208624, 4.7369347, -0.46379253), vec4f(-0.39314377, -4.906606, 0.9943474, -2.6406598), vec4f(0.7369975, -2.5658925, -0.1094023, -1.0814508)) * input_b
        + vec4f(1.4130023, 3.3614159, -3.008435, -2.0272186) * input_c.x, vec4f(0.0));
    let layer_a_b = max(vec4f(0.8550898, -1.7056745, 0.7930022, -2.7533066)
        + mat4x4f(vec4f(-0.07972438, 0.0028622346, -0.037511896, 0.042239096), vec4f(-4.4707084, -1.9324596, -1.1019256, 2.9914062), vec4f(4.219092, 0.9163617, -0.8574236, -2.4514098), vec4f(-3.7207837, 5.757652, 6.8536654, 2.2912881)) * input_a
        + mat4x4f(vec4f(5.7692513, -0.5378646, 2.370643, -9.675836), vec4f(-4.8538895, 0.48923272, -1.3942823, 4.0010405), vec4f(-4.236152, 2.469183, -1.6748537, 6.820608), vec4f(5.6736045, 2.173252, -1.5808729, 1.7461525)) * input_b
        + vec4f(3.7862136, 1.5022653, -0.6976139, -1.0790986) * input_c.x, vec4f(0.0));
    let layer_a_c = max(vec4f(1.9359068, -2.0212853, -0.86770326, 0.57351077)
        + mat4x4f(vec4f(-0.07412519, -0.028900098, 0.10776584, 0.08063029), vec4f(2.4128356, 0.7698694, -7.787507, 3.0813413), vec4f(0.35032332, 1.458675, -1.2330241, 1.0027504), vec4f(-2.187464, 3.0898185, -2.2864838, -8.38881)) * input_a
        + mat4x4f(vec4f(-1.9167998, -6.5372424, 2.9380429, -1.5133961), vec4f(3.8259137, 1.2636793, 2.9862564, -2.6649554), vec4f(-6.1575975, 3.5646439, 0.4580644, 0.2486649), vec4f(-2.3731084, -1.4561476, -1.9470991, 0.48015106)) * input_b
        + vec4f(3.4582806, -1.0346675, -0.8773826, 1.0256337) * input_c.x, vec4f(0.0));
    let layer_a_d = max(vec4f(3.211254, -4.604916, 0.0, 0.0)
        + mat4x4f(vec4f(-0.23591004, -0.25975057, 0.0, 0.0), vec4f(4.196753, -1.8586026, 0.0, 0.0), vec4f(-3.689701, 8.323261, 0.0, 0.0), vec4f(1.8567836, -1.5486579, 0.0, 0.0)) * input_a
        + mat4x4f(vec4f(-5.7390246, 3.6475084, 0.0, 0.0), vec4f(-1.0588821, 2.7352781, 0.0, 0.0), vec4f(3.0362093, -1.0782441, 0.0, 0.0), vec4f(0.50080824, 3.7194748, 0.0, 0.0)) * input_b
        + vec4f(0.29133424, 0.43799403, 0.0, 0.0) * input_c.x, vec4f(0.0));
    let layer_b_a = max(vec4f(-0.5432141, -0.37292498, -0.7341111, -0.6606592)
        + mat4x4f(vec4f(-2.4887557, -0.24578181, 0.0060588736, 0.5133156), vec4f(-0.44641495, 0.13778849, -0.63322884, 0.9335002), vec4f(-0.24175736, -0.15327972, -0.012277413, 0.60473555), vec4f(-0.06353815, -0.89636004, 0.9782207, 0.2592153)) * layer_a_a
        + mat4x4f(vec4f(0.26280612, -0.29504287, 0.5117013, 1.4341999), vec4f(-0.60064673, -0.26054084, -0.56448936, 0.34092534), vec4f(0.5370355, -0.16433185, 0.4156926, 1.426298), vec4f(-4.669635, -0.006122276, -0.318493, 1.4520576)) * layer_a_b
        + mat4x4f(vec4f(-0.56916535, -0.22427155, 1.6794007, 1.2681578), vec4f(-1.4887751, -0.4654513, 0.17728911, -1.6865668), vec4f(-0.84744114, 0.20994899, 0.60475713, -0.12779677), vec4f(0.2740172, -0.54466134, 0.41920167, -1.0552158)) * layer_a_c
        + mat4x4f(vec4f(-1.6586704, -0.000004736694, 0.5223939, -0.75837755), vec4f(1.3829165, -0.25773326, -0.23219444, 0.7392465), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_b_b = max(vec4f(1.3738554, -1.3751994, -1.96244, -0.22195892)
        + mat4x4f(vec4f(-0.041877035, 0.6977445, 0.774302, 1.2749637), vec4f(1.5413674, -0.009654446, -1.245947, -1.4561716), vec4f(0.39651585, -1.8081766, -3.4743721, -0.7825831), vec4f(0.099269256, 0.40721878, -0.98811066, -0.29790005)) * layer_a_a
        + mat4x4f(vec4f(-0.02191844, 0.15519908, 0.49730512, 1.0414652), vec4f(-0.14388555, -1.876922, -0.26759923, 0.96599245), vec4f(0.73091745, -0.56710684, 0.5613216, -0.7876249), vec4f(0.25749448, -0.22531123, 0.18341686, -2.7928138)) * layer_a_b
        + mat4x4f(vec4f(-0.77640814, 1.0998645, 0.6067298, -0.37485227), vec4f(-1.0806533, -0.02064465, -0.5974477, 1.0297074), vec4f(-1.6806389, 1.0569298, 2.1996567, -0.18929425), vec4f(-0.49452892, 0.6735635, -0.93782634, 0.83389664)) * layer_a_c
        + mat4x4f(vec4f(-1.2631539, 0.009653336, 0.4455795, -0.3188672), vec4f(-0.61205333, 0.34162557, 0.46336988, -2.1376162), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_b_c = max(vec4f(-2.6119995, 0.0, 0.0, 0.0)
        + mat4x4f(vec4f(-0.80537635, 0.0, 0.0, 0.0), vec4f(-1.3588438, 0.0, 0.0, 0.0), vec4f(-0.34580287, 0.0, 0.0, 0.0), vec4f(-0.8654169, 0.0, 0.0, 0.0)) * layer_a_a
        + mat4x4f(vec4f(1.9636958, 0.0, 0.0, 0.0), vec4f(-0.48713356, 0.0, 0.0, 0.0), vec4f(-1.9462328, 0.0, 0.0, 0.0), vec4f(-0.56972045, 0.0, 0.0, 0.0)) * layer_a_b
        + mat4x4f(vec4f(-0.4725951, 0.0, 0.0, 0.0), vec4f(-1.3546726, 0.0, 0.0, 0.0), vec4f(1.1253608, 0.0, 0.0, 0.0), vec4f(0.5803056, 0.0, 0.0, 0.0)) * layer_a_c
        + mat4x4f(vec4f(-0.3586857, 0.0, 0.0, 0.0), vec4f(0.35434166, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_c_a = 1.0 / (1.0 + exp(min(-(-0.14128774
        + dot(vec4f(-0.20305206, 0.014548472, -0.32684308, 0.29747736), layer_b_a)
        + dot(vec4f(-0.37622216, -0.2631049, -0.45302933, -0.41222826), layer_b_b)
        + 0.89961046 * layer_b_c.x), 80.0)));
    return layer_c_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46989.67, 47003.33), clamp(depth_fraction, -2907.894, 2908.9092), clamp(mean_fraction, -1210.7003, 1211.7108), clamp(share_low, -2969.1758, 2969.7964), clamp(share_high, -2983.7766, 2985.1663), clamp(interval_low, -2851.6882, 2852.2605), clamp(interval_high, -2478.805, 2480.3), clamp(depth_deviation, -6265.006, 6265.0127), clamp(skewness, -3698.2036, 3698.1914)));
}
