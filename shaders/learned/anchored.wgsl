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
// Bins of depth and levels of opacity that the nearest and the farthest fragment are kept with.
const PEELNET_NEAR_END: vec2f = vec2f(240.0, 256.0);
const PEELNET_FAR_END: vec2f = vec2f(1920.0, 32.0);

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
    // The fragment's weight but for what the network says: 1, exp(-others), or the nearest fragment's transmittance.
    known: f32,
    // Absorbance of the fragment itself, of the nearest and of the farthest where they are known.
    taken: vec3f,
    // zeta of the same.
    zeta: vec3f,
}

// What peelnet_weight reads.
struct PeelnetFeatures {
    log_absorbance: f32,
    depth_fraction: f32,
    mean_fraction: f32,
    depth_deviation: f32,
    skewness: f32,
    share_low: f32,
    share_high: f32,
    // Mean powers 1 to 3 of the rest's depth, 0 .. 1 from the nearest to the farthest.
    means: vec3f,
}

// -log(1 - alpha), at most 16: opaque, but finite.
fn peelnet_absorbance(alpha: f32) -> f32 {
    return min(-log(1.0 - min(alpha, 0.99999994)), 16.0);
}

fn peelnet_level(zeta: f32) -> f32 {
    return floor((zeta * 0.5 + 0.5) * PEELNET_TOP + 0.5);
}

fn peelnet_bin(zeta: f32, code: vec2f) -> f32 {
    return clamp(floor((zeta * 0.5 + 0.5) * code.x), 0.0, code.x - 1.0);
}

// Opacity in levels that are even in sqrt(1 - alpha).
fn peelnet_alpha_level(alpha: f32, code: vec2f) -> f32 {
    return floor((1.0 - sqrt(max(1.0 - alpha, 0.0))) * (code.y - 1.0) + 0.5);
}

fn peelnet_near_end(alpha: f32, zeta: f32) -> f32 {
    let code = PEELNET_NEAR_END;
    return (code.x - 1.0 - peelnet_bin(zeta, code)) * code.y + peelnet_alpha_level(alpha, code);
}

fn peelnet_far_end(alpha: f32, zeta: f32) -> f32 {
    let code = PEELNET_FAR_END;
    return peelnet_bin(zeta, code) * code.y + peelnet_alpha_level(alpha, code);
}

// The absorbance that an end's level stands for.
fn peelnet_end_absorbance(level: f32, code: vec2f) -> f32 {
    let through = 1.0 - (level - code.y * floor(level / code.y)) / (code.y - 1.0);
    return min(-2.0 * log(max(through, 1e-30)), 16.0);
}

// The half float that stands for a level: all normal halves in ascending order, so that MAX blending of 16-bit targets
// tells 61440 levels apart.
fn peelnet_half(level: f32) -> f32 {
    let code = u32(clamp(level, 0.0, PEELNET_TOP));
    let behind = code >= 30720u;
    // The half's exponent and fraction, widened to those of 32 bits: 112 is the difference of the biases.
    let magnitude = select(31743u - code, code - 29696u, behind);
    return bitcast<f32>(select(0x80000000u, 0u, behind) | ((magnitude << 13u) + (112u << 23u)));
}

fn peelnet_level_of_half(value: f32) -> f32 {
    let bits = bitcast<u32>(value);
    let magnitude = f32(((bits & 0x7fffffffu) - (112u << 23u)) >> 13u) - 1024.0;
    return select(30720.0 + magnitude, 30719.0 - magnitude, (bits >> 31u) == 1u);
}

fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let z2 = zeta * zeta;
    // The nearest is kept as the maximum of levels counted from the far end.
    let extent = vec3f(
        peelnet_half(PEELNET_TOP - peelnet_level(zeta)),
        peelnet_half(peelnet_near_end(alpha, zeta)),
        peelnet_half(peelnet_far_end(alpha, zeta)),
    );
    return PeelnetStatistics(
        b * vec4f(1.0, zeta, z2, z2 * zeta),
        vec4f(select(extent, vec3f(-65504.0), alpha < PEELNET_FAINT), b * z2 * z2),
    );
}

fn peelnet_place(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> PeelnetPlace {
    let b = peelnet_absorbance(alpha);
    let level = peelnet_level(zeta);
    let first = PEELNET_TOP - peelnet_level_of_half(extent.x);
    let near_end = peelnet_level_of_half(extent.y);
    let far_end = peelnet_level_of_half(extent.z);
    let own_near = peelnet_near_end(alpha, zeta);
    let own_far = peelnet_far_end(alpha, zeta);
    // Two passes may round one zeta to neighbouring levels.
    let at_end = select(select(0.0, 2.0, own_far == far_end), 1.0, level <= first + 1.0);
    let end = select(at_end, 0.0, alpha < PEELNET_FAINT);
    // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a more
    // opaque one in the same bin), stays with the rest.
    let front = select(
        0.0, peelnet_end_absorbance(near_end, PEELNET_NEAR_END), level > first && own_near != near_end);
    let back = select(0.0, peelnet_end_absorbance(far_end, PEELNET_FAR_END), own_far < far_end);
    let others = max(moments.x - b, 0.0);
    let known = select(select(exp(-front), exp(-others), end == 2.0), 1.0, end == 1.0);
    let far_bin = floor(far_end / PEELNET_FAR_END.y) + 0.5;
    return PeelnetPlace(
        end,
        known,
        vec3f(b, front, back),
        vec3f(zeta, first / PEELNET_TOP * 2.0 - 1.0, far_bin / PEELNET_FAR_END.x * 2.0 - 1.0),
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
    let l21 = l21_variance / variance;
    let d22 = m.w - m.y * m.y - l21_variance * l21;
    let y1 = x - m.x;
    let y2 = x * x - m.y - l21 * y1;
    let c2 = y2 / d22;
    let c1 = y1 / variance - l21 * c2;
    let c0 = 1.0 - m.x * c1 - m.y * c2;
    let half_p = 0.5 * c1 / c2;
    let root = sqrt(max(half_p * half_p - c0 / c2, 0.0));
    let p1 = -half_p - root;
    let p2 = -half_p + root;
    let f1 = select(0.0, 1.0, p1 < x);
    let f2 = select(0.0, 1.0, p2 < x);
    // The quadratic through the three points, and its mean: without and with what lies at x itself.
    let f0 = vec2f(0.0, 1.0);
    let f01 = (f1 - f0) / (p1 - x);
    let f12 = (f2 - f1) / (p2 - p1);
    let f012 = (f12 - f01) / (p2 - x);
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
    let total = max(max(m0, moments.x * 0.0009765625), 1e-6);
    let mean = vec4f(m.yzw, extent.w - dot(place.taken, z2 * z2)) / total;
    // Moments of (zeta - near) * scale, 0 .. 1.
    let near = z.y;
    let scale = 1.0 / max(z.z - near, 2.0 / PEELNET_TOP);
    let s2 = scale * scale;
    let t1 = clamp((mean.x - near) * scale, 0.0, 1.0);
    let t2 = (mean.y - near * (2.0 * mean.x - near)) * s2;
    let t3 = (mean.z - near * (3.0 * mean.y - near * (3.0 * mean.x - near))) * scale * s2;
    let t4 = (mean.w - near * (4.0 * mean.z - near * (6.0 * mean.y - near * (4.0 * mean.x - near)))) * s2 * s2;
    let t = clamp((z.x - near) * scale, 0.0, 1.0);
    let variance = max(t2 - t1 * t1, 0.000244140625);
    let sigma = sqrt(variance);
    let wide = max(sigma, 0.125);
    let third = t3 - t1 * (3.0 * t2 - 2.0 * t1 * t1);
    // To -1 .. 1.
    let x = vec4f(
        2.0 * t1 - 1.0,
        4.0 * (t2 - t1) + 1.0,
        8.0 * t3 - 12.0 * t2 + 6.0 * t1 - 1.0,
        16.0 * t4 - 32.0 * t3 + 24.0 * t2 - 8.0 * t1 + 1.0,
    );
    let bounds = peelnet_moment_bounds(x, 2.0 * t - 1.0);
    return PeelnetFeatures(
        log(1.0 + m0),
        t,
        t1,
        clamp(0.5 * (t - t1) / sigma, -2.0, 2.0),
        clamp(0.5 * third / (wide * wide * wide), -2.0, 2.0),
        bounds.x,
        bounds.y,
        vec3f(t1, t2, t3),
    );
}
