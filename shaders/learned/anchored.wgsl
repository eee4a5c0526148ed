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
