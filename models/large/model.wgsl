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
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in both passes.
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

// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. near, far: the nearest and the
// farthest z that transparent surfaces have in this frame. Where near is not above 0 the scale is linear: with an orthographic
// camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    let linear = near <= 0.0;
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let start = max(near, 1.17549435e-38);
    let depth = select(log(max(z / start, 1.0)), z - near, linear);
    let range = select(log(max(far / start, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = range <= select(1e-6, 0.0, linear);
    let scaled = select(depth * (2.0 / max(range, 1e-30)), 0.0, flat);
    return clamp(scaled - 1.0, -1.0, 1.0);
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
        clamp((mean.x - middle) * scale, -1.0, 1.0),
        (mean.y - middle * (2.0 * mean.x - middle)) * scale_square,
        (mean.z - middle * (3.0 * mean.y - middle * (3.0 * mean.x - middle))) * scale * scale_square,
        (mean.w - middle * (4.0 * mean.z - middle * (6.0 * mean.y - middle * (4.0 * mean.x - middle)))) * scale_square * scale_square,
    );
    return PeelnetRest(
        sqrt(absorbance),
        clamp((z.x - middle) * scale, -1.0, 1.0),
        means,
        // Moved to a narrow pixel's range, moments lose their last bits.
        min(0.0009765625 + scale_square * scale_square * 0.0000152587890625, 0.25),
    );
}

// The weight of a fragment, and its end (see PeelnetPlace). The network's answer is not used for the ends, whose weights are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    // Sums of 16-bit targets may become infinite.
    let finite_moments = clamp(moments, vec4f(-65504.0), vec4f(65504.0));
    let finite_extent = clamp(extent, vec4f(-65504.0), vec4f(65504.0));
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
    let mixed = mix(rest.means, vec4f(0.0, 0.375, 0.0, 0.375), rest.bias);
    // Shares do not depend on the unit of depth. Another one where moments exceed the range, as those of narrow pixels and noise do:
    // their products would overflow.
    let unit = 1.0 / sqrt(max(1.0, max(abs(mixed.y), sqrt(abs(mixed.w)))));
    let square = unit * unit;
    let x = rest.place * unit;
    let m = mixed * vec4f(unit, square, square * unit, square * square);
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
    let layer_a_a = max(vec4f(-0.89093506, 1.8157883, -0.31449613, 1.5014997)
        + mat4x4f(vec4f(-0.12323093, 0.0018430905, -0.012637873, -0.06969165), vec4f(0.84363085, -0.39626673, -1.5161891, -3.912475), vec4f(2.526658, 0.54497015, 0.774746, 1.0630852), vec4f(4.397354, 0.40269038, 0.9223805, -0.5121709)) * input_a
        + mat4x4f(vec4f(-2.9508302, -2.9832327, -3.804875, 2.0328605), vec4f(-0.53755885, -0.035161857, 1.7351631, -0.10027233), vec4f(0.32423943, -0.9584745, 1.507115, -1.4228909), vec4f(1.0768129, -0.31840107, -0.15289356, -0.53387135)) * input_b
        + vec4f(-1.154485, 2.258196, -0.14455865, -0.35175437) * input_c.x, vec4f(0.0));
    let layer_a_b = max(vec4f(2.7851763, 2.9470465, -0.10280397, 1.9700223)
        + mat4x4f(vec4f(-0.14861915, 0.087033816, -0.069306605, 0.21152052), vec4f(2.5681517, -1.5469047, 1.5457364, 0.62206995), vec4f(-4.539191, -5.0847993, 0.26296183, -2.0571132), vec4f(-0.25586545, -0.065651566, 2.4404922, -3.8921525)) * input_a
        + mat4x4f(vec4f(-2.6435363, 1.6679868, 1.2112563, -0.9783559), vec4f(0.31011182, 1.7710911, -3.5455196, -2.3216102), vec4f(0.6184234, -2.527497, -1.0337429, -0.764203), vec4f(-0.8865599, -0.8579631, 0.66809696, 0.7636052)) * input_b
        + vec4f(-0.62751615, -0.48774618, 0.52578926, 0.33726043) * input_c.x, vec4f(0.0));
    let layer_a_c = max(vec4f(-7.620072, 0.6718131, -2.8479023, 1.4106311)
        + mat4x4f(vec4f(0.08863558, -0.021929622, 0.13711166, -0.052819286), vec4f(-1.032984, -0.7920694, -1.881591, -0.42707837), vec4f(-0.30496052, 0.685463, 2.9543505, 1.3530465), vec4f(3.8324728, -2.7165563, -2.712868, 2.07208)) * input_a
        + mat4x4f(vec4f(2.192075, -2.9897816, 0.30047962, -4.5265293), vec4f(0.436618, -0.5025884, -1.5863408, 2.1857657), vec4f(4.605391, 1.6813914, 3.4396899, 0.26057068), vec4f(-0.21235804, 0.82360494, 0.12335592, 2.4147825)) * input_b
        + vec4f(-2.4302595, -0.28096452, -0.35509256, 0.49069303) * input_c.x, vec4f(0.0));
    let layer_a_d = max(vec4f(-2.383473, 0.08268092, 0.0, 0.0)
        + mat4x4f(vec4f(-0.08799581, 0.0035113918, 0.0, 0.0), vec4f(0.6492379, 4.042684, 0.0, 0.0), vec4f(3.9359393, 0.16847877, 0.0, 0.0), vec4f(-2.2907748, -2.984884, 0.0, 0.0)) * input_a
        + mat4x4f(vec4f(1.8163178, -0.32309484, 0.0, 0.0), vec4f(0.85059834, -0.22918512, 0.0, 0.0), vec4f(-0.7147693, -0.7135528, 0.0, 0.0), vec4f(2.4781156, 0.06297139, 0.0, 0.0)) * input_b
        + vec4f(0.57381064, 0.34692982, 0.0, 0.0) * input_c.x, vec4f(0.0));
    let layer_b_a = max(vec4f(-0.63947695, -0.066363975, 0.4969189, -1.391002)
        + mat4x4f(vec4f(-0.5668303, -0.8485692, -0.46361342, -0.21489951), vec4f(0.10872327, 0.80014825, 0.26593605, 0.61877745), vec4f(-0.51736856, -2.2935348, 0.18743463, -0.43730015), vec4f(-0.4323498, 0.041091945, -0.18476301, 0.586554)) * layer_a_a
        + mat4x4f(vec4f(0.4433708, -0.31030995, -0.1786144, 0.29837462), vec4f(0.3656961, 0.34822863, 0.06314083, 0.045586094), vec4f(0.65114135, -0.37217852, 0.5102594, -0.23728102), vec4f(0.280315, -0.80226845, -1.8851312, 0.38364726)) * layer_a_b
        + mat4x4f(vec4f(-0.9361117, 0.04522255, 0.613751, -0.12238284), vec4f(1.9228362, -0.26235867, -0.6523954, 0.6854075), vec4f(-1.0632724, 0.21820164, 0.36047044, 0.08984213), vec4f(-1.6814075, -0.2413455, 1.1932366, -1.3477432)) * layer_a_c
        + mat4x4f(vec4f(-0.45597082, 0.88505983, 0.5004777, 0.41412193), vec4f(0.50326276, -0.40661916, -0.049472123, 0.6122778), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_b_b = max(vec4f(0.14739355, 0.36400864, -0.0876792, -0.08567302)
        + mat4x4f(vec4f(-0.56268203, -0.8032054, -0.6348575, 0.9113383), vec4f(0.28522977, 0.21909298, 0.30313122, -0.06335604), vec4f(-0.77836794, -1.0159388, -0.56641716, -0.8635317), vec4f(0.22963104, 0.5570624, 0.532258, 0.5633063)) * layer_a_a
        + mat4x4f(vec4f(0.16748461, 0.8333075, 0.071174875, 0.32688975), vec4f(0.9782136, 0.74208385, -0.20954137, 0.3634777), vec4f(0.21305963, -0.15923576, -0.091780394, 0.0049423245), vec4f(-0.06614502, 0.3437537, 0.0066019227, -0.07900418)) * layer_a_b
        + mat4x4f(vec4f(0.72658473, 1.0371692, 1.4478635, -1.0427004), vec4f(-2.0747466, -0.35869792, 0.46560964, -0.2615018), vec4f(-0.4880833, 0.023512624, 0.34098, 0.011341497), vec4f(0.26343, 0.08615409, -0.39866453, 0.092497036)) * layer_a_c
        + mat4x4f(vec4f(-0.05946362, -0.36581075, -0.20993309, -0.28426015), vec4f(0.19381097, 0.2031862, 0.6013997, 0.6168965), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_b_c = max(vec4f(-0.34866828, 0.0, 0.0, 0.0)
        + mat4x4f(vec4f(-0.02030483, 0.0, 0.0, 0.0), vec4f(-0.019286718, 0.0, 0.0, 0.0), vec4f(-2.5914679, 0.0, 0.0, 0.0), vec4f(0.5957656, 0.0, 0.0, 0.0)) * layer_a_a
        + mat4x4f(vec4f(0.21826716, 0.0, 0.0, 0.0), vec4f(0.1850472, 0.0, 0.0, 0.0), vec4f(0.43043444, 0.0, 0.0, 0.0), vec4f(0.4448314, 0.0, 0.0, 0.0)) * layer_a_b
        + mat4x4f(vec4f(0.7359675, 0.0, 0.0, 0.0), vec4f(-0.12695557, 0.0, 0.0, 0.0), vec4f(-0.23395598, 0.0, 0.0, 0.0), vec4f(0.0335331, 0.0, 0.0, 0.0)) * layer_a_c
        + mat4x4f(vec4f(-0.032401867, 0.0, 0.0, 0.0), vec4f(-0.04505425, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_d, vec4f(0.0));
    let layer_c_a = 1.0 / (1.0 + exp(min(-(-0.09174534
        + dot(vec4f(-1.0923079, 0.8117369, 0.41597024, -0.9515342), layer_b_a)
        + dot(vec4f(0.5620227, -0.54172164, -0.37775743, -0.40220174), layer_b_b)
        + 0.6821768 * layer_b_c.x), 80.0)));
    return layer_c_a;
}

// Its transmittance, for any finite inputs.
fn peelnet_weight(root_absorbance: f32, depth_fraction: f32, mean_fraction: f32, share_low: f32, share_high: f32, interval_low: f32, interval_high: f32, depth_deviation: f32, skewness: f32) -> f32 {
    let root = clamp(root_absorbance, 0.0, 256.0);
    return exp(-root * root * peelnet_share(
        clamp(root_absorbance, -46191.68, 46204.58), clamp(depth_fraction, -2951.244, 2952.2727), clamp(mean_fraction, -1306.9567, 1307.9891), clamp(share_low, -2996.0144, 2996.6282), clamp(share_high, -3065.472, 3066.8484), clamp(interval_low, -2873.3933, 2873.9612), clamp(interval_high, -2573.1853, 2574.6638), clamp(depth_deviation, -6513.9717, 6513.959), clamp(skewness, -3978.4773, 3978.409)));
}
