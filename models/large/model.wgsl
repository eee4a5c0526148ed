// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 7-15-10-1 (Relu hidden, Sigmoid last), 291 parameters, 265 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance in root of the rest's absorbance, valid range 0.0 .. 22.26442 (what training saw).
// Input 1: depth_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 2: mean_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 3: share_low in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 4: share_high in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 5: interval_low in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 6: interval_high in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Trained on 20038556 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset 0599362acca622793292093ff63ae72863fd302015bdf7c35303dc4c52e527db+f44d32a5ff14ca4bf843253253d7571da2829a9e36c000d5dd700fd1b1454788).
// Loss: training 0.000196, validation 0.000201, test 0.000205.
// Held-out error, mean |T - T_exact|: boxes-held 0.01763, cups-held 0.02433, foliage-held 0.01002, panes-held 0.00955, sixteen-held 0.02125, smoke-held 0.02913.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) = 1.0
// Self-test: peelnet_weight(11.13221, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5) = 3.69783e-39
// Self-test: peelnet_weight(22.26442, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0) = 0.0

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
// (Muenstermann et al. 2018). All are over -1 .. 1.
fn peelnet_moment_bounds(moments: vec4f, x: f32) -> vec2f {
    // A little of a measure that has more than three points, so that nothing is singular.
    let m = mix(moments, vec4f(0.0, 0.375, 0.0, 0.375), 0.001);
    // Cholesky factors of the Hankel matrix, the kernel polynomial, its roots: the extreme measure's points beside x.
    let variance = m.y - m.x * m.x;
    let l21_variance = m.z - m.x * m.y;
    let inverse_variance = 1.0 / variance;
    let l21 = l21_variance * inverse_variance;
    let d22 = m.w - m.y * m.y - l21_variance * l21;
    let y1 = x - m.x;
    let y2 = x * x - m.y - l21 * y1;
    let c2 = y2 / d22;
    let c1 = y1 * inverse_variance - l21 * c2;
    let c0 = 1.0 - m.x * c1 - m.y * c2;
    let inverse_c2 = 1.0 / c2;
    let half_p = 0.5 * c1 * inverse_c2;
    let root = sqrt(max(half_p * half_p - c0 * inverse_c2, 0.0));
    let p1 = -half_p - root;
    let p2 = -half_p + root;
    let f1 = select(0.0, 1.0, p1 < x);
    let f2 = select(0.0, 1.0, p2 < x);
    // The quadratic through the three points, and its mean: without and with what lies at x itself.
    let f0 = vec2f(0.0, 1.0);
    let f01 = (f1 - f0) * (1.0 / (p1 - x));
    let f12 = (f2 - f1) / (p2 - p1);
    let f012 = (f12 - f01) * (1.0 / (p2 - x));
    let a0 = f0 - x * (f01 - f012 * p1);
    let a1 = f01 - f012 * (p1 + x);
    let share = a0 + a1 * m.x + f012 * m.y;
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
    let bounds = peelnet_moment_bounds(vec4f(m1, m2, m3, m4), x);
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
    let bounds = peelnet_interval_bounds(f.means, 2.0 * f.depth_fraction - 1.0);
    let share = peelnet_share(
        f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low, f.share_high,
        bounds.x, bounds.y);
    let between = select(f.root_absorbance * f.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_features gives them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32) -> f32 {
    let x0 = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let x1 = vec4f(share_high, interval_low, interval_high, 0.0);
    let h0_0 = max(vec4f(-0.911343, 3.0541487, -8.1637745, 1.5225799)
        + mat4x4f(vec4f(0.0339215, -0.21341813, 0.08207686, -0.043079387), vec4f(0.06554746, 2.5341513, -2.889149, -0.923673), vec4f(0.9296132, -3.2775407, 3.5041568, -0.9391044), vec4f(3.2363348, 0.05342708, 3.6910138, 1.1546946)) * x0
        + mat4x4f(vec4f(0.57140636, -1.4451693, 3.9071949, -3.3481846), vec4f(1.274033, -0.1867686, 0.28554523, 1.730838), vec4f(-0.2545092, -1.4209543, 2.960234, 0.1926444), vec4f(0.0, 0.0, 0.0, 0.0)) * x1, vec4f(0.0));
    let h0_1 = max(vec4f(0.3921617, -2.0459518, 0.3310917, 0.24218863)
        + mat4x4f(vec4f(0.018482745, -0.06883197, -0.07939925, -0.0018348515), vec4f(-1.437895, 1.3299687, -4.4428062, 0.18666309), vec4f(2.305483, -4.164914, 3.1082175, -0.32396883), vec4f(2.4344509, 3.472801, -1.0387152, 1.7886326)) * x0
        + mat4x4f(vec4f(0.94431555, 3.5323484, 1.3815985, -3.767002), vec4f(-1.9899687, 0.20867378, 0.35942683, 3.1607106), vec4f(-2.014852, 0.97739893, 0.63187844, 0.4216494), vec4f(0.0, 0.0, 0.0, 0.0)) * x1, vec4f(0.0));
    let h0_2 = max(vec4f(-3.5800369, 1.5755365, -1.042644, 0.72093666)
        + mat4x4f(vec4f(0.11309372, -0.004152909, -0.07447291, 0.109097876), vec4f(0.75958556, 0.47402713, 2.8640463, 1.5158749), vec4f(2.8259199, 1.6532582, 0.69031525, -1.7547964), vec4f(-1.6317127, -2.805289, 2.571775, -3.9814353)) * x0
        + mat4x4f(vec4f(0.64862454, -1.5154284, -0.054249894, -0.9887548), vec4f(4.5881453, 0.19980446, -3.7511437, -0.027281927), vec4f(0.8807141, -1.5541732, 0.4605721, 0.56738275), vec4f(0.0, 0.0, 0.0, 0.0)) * x1, vec4f(0.0));
    let h0_3 = max(vec4f(-0.2794128, 3.7010217, 0.8563739, 0.0)
        + mat4x4f(vec4f(0.008719908, -0.008979022, -0.078004785, 0.0), vec4f(-3.8627377, 1.2404208, 0.30928493, 0.0), vec4f(0.47759104, -4.027323, -0.36302668, 0.0), vec4f(-1.4143972, 0.44236246, -3.5244315, 0.0)) * x0
        + mat4x4f(vec4f(0.8700534, 1.9150102, 1.5846378, 0.0), vec4f(1.1551808, 1.830021, -0.7239776, 0.0), vec4f(2.2425838, -4.237711, 0.16374929, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * x1, vec4f(0.0));
    let h1_0 = max(vec4f(0.20781672, 0.19340327, -0.76773363, 1.041103)
        + mat4x4f(vec4f(-0.10996426, 0.7138414, -2.20621, -0.62587494), vec4f(0.27204737, 0.626493, 0.6372826, 0.29390916), vec4f(-0.13781294, 1.2642797, -0.066915825, -1.5553304), vec4f(0.2759206, 0.040172365, -0.2934694, 0.2626704)) * h0_0
        + mat4x4f(vec4f(0.21082535, 0.32292068, 0.08802299, 0.32991594), vec4f(-0.27716175, -0.093468696, -4.732196, -0.24079107), vec4f(0.22779647, 0.34990802, 0.06317181, -0.56881356), vec4f(-0.47241452, -3.1207502, -2.2222633, -1.3827075)) * h0_1
        + mat4x4f(vec4f(0.6624454, -0.3963289, 0.59256, 0.9866965), vec4f(0.5998333, 0.17872389, 0.4949784, -0.015524761), vec4f(0.4131998, -1.1495643, -0.33299077, -0.775659), vec4f(0.36169654, 0.19088823, 0.547806, -0.82228225)) * h0_2
        + mat4x4f(vec4f(0.79140204, 0.042146854, 0.37195745, 0.14312325), vec4f(0.32010397, -0.4461216, -0.983489, 0.21649446), vec4f(0.4454604, 0.6189265, 0.3345864, -0.36141923), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_1 = max(vec4f(0.33505625, 0.12890564, 0.023216972, -0.5367038)
        + mat4x4f(vec4f(0.6367265, -0.4836024, 0.15815045, -1.3467251), vec4f(0.4828115, -0.1952224, 0.1586456, -1.1165586), vec4f(0.8416288, 0.4980116, -0.38070112, -1.2889172), vec4f(-1.4419537, -1.5838299, -0.08207864, -1.0104504)) * h0_0
        + mat4x4f(vec4f(0.25695598, 0.63151866, 0.50217277, 0.15321282), vec4f(0.6397786, -0.1346199, -0.018614147, 1.5142317), vec4f(0.70547026, 0.7000566, -0.36026198, -0.42001113), vec4f(1.0550673, -0.80383193, -0.3135395, 1.8824589)) * h0_1
        + mat4x4f(vec4f(0.55023026, 1.0798317, 0.7680024, -0.74235475), vec4f(-0.2765876, -0.21580754, 0.13268325, 0.14098273), vec4f(0.0368447, 0.121021025, 0.01568237, 0.35410237), vec4f(-0.30403188, -0.22518952, -0.42287266, -0.10773963)) * h0_2
        + mat4x4f(vec4f(0.14963754, 0.58753026, 0.3892399, -1.3562495), vec4f(-0.19373983, 0.42159837, 0.3878964, -0.62881666), vec4f(-0.12877022, 0.061994795, 0.25757223, 0.51773876), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_2 = max(vec4f(-0.52501637, 0.23033486, 0.0, 0.0)
        + mat4x4f(vec4f(-2.4508297, 0.096860096, 0.0, 0.0), vec4f(0.21482317, -0.048510637, 0.0, 0.0), vec4f(3.8816707, -0.16929832, 0.0, 0.0), vec4f(0.5105461, 0.2860743, 0.0, 0.0)) * h0_0
        + mat4x4f(vec4f(-0.66402555, 0.46247193, 0.0, 0.0), vec4f(1.3492857, -0.4407754, 0.0, 0.0), vec4f(-0.9926203, -0.16286606, 0.0, 0.0), vec4f(0.46101588, -0.41319308, 0.0, 0.0)) * h0_1
        + mat4x4f(vec4f(0.11424991, 0.5443615, 0.0, 0.0), vec4f(0.42798072, 0.36644313, 0.0, 0.0), vec4f(-0.34932813, 0.58272785, 0.0, 0.0), vec4f(0.412623, 0.29490647, 0.0, 0.0)) * h0_2
        + mat4x4f(vec4f(0.056904275, 0.63250345, 0.0, 0.0), vec4f(-0.21951073, 0.3397382, 0.0, 0.0), vec4f(0.020217787, 0.3392454, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h2_0 = 1.0 / (1.0 + exp(min(-(-0.16611153
        + dot(vec4f(-0.34204745, -0.7411193, -1.0996499, 0.36648035), h1_0)
        + dot(vec4f(0.34412265, 0.682066, -0.1117161, 1.948139), h1_1)
        + dot(vec4f(1.302477, -0.2686051, 0.0, 0.0), h1_2)), 80.0)));
    return h2_0;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46191.68, 46204.58), clamp(depth_fraction, -2951.244, 2952.2727), clamp(mean_fraction, -1306.9567, 1307.9891), clamp(share_low, -2998.4138, 2999.0276), clamp(share_high, -3082.932, 3084.3035), clamp(interval_low, -2873.3933, 2873.9612), clamp(interval_high, -2573.1853, 2574.6638)));
}
