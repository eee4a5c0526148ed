// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.
// Network: 5-12-1 (Relu hidden, Sigmoid last), 85 parameters, 72 multiply-adds. Recipe anchored-medium, seed 1, 80 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of the rest's absorbance), 0.0 .. 21.672869 in training.
// Input 1: depth_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 3: share_low (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 4: share_high (of the rest's absorbance), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21531714 rows (b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000286, validation 0.000283, test 0.000284.
// Held-out error, mean |T - T_exact|: boxes-held 0.01767, cups-held 0.01845, foliage-held 0.00934, panes-held 0.00575, sixteen-held 0.01032, smoke-held 0.01492.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(8.434867, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.13616015
// peelnet_weight(12.38736, 0.06893927, 0.677021, 0.9734965, 0.49854618) = 0.07002933
// peelnet_weight(3.30784, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.13059078
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.49881455
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25946447
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    colour of the pixel: 0.615625, 0.3654342, 0.2501908
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta);
//    moments: rgba16float, cleared to 0, blending ADD, from s.moments
//    extent: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. let f = peelnet_fragment(alpha, zeta, moments, extent);
//    sums: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * (f.x * (1.0 - min(f.y, 1.0)))
//    ends: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * (f.x * min(f.y, 1.0))
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

// The network's answer for what is known of a fragment.
fn peelnet_network(rest: PeelnetRest) -> f32 {
    let bounds = peelnet_moment_bounds(rest);
    return peelnet_share(
        rest.root_absorbance, 0.5 * rest.place + 0.5, 0.5 * rest.means.x + 0.5, bounds.x, bounds.y);
}

// The share of the rest's absorbance that lies in front, for inputs as peelnet_network evaluates them.
fn peelnet_share(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let input_a = vec4f(root_absorbance, depth_fraction, mean_fraction, share_low);
    let input_b = vec4f(share_high, 0.0, 0.0, 0.0);
    let layer_a_a = max(vec4f(0.7271213, -0.2522731, -6.2262597, 1.3489159)
        + mat4x4f(vec4f(-0.022978364, 0.041489735, -0.026803136, -0.0038914087), vec4f(-8.930611, 2.5493624, -7.9762807, 1.8994282), vec4f(-0.070468575, -2.5054536, 9.861962, -1.4394459), vec4f(0.075987875, -6.393223, 6.827041, -12.16021)) * input_a
        + vec4f(-0.5287007, -2.4133942, -1.0519068, -1.7369345) * input_b.x, vec4f(0.0));
    let layer_a_b = max(vec4f(-0.4029816, 2.673338, 4.5243855, 1.244728)
        + mat4x4f(vec4f(0.1187417, -0.01221438, -0.19914894, 0.19657665), vec4f(5.5338125, 0.9974758, 7.7009387, 0.6825083), vec4f(-6.2322464, -2.2639256, -8.831479, 1.6443881), vec4f(-3.0740392, -7.791208, 1.0749248, -9.23326)) * input_a
        + vec4f(1.7366083, -4.3891034, -4.030473, -2.4510674) * input_b.x, vec4f(0.0));
    let layer_a_c = max(vec4f(-9.847884, -0.55330116, -0.6435262, 1.858057)
        + mat4x4f(vec4f(-0.16843866, -0.20134947, 0.0016715517, -0.023076097), vec4f(1.4405842, 5.2241726, -2.7744648, 0.3580333), vec4f(-2.748782, -5.586635, 0.60922533, -1.2142211), vec4f(-0.5700685, 6.842048, 0.26273173, -4.6382055)) * input_a
        + vec4f(11.166643, 1.4586995, 0.065701395, -6.3878007) * input_b.x, vec4f(0.0));
    let layer_b_a = 1.0 / (1.0 + exp(min(-(-0.55472857
        + dot(vec4f(-2.1254504, -3.0775745, -0.6885362, -1.0587276), layer_a_a)
        + dot(vec4f(-0.15840325, -0.6901868, -0.3667487, -0.40382), layer_a_b)
        + dot(vec4f(1.1485423, 0.47336403, -1.2541678, -1.6893119), layer_a_c)), 80.0)));
    return layer_b_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    let share = peelnet_share(
        clamp(root_absorbance, -46960.414, 46974.062), clamp(depth_fraction, -2907.894, 2908.9092), clamp(mean_fraction, -1211.0835, 1212.094), clamp(share_low, -2969.3333, 2969.953), clamp(share_high, -2983.678, 2985.068));
    return exp(-root * root * share);
}
