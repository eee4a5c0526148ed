// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 5-8-1 (Relu hidden, Sigmoid last), 57 parameters, 48 multiply-adds. Recipe small, seed 1, 24 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance in root of the rest's absorbance, valid range 0.0 .. 22.349512 (what training saw).
// Input 1: depth_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 2: mean_fraction in of the pixel's depth range, valid range 0.0 .. 1.0 (what training saw).
// Input 3: share_low in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Input 4: share_high in of the rest's absorbance, valid range 0.0 .. 1.0 (what training saw).
// Trained on 20038556 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset 0599362acca622793292093ff63ae72863fd302015bdf7c35303dc4c52e527db+f44d32a5ff14ca4bf843253253d7571da2829a9e36c000d5dd700fd1b1454788).
// Loss: training 0.000297, validation 0.000302, test 0.000303.
// Held-out error, mean |T - T_exact|: boxes-held 0.01364, cups-held 0.01712, foliage-held 0.00772, panes-held 0.00506, sixteen-held 0.01457, smoke-held 0.02140.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0) = 1.0
// Self-test: peelnet_weight(11.174756, 0.5, 0.5, 0.5, 0.5) = 1.7059722e-35
// Self-test: peelnet_weight(22.349512, 1.0, 1.0, 1.0, 1.0) = 0.0

// Statistics pass: draw all transparent surfaces, in any order, into
//     moments  rgba16float (or rgba32float), cleared to 0, blending ONE, ONE, ADD;
//     extent   rgba16float (or rgba32float), cleared to (-65504, -65504, -65504, 0), blending ONE, ONE, MAX for colour and
//              ONE, ONE, ADD for alpha;
// each fragment writing what peelnet_statistics(alpha, zeta) returns.
// zeta is depth on a logarithmic scale: with z the distance along the view axis, and near and far the range that the
// bounding boxes of the transparent objects in view span (clipped to the camera's),
//     zeta = clamp(2 * log(z / near) / log(far / near) - 1, -1, 1).
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

// Weight pass: draw all transparent surfaces again; each fragment reads its pixel's statistics and writes
// (alpha * rgb * w, alpha * w) with w = peelnet_fragment(..).x to an rgba16float target cleared to 0, blending ONE, ONE,
// ADD. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     sums.rgb / sums.a * (1 - T) + C_0 * T

// The weight of a fragment, and its end (see PeelnetPlace). What the network says of the ends is not used: they are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, moments, extent);
    let f = peelnet_features(place, moments, extent);
    let share = peelnet_share(
        f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low, f.share_high);
    let between = select(f.root_absorbance * f.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_features gives them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let x0 = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let x1 = vec4f(share_high, 0.0, 0.0, 0.0);
    let h0_0 = max(vec4f(-3.403848, 5.659858, 1.1971129, -1.9402503)
        + mat4x4f(vec4f(-0.048261918, -0.049491554, 0.13784179, 0.024843408), vec4f(2.8354657, -4.3898478, -0.009191628, 1.688664), vec4f(1.3774431, -2.432028, -0.322701, 1.0614194), vec4f(0.33418316, -0.86584413, -4.413494, -4.890697)) * x0
        + vec4f(1.7644012, -1.7904849, -2.2149596, 4.8002143) * x1.x, vec4f(0.0));
    let h0_1 = max(vec4f(0.5420309, 3.5868983, 1.0010448, -1.3259909)
        + mat4x4f(vec4f(-0.08698753, -0.17512268, 0.04461627, 0.015495436), vec4f(-0.9744305, -0.86506003, 2.9325352, -0.270699), vec4f(0.27855828, 1.7259756, -3.7425344, 1.9209986), vec4f(2.2361915, -0.05330946, -0.15355836, -4.5470953)) * x0
        + vec4f(0.7207937, -3.2857769, -1.9770964, 4.4835553) * x1.x, vec4f(0.0));
    let h1_0 = 1.0 / (1.0 + exp(min(-(0.33157063
        + dot(vec4f(0.80303395, -0.44773844, -1.0498732, -1.9469818), h0_0)
        + dot(vec4f(0.8917978, -0.6287421, 1.1671531, 1.7540251), h0_1)), 80.0)));
    return h1_0;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46260.56, 46273.41), clamp(depth_fraction, -2951.363, 2952.3918), clamp(mean_fraction, -1332.858, 1333.8905), clamp(share_low, -2997.906, 2998.5178), clamp(share_high, -3073.0952, 3074.4712)));
}
