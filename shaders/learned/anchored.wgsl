// Statistics pass: draw all transparent surfaces, in any order, into
//     moments  rgba16float (or rgba32float), cleared to 0, blending ONE, ONE, ADD;
//     extent   rgba16float, cleared to -65504, blending ONE, ONE, MAX;
// each fragment writing the fields of peelnet_statistics(alpha, zeta).
// zeta is depth on a logarithmic scale: with z the distance along the view axis, and near and far the range that the
// bounding boxes of the transparent objects in view span (clipped to the camera's),
//     zeta = clamp(2 * (log(z) - log(near)) / (log(far) - log(near)) - 1, -1, 1).
// Compute it with one function in both passes: the nearest and the farthest fragment are recognised by their zeta.

// Fragments of less opacity are composited, but are never a pixel's nearest or farthest.
const PEELNET_FAINT: f32 = 0.003921569;
// Levels of depth, less one.
const PEELNET_TOP: f32 = 61439.0;

struct PeelnetStatistics {
    // Absorbance b and b zeta, b zeta^2, b zeta^3: to be summed.
    moments: vec4f,
    // The nearest and the farthest depth, then each once more, coarsely, with its opacity: to be maximised.
    extent: vec4f,
    // b zeta^4: to be summed, by models that read it.
    fourth: f32,
}

struct PeelnetFeatures {
    // What peelnet_weight reads.
    log_absorbance: f32,
    depth_fraction: f32,
    mean_fraction: f32,
    depth_deviation: f32,
    skewness: f32,
    share_low: f32,
    share_high: f32,
    // 1 for the pixel's nearest fragment, 2 for its farthest, 0 between them.
    end: f32,
    // The fragment's weight but for what the network says: 1, exp(-others), or the nearest fragment's transmittance.
    known: f32,
    // Mean powers 1 to 3 of the rest's zeta, and the sum that they were divided by.
    means: vec4f,
    // Absorbance of the nearest and the farthest fragment where they are known, and their zeta.
    ends: vec4f,
}

// -log(1 - alpha), at most 16: opaque, but finite.
fn peelnet_absorbance(alpha: f32) -> f32 {
    return min(-log(1.0 - min(alpha, 0.99999994)), 16.0);
}

fn peelnet_level(zeta: f32) -> f32 {
    return floor((zeta * 0.5 + 0.5) * PEELNET_TOP + 0.5);
}

// Coarse depth, 240 bins, and opacity, 256 levels that are even in sqrt(1 - alpha): the bin times 256 and the level.
fn peelnet_end(alpha: f32, zeta: f32) -> vec2f {
    let bin = clamp(floor((zeta * 0.5 + 0.5) * 240.0), 0.0, 239.0);
    let level = floor((1.0 - sqrt(max(1.0 - alpha, 0.0))) * 255.0 + 0.5);
    return vec2f((239.0 - bin) * 256.0, bin * 256.0) + level;
}

// The half float that stands for a level: all normal halves in ascending order, so that MAX blending of 16-bit targets
// tells 61440 depths apart, evenly.
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
    let level = peelnet_level(zeta);
    let end = peelnet_end(alpha, zeta);
    // The nearest is kept as the maximum of levels counted from the far end.
    let extent = vec4f(
        peelnet_half(PEELNET_TOP - level),
        peelnet_half(level),
        peelnet_half(end.x),
        peelnet_half(end.y),
    );
    return PeelnetStatistics(
        b * vec4f(1.0, zeta, z2, z2 * zeta),
        select(extent, vec4f(-65504.0), alpha < PEELNET_FAINT),
        b * z2 * z2,
    );
}

// The absorbance of an end, from its level.
fn peelnet_end_absorbance(level: f32) -> f32 {
    let through = 1.0 - (level - 256.0 * floor(level / 256.0)) / 255.0;
    return min(-2.0 * log(max(through, 1e-30)), 16.0);
}

// The least and the most of a distribution on 0 .. 1 that can lie in front of x, from its first three moments: the
// extreme one has the points x, y and one of the ends.
fn peelnet_interval_bounds(m: vec3f, x: f32) -> vec2f {
    let y0 = (m.z - x * m.y) / (m.y - x * m.x);
    let at_zero = y0 >= 0.0 && y0 <= 1.0;
    // Moments of t dm or of (1 - t) dm, whose points are x and y alone.
    let n = select(vec3f(1.0, m.xy) - m, m, at_zero);
    let y = select((n.z - x * n.y) / (n.y - x * n.x), y0, at_zero);
    let at = (n.y - y * n.x) / ((x - y) * select(1.0 - x, x, at_zero));
    let other = (n.y - x * n.x) / ((y - x) * select(1.0 - y, y, at_zero));
    let low = select(0.0, 1.0 - at - other, at_zero) + select(0.0, other, y < x);
    let share = vec2f(low, low + at);
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}

// Features of a fragment from its pixel's statistics, its own share and the known ends taken out.
fn peelnet_features(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> PeelnetFeatures {
    let b = peelnet_absorbance(alpha);
    let level = peelnet_level(zeta);
    let first = PEELNET_TOP - peelnet_level_of_half(extent.x);
    let last = peelnet_level_of_half(extent.y);
    let near = first / PEELNET_TOP * 2.0 - 1.0;
    let far = last / PEELNET_TOP * 2.0 - 1.0;
    // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a more
    // opaque one in the same bin), stays with the rest.
    let own_end = peelnet_end(alpha, zeta);
    let near_end = peelnet_level_of_half(extent.z);
    let far_end = peelnet_level_of_half(extent.w);
    let front = select(0.0, peelnet_end_absorbance(near_end), level > first && own_end.x != near_end);
    let back = select(0.0, peelnet_end_absorbance(far_end), level < last && own_end.y != far_end);
    let z = vec3f(zeta, near, far);
    let taken = vec3f(b, front, back);
    let z2 = z * z;
    let m = moments - vec4f(b + front + back, dot(taken, z), dot(taken, z2), dot(taken, z2 * z));
    let m0 = max(m.x, 0.0);
    let scale = PEELNET_TOP / (2.0 * max(last - first, 1.0));
    // Where the rest is no more than the rounding of 16-bit sums, its moments are noise.
    let total = max(max(m0, moments.x * 0.0009765625), 1e-6);
    let mean = m.yzw / total;
    // Moments of (zeta - near) * scale.
    let t1 = clamp((mean.x - near) * scale, 0.0, 1.0);
    let t2 = (mean.y - near * (2.0 * mean.x - near)) * scale * scale;
    let t3 = (mean.z - near * (3.0 * mean.y - near * (3.0 * mean.x - near))) * scale * scale * scale;
    let t = clamp((zeta - near) * scale, 0.0, 1.0);
    let variance = max(t2 - t1 * t1, 0.000244140625);
    let sigma = sqrt(variance);
    let wide = max(sigma, 0.125);
    let third = t3 - t1 * (3.0 * t2 - 2.0 * t1 * t1);
    // Two passes may round one zeta to neighbouring levels.
    let at_end = select(select(0.0, 2.0, level >= last - 1.0), 1.0, level <= first + 1.0);
    let end = select(at_end, 0.0, alpha < PEELNET_FAINT);
    let others = max(moments.x - b, 0.0);
    let known = select(select(exp(-front), exp(-others), end == 2.0), 1.0, end == 1.0);
    let bounds = peelnet_interval_bounds(vec3f(t1, t2, t3), t);
    return PeelnetFeatures(
        log(1.0 + m0),
        t,
        t1,
        clamp(0.5 * (t - t1) / sigma, -2.0, 2.0),
        clamp(0.5 * third / (wide * wide * wide), -2.0, 2.0),
        bounds.x,
        bounds.y,
        end,
        known,
        vec4f(mean, total),
        vec4f(front, back, near, far),
    );
}
