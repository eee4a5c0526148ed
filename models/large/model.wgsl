// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 9-14-9-1 (Relu hidden, Sigmoid last), 285 parameters, 261 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance in root of the rest's absorbance, valid range 0.0 .. 22.26442 (what training saw).
// Input 1: depth_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 2: mean_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 3: share_low in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 4: share_high in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 5: interval_low in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 6: interval_high in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 7: depth_deviation in half standard deviations, valid range -2.0 .. 2.0 (what training saw).
// Input 8: skewness in half skewness, valid range -2.0 .. 2.0 (what training saw).
// Trained on 20038556 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset 0599362acca622793292093ff63ae72863fd302015bdf7c35303dc4c52e527db+f44d32a5ff14ca4bf843253253d7571da2829a9e36c000d5dd700fd1b1454788).
// Loss: training 0.000183, validation 0.000187, test 0.000193.
// Held-out error, mean |T - T_exact|: boxes-held 0.01465, cups-held 0.02045, foliage-held 0.00833, panes-held 0.00710, sixteen-held 0.01584, smoke-held 0.02332.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0, -2.0) = 1.0
// Self-test: peelnet_weight(11.13221, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.0, 0.0) = 1.3274311e-29
// Self-test: peelnet_weight(22.26442, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0) = 0.0

// Statistics pass: draw all transparent surfaces, in any order, into
//     moments  rgba16float (or rgba32float), cleared to 0, blending ONE, ONE, ADD;
//     extent   rgba16float (or rgba32float), cleared to (-65504, -65504, -65504, 0), blending ONE, ONE, MAX for colour and
//              ONE, ONE, ADD for alpha;
// each fragment writing what peelnet_statistics(alpha, zeta) returns.
// zeta is depth on a logarithmic scale: with z the distance along the view axis, and near and far the range that the
// bounding boxes of the transparent objects in view span (clipped to the camera's),
//     zeta = clamp(2 * (log(z) - log(near)) / (log(far) - log(near)) - 1, -1, 1).
// Compute it with one function in both passes: the nearest and the farthest fragment are recognised by their zeta.

// Fragments of less opacity are composited, but are never a pixel's nearest or farthest.
const PEELNET_FAINT: f32 = 0.003921569;
// Levels of depth, less one.
const PEELNET_TOP: f32 = 61439.0;
// Bins of depth, and levels of opacity in each, that the nearest and the farthest fragment are kept with.
const PEELNET_BINS: vec2f = vec2f(240.0, 1920.0);
const PEELNET_OPACITIES: vec2f = vec2f(256.0, 32.0);
const PEELNET_OPACITY_STEP: vec2f = 1.0 / (PEELNET_OPACITIES - 1.0);

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

// What peelnet_share and peelnet_weight read.
struct PeelnetFeatures {
    root_absorbance: f32,
    depth_fraction: f32,
    mean_fraction: f32,
    share_low: f32,
    share_high: f32,
    // Mean powers 1 to 3 of the rest's depth, -1 .. 1 from the nearest to the farthest.
    means: vec3f,
}

// -log(1 - alpha), at most 16: opaque, but finite.
fn peelnet_absorbance(alpha: f32) -> f32 {
    return -log(max(1.0 - alpha, 1.1253517e-7));
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
// tells 61440 levels apart. A step of a half's bits is 8192 in those of 32 bits; no step here rounds.
fn peelnet_halves(levels: vec3f) -> vec3f {
    let from_middle = levels - 30719.5;
    let magnitude = bitcast<vec3f>(vec3i(abs(from_middle) * 8192.0 + 947908608.0));
    return select(-magnitude, magnitude, from_middle > vec3f(0.0));
}

fn peelnet_levels(halves: vec3f) -> vec3f {
    let from_middle = vec3f(bitcast<vec3i>(abs(halves))) * 0.0001220703125 - 115711.5;
    return 30719.5 + select(-from_middle, from_middle, halves > vec3f(0.0));
}

fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let z2 = zeta * zeta;
    // The nearest is kept as the maximum of levels counted from the far end.
    let halves = peelnet_halves(vec3f(PEELNET_TOP - peelnet_level(zeta), peelnet_ends(b, zeta)));
    return PeelnetStatistics(
        b * vec4f(1.0, zeta, z2, z2 * zeta),
        vec4f(select(halves, vec3f(-65504.0), alpha < PEELNET_FAINT), b * z2 * z2),
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
    // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a more
    // opaque one in the same bin), stays with the rest.
    let taken = vec2<bool>(level > first && own.x != ends.x, own.y < ends.y);
    let absorbances = select(vec2f(0.0), share / (1.0625 - share), taken);
    let others = max(moments.x - b, 0.0);
    return PeelnetPlace(
        end,
        select(select(absorbances.x, others, end == 2.0), 0.0, end == 1.0),
        vec3f(b, absorbances),
        vec3f(zeta, first * (2.0 / PEELNET_TOP) - 1.0, (bins.y + 0.5) * (2.0 / PEELNET_BINS.y) - 1.0),
    );
}

// The least and the most of a distribution that can lie in front of x, given its first four moments, as shares
// (Muenstermann et al. 2018). All are over -1 .. 1. `bias` pulls the moments towards those of a measure that can always
// be inverted.
fn peelnet_moment_bounds(moments: vec4f, x: f32, bias: f32) -> vec2f {
    let m = mix(moments, vec4f(0.0, 0.375, 0.0, 0.375), bias);
    // The kernel polynomial from the factors L D of the Hankel matrix, times all denominators: only its roots matter, and
    // its value at x, which is one over what lies at x itself.
    let variance = m.y - m.x * m.x;
    let l21 = m.z - m.x * m.y;
    let d = variance * (m.w - m.y * m.y) - l21 * l21;
    let y1 = x - m.x;
    let y2 = (x * x - m.y) * variance - l21 * y1;
    let determinant = variance * d;
    let c2 = y2 * variance;
    let c1 = y1 * d - l21 * y2;
    let c0 = determinant - m.x * c1 - m.y * c2;
    let own = determinant / (determinant + y1 * y1 * d + y2 * y2);
    // Its roots are the extreme measure's other points: the smaller one, and one over the larger, which may be infinite.
    let half = 0.5 * c1;
    let root = sqrt(max(half * half - c0 * c2, 0.0));
    let inverse = -1.0 / (half + select(-root, root, half >= 0.0));
    let p = c0 * inverse;
    let q = c2 * inverse;
    // What lies at either.
    let at_p = (1.0 - own - q * (m.x - own * x)) / (1.0 - p * q);
    let at_q = 1.0 - own - at_p;
    let low = select(0.0, at_p, p < x) + select(0.0, at_q, (1.0 - x * q) * q < 0.0);
    let share = vec2f(low, low + own);
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}

// Features of a fragment between its pixel's ends: what is left without its own share and the known ends.
fn peelnet_features(place: PeelnetPlace, moments: vec4f, extent: vec4f) -> PeelnetFeatures {
    let z = place.zeta;
    let z2 = z * z;
    let m = moments - vec4f(
        place.taken.x + place.taken.y + place.taken.z,
        dot(place.taken, z),
        dot(place.taken, z2),
        dot(place.taken, z2 * z),
    );
    let m0 = max(m.x, 0.0);
    // Where the rest is no more than the rounding of 16-bit sums, its moments are noise.
    let inverse_total = 1.0 / max(max(m0, moments.x * 0.0009765625), 1e-6);
    let mean = vec4f(m.yzw, extent.w - dot(place.taken, z2 * z2)) * inverse_total;
    // Moments over the pixel's range as -1 .. 1: of (zeta - middle) * scale.
    let middle = 0.5 * (z.y + z.z);
    let scale = 2.0 / max(z.z - z.y, 2.0 / PEELNET_TOP);
    let s2 = scale * scale;
    let m1 = clamp((mean.x - middle) * scale, -1.0, 1.0);
    let m2 = (mean.y - middle * (2.0 * mean.x - middle)) * s2;
    let m3 = (mean.z - middle * (3.0 * mean.y - middle * (3.0 * mean.x - middle))) * scale * s2;
    let m4 = (mean.w - middle * (4.0 * mean.z - middle * (6.0 * mean.y - middle * (4.0 * mean.x - middle)))) * s2 * s2;
    let x = clamp((z.x - middle) * scale, -1.0, 1.0);
    // Moved to a narrow pixel's range, moments lose their last bits.
    let bias = min(0.0009765625 + s2 * s2 * 0.0000152587890625, 0.25);
    let bounds = peelnet_moment_bounds(vec4f(m1, m2, m3, m4), x, bias);
    return PeelnetFeatures(
        sqrt(m0),
        0.5 * x + 0.5,
        0.5 * m1 + 0.5,
        bounds.x,
        bounds.y,
        vec3f(m1, m2, m3),
    );
}

// The least and the most of a distribution on -1 .. 1 that can lie in front of x, given its first three moments, as shares.
// The extreme distribution has the points x, y and one of the ends (Krein & Nudelman 1977).
fn peelnet_interval_bounds(m: vec3f, x: f32) -> vec2f {
    // Moments of (t + 1) dm, whose points are x and y alone if the end is -1.
    let low_end = vec3f(1.0, m.xy) + m;
    let y0 = (low_end.z - x * low_end.y) / (low_end.y - x * low_end.x);
    let at_low = y0 >= -1.0 && y0 <= 1.0;
    // Else those of (1 - t) dm.
    let n = select(vec3f(1.0, m.xy) - m, low_end, at_low);
    let y = select((n.z - x * n.y) / (n.y - x * n.x), y0, at_low);
    let at = (n.y - y * n.x) / ((x - y) * select(1.0 - x, 1.0 + x, at_low));
    let other = (n.y - x * n.x) / ((y - x) * select(1.0 - y, 1.0 + y, at_low));
    let low = select(0.0, 1.0 - at - other, at_low) + select(0.0, other, y < x);
    let share = vec2f(low, low + at);
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}

// How many half standard deviations x lies behind the mean, and half the skewness, each in -2 .. 2.
fn peelnet_shape(m: vec3f, x: f32) -> vec2f {
    let sigma = sqrt(max(m.y - m.x * m.x, 0.0009765625));
    let wide = max(sigma, 0.25);
    let third = m.z - m.x * (3.0 * m.y - 2.0 * m.x * m.x);
    return clamp(0.5 * vec2f((x - m.x) / sigma, third / (wide * wide * wide)), vec2f(-2.0), vec2f(2.0));
}

// Weight pass: draw all transparent surfaces again into two rgba16float targets cleared to 0, blending ONE, ONE, ADD.
// Each fragment reads its pixel's statistics, calls w = peelnet_fragment(..), and writes (alpha * rgb * w.x, alpha * w.x)
// to the first target, `sums`, if w.y is 0 (it lies between the pixel's ends), else to the second, `ends`; zero to the
// other one. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     k = (1 - T) / ends.a, at most 1 unless sums.a is 0
//     ends.rgb * k + sums.rgb / sums.a * max(1 - T - ends.a * k, 0) + C_0 * T

// The weight of a fragment, and its end (see PeelnetPlace). What the network says of the ends is not used: they are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, moments, extent);
    let f = peelnet_features(place, moments, extent);
    let x = 2.0 * f.depth_fraction - 1.0;
    let bounds = peelnet_interval_bounds(f.means, x);
    let shape = peelnet_shape(f.means, x);
    let share = peelnet_share(
        f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low, f.share_high,
        bounds.x, bounds.y, shape.x, shape.y);
    let between = select(f.root_absorbance * f.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_features gives them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let x0 = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let x1 = vec4f(share_high, interval_low, interval_high, depth_deviation);
    let x2 = vec4f(skewness, 0.0, 0.0, 0.0);
    let h0_0 = max(vec4f(-3.4329448, 0.4257574, -0.38236728, 0.35393447)
        + mat4x4f(vec4f(0.16893324, -0.015885713, 0.003319901, 0.022181597), vec4f(0.73904186, -3.5935516, -1.093767, -3.9295878), vec4f(3.8940587, -0.16252771, 1.9925038, 1.7745312), vec4f(-0.32772526, 1.6596408, -0.4887011, -4.0284243)) * x0
        + mat4x4f(vec4f(1.0617548, -1.104022, -3.0372758, 2.7761524), vec4f(1.49091, -0.014263286, -0.7324958, 0.745631), vec4f(-0.0857029, 0.34350348, 1.3037059, 0.18845159), vec4f(-0.05093595, -0.07411481, -0.44046843, 0.23923099)) * x1
        + vec4f(0.5519245, -0.13888931, 0.7239659, 0.56433207) * x2.x, vec4f(0.0));
    let h0_1 = max(vec4f(2.133184, 0.6183987, -0.830611, -0.9479772)
        + mat4x4f(vec4f(-0.15036699, -0.02252269, -0.07699534, 0.14239514), vec4f(2.5082452, -1.7370839, 0.7421304, 1.0806661), vec4f(-3.7652328, 0.4970172, 0.9916373, 1.8031406), vec4f(-0.92260474, 3.6954188, 3.1163683, 1.386509)) * x0
        + mat4x4f(vec4f(-2.3471532, 1.770608, -0.057374734, -0.60207516), vec4f(-0.2062029, -0.26710677, -4.313324, -2.0435584), vec4f(0.7174406, -2.4171762, 1.1130525, -0.59132785), vec4f(-0.8490425, -0.66722095, 0.3707579, 0.14809309)) * x1
        + vec4f(-0.47435924, 1.0933143, -0.18793602, -0.6559929) * x2.x, vec4f(0.0));
    let h0_2 = max(vec4f(-4.328684, 1.3590783, -2.3474388, 1.7803392)
        + mat4x4f(vec4f(0.064386025, 0.061285224, -0.054346036, -0.0031657883), vec4f(-3.264346, 0.33460826, -0.30325836, -0.64627373), vec4f(0.16798227, -0.45244542, 5.826781, 0.4113126), vec4f(3.584061, -3.1686258, -1.6566868, -0.06338985)) * x0
        + mat4x4f(vec4f(1.9432863, -0.38896838, -0.04990703, -4.051329), vec4f(2.861181, -1.3210126, -2.2987123, 1.2307065), vec4f(2.807255, -1.7623488, 1.7478015, 0.2583005), vec4f(-0.75760406, 0.2490981, 0.18981676, 1.9556252)) * x1
        + vec4f(-1.7612786, 0.6490365, 0.45720333, -0.18072814) * x2.x, vec4f(0.0));
    let h0_3 = max(vec4f(-0.5379105, -1.4180809, 0.0, 0.0)
        + mat4x4f(vec4f(-0.02910298, 0.009979617, 0.0, 0.0), vec4f(0.14556979, 3.0461023, 0.0, 0.0), vec4f(2.1482964, 0.80811286, 0.0, 0.0), vec4f(-1.6413015, -1.9208486, 0.0, 0.0)) * x0
        + mat4x4f(vec4f(0.61723286, 0.86685133, 0.0, 0.0), vec4f(2.3868225, 3.0058692, 0.0, 0.0), vec4f(-0.974536, -1.4924266, 0.0, 0.0), vec4f(3.0375583, 0.57998383, 0.0, 0.0)) * x1
        + vec4f(0.84643567, -0.8403569, 0.0, 0.0) * x2.x, vec4f(0.0));
    let h1_0 = max(vec4f(-0.4463437, -0.3787895, 0.6359637, -0.059887026)
        + mat4x4f(vec4f(0.10061981, 0.47682652, -0.31207818, 0.0058313687), vec4f(-1.4756205, -1.6086044, -0.43319115, 0.58559066), vec4f(1.605824, 0.7621909, 0.9443154, 1.1583197), vec4f(-0.34426415, 0.23591779, -0.17268713, 0.5961719)) * h0_0
        + mat4x4f(vec4f(0.2532967, -0.23012674, -0.22211243, -0.27824515), vec4f(-0.8532528, 0.32261387, 0.106130876, -2.0113811), vec4f(0.144674, 0.4094802, 0.62184, -0.6910488), vec4f(-0.117284335, -0.82919556, -0.6724757, 0.13377638)) * h0_1
        + mat4x4f(vec4f(-0.04012351, 0.6499373, 0.53790545, 0.4268408), vec4f(-0.19940762, -0.78281176, -0.5341983, 0.66455656), vec4f(-0.10683063, -0.026919993, 0.24846801, -0.075744264), vec4f(-1.4480144, -0.11110954, 0.88651484, -0.66836876)) * h0_2
        + mat4x4f(vec4f(-5.036656, 0.16954166, 0.38980037, -0.62064123), vec4f(0.09103216, 0.8937812, 0.016375229, 0.41407573), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_1 = max(vec4f(0.7001446, 0.8549452, -0.7869372, 0.38279632)
        + mat4x4f(vec4f(0.31240654, -0.6718273, 0.4963176, 0.5911572), vec4f(-1.3009747, -0.7344296, 1.2097821, -0.2153869), vec4f(-0.88983065, -0.15262419, 0.06625196, -0.7205622), vec4f(0.825422, 0.8772106, 0.18505254, 0.37723404)) * h0_0
        + mat4x4f(vec4f(-0.36837754, -0.3932257, 0.8366394, 0.76779383), vec4f(-0.073871255, -0.14726996, 0.2252004, 0.21513246), vec4f(0.06755667, -0.8610608, -0.7021018, 0.3834395), vec4f(0.22376043, -0.07781836, -0.25597402, 0.37991416)) * h0_1
        + mat4x4f(vec4f(0.1060461, 0.58936, -0.5083209, -0.047828972), vec4f(-0.50931245, 0.3092287, 0.19077988, -0.16474856), vec4f(0.22488497, 0.35773838, 0.47025687, 0.667565), vec4f(-0.54916376, -0.25280353, -1.0898602, -0.5482404)) * h0_2
        + mat4x4f(vec4f(-0.5777269, -0.34591755, -0.31924847, 0.06814068), vec4f(0.09320195, -0.1129812, 0.12061524, 0.61444724), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_2 = max(vec4f(-0.13284211, 0.0, 0.0, 0.0)
        + mat4x4f(vec4f(0.45111957, 0.0, 0.0, 0.0), vec4f(-1.8018129, 0.0, 0.0, 0.0), vec4f(-0.7673947, 0.0, 0.0, 0.0), vec4f(0.9103956, 0.0, 0.0, 0.0)) * h0_0
        + mat4x4f(vec4f(0.06295529, 0.0, 0.0, 0.0), vec4f(0.23473684, 0.0, 0.0, 0.0), vec4f(-0.18319139, 0.0, 0.0, 0.0), vec4f(0.056696832, 0.0, 0.0, 0.0)) * h0_1
        + mat4x4f(vec4f(0.38484162, 0.0, 0.0, 0.0), vec4f(-0.20819232, 0.0, 0.0, 0.0), vec4f(0.1950656, 0.0, 0.0, 0.0), vec4f(-0.10813518, 0.0, 0.0, 0.0)) * h0_2
        + mat4x4f(vec4f(0.6314189, 0.0, 0.0, 0.0), vec4f(-0.59869134, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h2_0 = 1.0 / (1.0 + exp(min(-(-0.31414962
        + dot(vec4f(-0.99496967, 0.60109556, 0.35343206, -0.70867), h1_0)
        + dot(vec4f(0.63765764, -0.7648497, -0.94688624, -0.5484821), h1_1)
        + 0.50164104 * h1_2.x), 80.0)));
    return h2_0;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46191.68, 46204.58), clamp(depth_fraction, -2951.244, 2952.2727), clamp(mean_fraction, -1306.9567, 1307.9891), clamp(share_low, -2998.4138, 2999.0276), clamp(share_high, -3082.932, 3084.3035), clamp(interval_low, -2873.3933, 2873.9612), clamp(interval_high, -2573.1853, 2574.6638), clamp(depth_deviation, -6513.9717, 6513.959), clamp(skewness, -3978.4773, 3978.409)));
}
