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
// Loss: training 0.000180, validation 0.000185, test 0.000186.
// Held-out error, mean |T - T_exact|: boxes-held 0.01390, cups-held 0.02186, foliage-held 0.00781, panes-held 0.00621, sixteen-held 0.01350, smoke-held 0.02513.
// Self-test: peelnet_weight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0, -2.0) = 1.0
// Self-test: peelnet_weight(11.13221, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.0, 0.0) = 1.960252e-37
// Self-test: peelnet_weight(22.26442, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0) = 0.0

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
    let h0_0 = max(vec4f(-0.89093506, 1.8157883, -0.31449613, 1.5014997)
        + mat4x4f(vec4f(-0.12323093, 0.0018430905, -0.012637873, -0.06969165), vec4f(0.84363085, -0.39626673, -1.5161891, -3.912475), vec4f(2.526658, 0.54497015, 0.774746, 1.0630852), vec4f(4.397354, 0.40269038, 0.9223805, -0.5121709)) * x0
        + mat4x4f(vec4f(-2.9508302, -2.9832327, -3.804875, 2.0328605), vec4f(-0.53755885, -0.035161857, 1.7351631, -0.10027233), vec4f(0.32423943, -0.9584745, 1.507115, -1.4228909), vec4f(1.0768129, -0.31840107, -0.15289356, -0.53387135)) * x1
        + vec4f(-1.154485, 2.258196, -0.14455865, -0.35175437) * x2.x, vec4f(0.0));
    let h0_1 = max(vec4f(2.7851763, 2.9470465, -0.10280397, 1.9700223)
        + mat4x4f(vec4f(-0.14861915, 0.087033816, -0.069306605, 0.21152052), vec4f(2.5681517, -1.5469047, 1.5457364, 0.62206995), vec4f(-4.539191, -5.0847993, 0.26296183, -2.0571132), vec4f(-0.25586545, -0.065651566, 2.4404922, -3.8921525)) * x0
        + mat4x4f(vec4f(-2.6435363, 1.6679868, 1.2112563, -0.9783559), vec4f(0.31011182, 1.7710911, -3.5455196, -2.3216102), vec4f(0.6184234, -2.527497, -1.0337429, -0.764203), vec4f(-0.8865599, -0.8579631, 0.66809696, 0.7636052)) * x1
        + vec4f(-0.62751615, -0.48774618, 0.52578926, 0.33726043) * x2.x, vec4f(0.0));
    let h0_2 = max(vec4f(-7.620072, 0.6718131, -2.8479023, 1.4106311)
        + mat4x4f(vec4f(0.08863558, -0.021929622, 0.13711166, -0.052819286), vec4f(-1.032984, -0.7920694, -1.881591, -0.42707837), vec4f(-0.30496052, 0.685463, 2.9543505, 1.3530465), vec4f(3.8324728, -2.7165563, -2.712868, 2.07208)) * x0
        + mat4x4f(vec4f(2.192075, -2.9897816, 0.30047962, -4.5265293), vec4f(0.436618, -0.5025884, -1.5863408, 2.1857657), vec4f(4.605391, 1.6813914, 3.4396899, 0.26057068), vec4f(-0.21235804, 0.82360494, 0.12335592, 2.4147825)) * x1
        + vec4f(-2.4302595, -0.28096452, -0.35509256, 0.49069303) * x2.x, vec4f(0.0));
    let h0_3 = max(vec4f(-2.383473, 0.08268092, 0.0, 0.0)
        + mat4x4f(vec4f(-0.08799581, 0.0035113918, 0.0, 0.0), vec4f(0.6492379, 4.042684, 0.0, 0.0), vec4f(3.9359393, 0.16847877, 0.0, 0.0), vec4f(-2.2907748, -2.984884, 0.0, 0.0)) * x0
        + mat4x4f(vec4f(1.8163178, -0.32309484, 0.0, 0.0), vec4f(0.85059834, -0.22918512, 0.0, 0.0), vec4f(-0.7147693, -0.7135528, 0.0, 0.0), vec4f(2.4781156, 0.06297139, 0.0, 0.0)) * x1
        + vec4f(0.57381064, 0.34692982, 0.0, 0.0) * x2.x, vec4f(0.0));
    let h1_0 = max(vec4f(-0.63947695, -0.066363975, 0.4969189, -1.391002)
        + mat4x4f(vec4f(-0.5668303, -0.8485692, -0.46361342, -0.21489951), vec4f(0.10872327, 0.80014825, 0.26593605, 0.61877745), vec4f(-0.51736856, -2.2935348, 0.18743463, -0.43730015), vec4f(-0.4323498, 0.041091945, -0.18476301, 0.586554)) * h0_0
        + mat4x4f(vec4f(0.4433708, -0.31030995, -0.1786144, 0.29837462), vec4f(0.3656961, 0.34822863, 0.06314083, 0.045586094), vec4f(0.65114135, -0.37217852, 0.5102594, -0.23728102), vec4f(0.280315, -0.80226845, -1.8851312, 0.38364726)) * h0_1
        + mat4x4f(vec4f(-0.9361117, 0.04522255, 0.613751, -0.12238284), vec4f(1.9228362, -0.26235867, -0.6523954, 0.6854075), vec4f(-1.0632724, 0.21820164, 0.36047044, 0.08984213), vec4f(-1.6814075, -0.2413455, 1.1932366, -1.3477432)) * h0_2
        + mat4x4f(vec4f(-0.45597082, 0.88505983, 0.5004777, 0.41412193), vec4f(0.50326276, -0.40661916, -0.049472123, 0.6122778), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_1 = max(vec4f(0.14739355, 0.36400864, -0.0876792, -0.08567302)
        + mat4x4f(vec4f(-0.56268203, -0.8032054, -0.6348575, 0.9113383), vec4f(0.28522977, 0.21909298, 0.30313122, -0.06335604), vec4f(-0.77836794, -1.0159388, -0.56641716, -0.8635317), vec4f(0.22963104, 0.5570624, 0.532258, 0.5633063)) * h0_0
        + mat4x4f(vec4f(0.16748461, 0.8333075, 0.071174875, 0.32688975), vec4f(0.9782136, 0.74208385, -0.20954137, 0.3634777), vec4f(0.21305963, -0.15923576, -0.091780394, 0.0049423245), vec4f(-0.06614502, 0.3437537, 0.0066019227, -0.07900418)) * h0_1
        + mat4x4f(vec4f(0.72658473, 1.0371692, 1.4478635, -1.0427004), vec4f(-2.0747466, -0.35869792, 0.46560964, -0.2615018), vec4f(-0.4880833, 0.023512624, 0.34098, 0.011341497), vec4f(0.26343, 0.08615409, -0.39866453, 0.092497036)) * h0_2
        + mat4x4f(vec4f(-0.05946362, -0.36581075, -0.20993309, -0.28426015), vec4f(0.19381097, 0.2031862, 0.6013997, 0.6168965), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h1_2 = max(vec4f(-0.34866828, 0.0, 0.0, 0.0)
        + mat4x4f(vec4f(-0.02030483, 0.0, 0.0, 0.0), vec4f(-0.019286718, 0.0, 0.0, 0.0), vec4f(-2.5914679, 0.0, 0.0, 0.0), vec4f(0.5957656, 0.0, 0.0, 0.0)) * h0_0
        + mat4x4f(vec4f(0.21826716, 0.0, 0.0, 0.0), vec4f(0.1850472, 0.0, 0.0, 0.0), vec4f(0.43043444, 0.0, 0.0, 0.0), vec4f(0.4448314, 0.0, 0.0, 0.0)) * h0_1
        + mat4x4f(vec4f(0.7359675, 0.0, 0.0, 0.0), vec4f(-0.12695557, 0.0, 0.0, 0.0), vec4f(-0.23395598, 0.0, 0.0, 0.0), vec4f(0.0335331, 0.0, 0.0, 0.0)) * h0_2
        + mat4x4f(vec4f(-0.032401867, 0.0, 0.0, 0.0), vec4f(-0.04505425, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * h0_3, vec4f(0.0));
    let h2_0 = 1.0 / (1.0 + exp(min(-(-0.09174534
        + dot(vec4f(-1.0923079, 0.8117369, 0.41597024, -0.9515342), h1_0)
        + dot(vec4f(0.5620227, -0.54172164, -0.37775743, -0.40220174), h1_1)
        + 0.6821768 * h1_2.x), 80.0)));
    return h2_0;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46191.68, 46204.58), clamp(depth_fraction, -2951.244, 2952.2727), clamp(mean_fraction, -1306.9567, 1307.9891), clamp(share_low, -2996.0144, 2996.6282), clamp(share_high, -3065.472, 3066.8484), clamp(interval_low, -2873.3933, 2873.9612), clamp(interval_high, -2573.1853, 2574.6638), clamp(depth_deviation, -6513.9717, 6513.959), clamp(skewness, -3978.4773, 3978.409)));
}
