// Bins of depth, and levels of opacity in each, of the nearest fragment of a tile's pixel.
const PEELNET_TILE_DEPTHS: f32 = 240.0;
const PEELNET_TILE_OPACITIES: f32 = 256.0;
// Levels of depth, and of a value in each, that a pixel's nearest fragment is kept with.
const PEELNET_DEPTHS: f32 = 480.0;
const PEELNET_VALUES: f32 = 128.0;
// Levels of 8 bits that an absorbance of 1 is.
const PEELNET_BIN_LEVELS: f32 = 64.0;
// b / (1 + b) of the most absorbance.
const PEELNET_MOST: f32 = 0.941176471;

// What is known of how much lies in front of one of a pixel's sums.
struct PeelnetAhead {
    // By the formula.
    absorbance: f32,
    // Absorbance of all sums, and the shares of it in the sums before, in this one, and in those before and behind it.
    total: f32,
    before: f32,
    own: f32,
    previous: f32,
    next: f32,
    // Opacity of the nearest fragment, and where it lies among the quantiles.
    alpha: f32,
    place: f32,
    // 0 for the first sum, 1 for the last.
    number: f32,
}

struct PeelnetNearest {
    color: vec3f,
    absorbance: f32,
    place: f32,
    // Coverage of the pixel, the nearest fragment's part of it, and what is left for the sums.
    coverage: f32,
    alpha: f32,
    left: f32,
}

// The noise of a pixel, 0 .. 1: neighbours' lie far apart (Roberts 2018, the sequence R2).
fn peelnet_noise(pixel: vec2u) -> f32 {
    return f32((pixel.x * 12664746u + pixel.y * 9560334u) & 16777215u) * (1.0 / 16777216.0);
}

// The quantiles of a frame of which only near and far are known.
fn peelnet_even() -> vec4f {
    return vec4f(0.06, 0.35, 0.65, 0.94);
}

// A depth on a scale without two gaps in which no transparent surface lies, -1 .. 1 again. gaps: the ends of the nearer and of the farther one, as
// zeta; four times 1 where there is none. The same in all passes of a frame.
fn peelnet_cut(zeta: f32, gaps: vec4f) -> f32 {
    let lengths = gaps.yw - gaps.xz;
    let passed = clamp(vec2f(zeta) - gaps.xz, vec2f(0.0), lengths);
    let kept = zeta + 1.0 - passed.x - passed.y;
    return kept * (2.0 / (2.0 - lengths.x - lengths.y)) - 1.0;
}

// Where a depth, 0 .. 1 of the frame's, lies among quantiles, 0 .. 1.
fn peelnet_place_among(depth: f32, quantiles: vec4f) -> f32 {
    let begin = vec4f(0.0, quantiles.xyz);
    let parts = clamp((vec4f(depth) - begin) / max(quantiles - begin, vec4f(1e-4)), vec4f(0.0), vec4f(1.0));
    let last = clamp((depth - quantiles.w) / max(1.0 - quantiles.w, 1e-4), 0.0, 1.0);
    return dot(parts, vec4f(0.06, 0.29, 0.3, 0.29)) + 0.06 * last;
}

// An absorbance's level, shared between four bins from a first one, in whole levels.
fn peelnet_in_bins(level: f32, depth: f32, first: f32) -> vec4f {
    let place = clamp(depth * 16.0 - 0.5, 0.0, 15.0) - first;
    let shares = max(vec4f(1.0) - abs(vec4f(place) - vec4f(0.0, 1.0, 2.0, 3.0)), vec4f(0.0));
    return floor(level * shares + 0.5);
}

fn peelnet_level(absorbance: f32) -> f32 {
    // At least one: a bin with any fragment is not empty.
    return max(floor(absorbance * PEELNET_BIN_LEVELS + 0.5), 1.0);
}

// What a fragment adds to the bins of its tile, of 8 bits: four in a column, nearest first.
fn peelnet_tile_bins(alpha: f32, zeta: f32) -> mat4x4f {
    let level = peelnet_level(peelnet_absorbance(alpha));
    let depth = 0.5 * zeta + 0.5;
    return mat4x4f(
        peelnet_in_bins(level, depth, 0.0) / 255.0,
        peelnet_in_bins(level, depth, 4.0) / 255.0,
        peelnet_in_bins(level, depth, 8.0) / 255.0,
        peelnet_in_bins(level, depth, 12.0) / 255.0,
    );
}

// What a fragment writes as the nearest of its tile's pixel, where the most is kept.
fn peelnet_tile_nearest(alpha: f32, zeta: f32) -> f32 {
    let b = peelnet_absorbance(alpha);
    let bin = min(floor((0.5 * zeta + 0.5) * PEELNET_TILE_DEPTHS), PEELNET_TILE_DEPTHS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (PEELNET_TILE_OPACITIES - 1.0)) + 0.5);
    return peelnet_halves(vec3f((PEELNET_TILE_DEPTHS - 1.0 - bin) * PEELNET_TILE_OPACITIES + opacity)).x;
}

// Of four bins what is seen behind the nearest fragment. front: the levels of all bins before them.
fn peelnet_seen(bins: vec4f, taken: vec4f, front: f32) -> vec4f {
    let two = bins.x + bins.y;
    let before = vec4f(front) + vec4f(0.0, bins.x, two, two + bins.z);
    let seen = exp(before * (-1.0 / PEELNET_BIN_LEVELS)) - exp((before + bins) * (-1.0 / PEELNET_BIN_LEVELS));
    return seen * max(bins - taken, vec4f(0.0)) / max(bins, vec4f(1.0));
}

// What is seen in a tile's pixel behind its nearest fragment. bins, nearest: as the targets hold them.
fn peelnet_tile_seen(bins: mat4x4f, nearest: f32) -> mat4x4f {
    let a = floor(bins[0] * 255.0 + 0.5);
    let b = floor(bins[1] * 255.0 + 0.5);
    let c = floor(bins[2] * 255.0 + 0.5);
    let d = floor(bins[3] * 255.0 + 0.5);
    let level = max(peelnet_levels(vec3f(nearest)).x, 0.0);
    let back = floor(level * (1.0 / PEELNET_TILE_OPACITIES));
    let opacity = (level - back * PEELNET_TILE_OPACITIES) * (1.0 / (PEELNET_TILE_OPACITIES - 1.0));
    let depth = (PEELNET_TILE_DEPTHS - back - 0.5) / PEELNET_TILE_DEPTHS;
    let taken = peelnet_level(opacity / (1.0625 - opacity));
    let to_b = dot(a, vec4f(1.0));
    let to_c = to_b + dot(b, vec4f(1.0));
    let to_d = to_c + dot(c, vec4f(1.0));
    return mat4x4f(
        peelnet_seen(a, peelnet_in_bins(taken, depth, 0.0), 0.0),
        peelnet_seen(b, peelnet_in_bins(taken, depth, 4.0), to_b),
        peelnet_seen(c, peelnet_in_bins(taken, depth, 8.0), to_c),
        peelnet_seen(d, peelnet_in_bins(taken, depth, 12.0), to_d),
    );
}

// How many of four bins lie before a share. before: what the bins before them hold.
fn peelnet_passed(share: f32, before: f32, bins: vec4f) -> f32 {
    let two = bins.x + bins.y;
    let begin = vec4f(before) + vec4f(0.0, bins.x, two, two + bins.z);
    return dot(clamp((vec4f(share) - begin) / max(bins, vec4f(1e-9)), vec4f(0.0), vec4f(1.0)), vec4f(1.0));
}

// The quantiles of what is seen in nine pixels together.
fn peelnet_quantiles(seen: mat4x4f) -> vec4f {
    // Evenly spread where nothing is known.
    let a = seen[0] + 0.00125;
    let b = seen[1] + 0.00125;
    let c = seen[2] + 0.00125;
    let d = seen[3] + 0.00125;
    let to_b = dot(a, vec4f(1.0));
    let to_c = to_b + dot(b, vec4f(1.0));
    let to_d = to_c + dot(c, vec4f(1.0));
    let shares = peelnet_even() * (to_d + dot(d, vec4f(1.0)));
    let first = peelnet_passed(shares.x, 0.0, a) + peelnet_passed(shares.x, to_b, b)
        + peelnet_passed(shares.x, to_c, c) + peelnet_passed(shares.x, to_d, d);
    let second = peelnet_passed(shares.y, 0.0, a) + peelnet_passed(shares.y, to_b, b)
        + peelnet_passed(shares.y, to_c, c) + peelnet_passed(shares.y, to_d, d);
    let third = peelnet_passed(shares.z, 0.0, a) + peelnet_passed(shares.z, to_b, b)
        + peelnet_passed(shares.z, to_c, c) + peelnet_passed(shares.z, to_d, d);
    let fourth = peelnet_passed(shares.w, 0.0, a) + peelnet_passed(shares.w, to_b, b)
        + peelnet_passed(shares.w, to_c, c) + peelnet_passed(shares.w, to_d, d);
    return vec4f(first, second, third, fourth) * 0.0625;
}

// Values without bound in 0 .. 1, in even steps of a root, and back.
fn peelnet_to_unit(values: vec4f) -> vec4f {
    let kept = max(values, vec4f(0.0));
    return sqrt(min(kept / (vec4f(1.0) + kept) * (1.0 / PEELNET_MOST), vec4f(1.0)));
}

fn peelnet_from_unit(units: vec4f) -> vec4f {
    let shares = units * units * PEELNET_MOST;
    return shares / (vec4f(1.0) - shares);
}

// What a fragment writes as its pixel's nearest: red, green, blue and absorbance, each behind its depth, where the most is kept.
fn peelnet_record(b: f32, rgb: vec3f, depth: f32, place: f32, noise: f32) -> vec4f {
    let bin = clamp(floor(0.5 * (depth + place) * PEELNET_DEPTHS), 0.0, PEELNET_DEPTHS - 1.0);
    let top = PEELNET_VALUES - 1.0;
    let values = min(floor(peelnet_to_unit(vec4f(rgb, b)) * top + noise), vec4f(top));
    let levels = values + (PEELNET_DEPTHS - 1.0 - bin) * PEELNET_VALUES;
    return vec4f(peelnet_halves(levels.xyz), peelnet_halves(levels.www).x);
}

// The nearest fragment. halves: as the targets hold it. sums: of all sums red, green, blue and absorbance.
fn peelnet_nearest(halves: vec4f, sums: vec4f, quantiles: vec4f, noise: f32) -> PeelnetNearest {
    let levels = max(vec4f(peelnet_levels(halves.xyz), peelnet_levels(halves.www).x), vec4f(0.0));
    let back = floor(levels * (1.0 / PEELNET_VALUES));
    let top = PEELNET_VALUES - 1.0;
    let steps = levels - back * PEELNET_VALUES + (0.5 - noise);
    let units = clamp(steps / top, vec4f(0.0), vec4f(1.0));
    let values = peelnet_from_unit(units);
    let on_scale = (PEELNET_DEPTHS - back.w - 0.5) / PEELNET_DEPTHS;
    let place = peelnet_place_among(on_scale, 0.5 * (quantiles + peelnet_even()));
    let one = 1.0 + values.w;
    let slack = 2.0 * peelnet_to_unit(values.wwww).x * PEELNET_MOST * one * one / top;
    // All there is, as far as roundings can tell: its colour is the mean.
    let alone = sums.w - values.w <= slack + sums.w * 0.0009765625;
    let color = select(values.xyz, sums.xyz / max(sums.w, 1e-6), alone);
    let absorbance = select(values.w, sums.w, alone);
    let coverage = 1.0 - exp(-sums.w);
    let alpha = min(1.0 - exp(-absorbance), coverage);
    return PeelnetNearest(color, absorbance, place, coverage, alpha, coverage - alpha);
}

// A sum without the nearest fragment: red, green, blue and absorbance.
fn peelnet_behind(rgb: vec3f, b: f32, share: f32, nearest: PeelnetNearest) -> vec4f {
    let taken = nearest.absorbance * share;
    return vec4f(max(min(rgb, vec3f(65504.0)) - taken * nearest.color, vec3f(0.0)), max(b - taken, 0.0));
}

// What an even mixture of some absorbance has in front of itself: log(b / (1 - exp(-b))).
fn peelnet_inside(b: f32) -> f32 {
    let some = max(b, 0.02);
    return select(log(some / (1.0 - exp(-some))), b * (0.5 - b / 24.0), b < 0.02);
}

// How much of a sum is seen. before, previous, next: absorbances of the sums before, of the one before and of the one behind.
fn peelnet_part(own: f32, before: f32, previous: f32, next: f32, total: f32, number: f32, nearest: PeelnetNearest) -> f32 {
    let ahead = before + peelnet_inside(own);
    let scale = 1.0 / max(total, 1e-6);
    let known = PeelnetAhead(
        ahead,
        total,
        before * scale,
        own * scale,
        previous * scale,
        next * scale,
        nearest.alpha,
        nearest.place,
        number,
    );
    return exp(-2.0 * ahead * peelnet_network(known));
}

// The pixel's colour over black, and its coverage. seen: of all sums what is seen of red, green, blue and absorbance.
fn peelnet_over_black(nearest: PeelnetNearest, seen: vec4f) -> vec4f {
    let rest = select(nearest.color, seen.rgb / max(seen.a, 1.17549435e-38), seen.a > 0.0);
    return vec4f(nearest.alpha * nearest.color + nearest.left * rest, nearest.coverage);
}
