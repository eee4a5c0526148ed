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
