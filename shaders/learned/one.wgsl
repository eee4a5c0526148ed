// Bins of depth, and levels of opacity in each, of the nearest fragment of a tile's pixel.
const PEELNET_TILE_DEPTHS: f32 = 240.0;
const PEELNET_TILE_OPACITIES: f32 = 256.0;
// Levels of depth, and of a value in each, that a pixel's nearest fragment is kept with.
const PEELNET_DEPTHS: f32 = 480.0;
const PEELNET_VALUES: f32 = 128.0;
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

// Where a depth, 0 .. 1 of the frame's, lies among quantiles, 0 .. 1.
fn peelnet_place_among(depth: f32, quantiles: vec4f) -> f32 {
    let begin = vec4f(0.0, quantiles.xyz);
    let parts = clamp((vec4f(depth) - begin) / max(quantiles - begin, vec4f(1e-4)), vec4f(0.0), vec4f(1.0));
    let last = clamp((depth - quantiles.w) / max(1.0 - quantiles.w, 1e-4), 0.0, 1.0);
    return dot(parts, vec4f(0.06, 0.29, 0.3, 0.29)) + 0.06 * last;
}

// What a level adds to sixteen bins of depth: four in a column, nearest first.
fn peelnet_tile_levels(level: f32, depth: f32) -> mat4x4f {
    let place = clamp(depth * 16.0 - 0.5, 0.0, 15.0);
    return mat4x4f(
        peelnet_in_bins(level, place, 0.0),
        peelnet_in_bins(level, place, 4.0),
        peelnet_in_bins(level, place, 8.0),
        peelnet_in_bins(level, place, 12.0),
    );
}

// What a fragment adds to the bins of its tile, of 8 bits.
fn peelnet_tile_bins(alpha: f32, zeta: f32) -> mat4x4f {
    return peelnet_tile_levels(peelnet_level(peelnet_absorbance(alpha)), 0.5 * zeta + 0.5);
}

// What a fragment writes as the nearest of its tile's pixel, where the most is kept.
fn peelnet_tile_nearest(alpha: f32, zeta: f32) -> f32 {
    let b = peelnet_absorbance(alpha);
    let bin = min(floor((0.5 * zeta + 0.5) * PEELNET_TILE_DEPTHS), PEELNET_TILE_DEPTHS - 1.0);
    let opacity = floor(b / (b + 1.0) * (1.0625 * (PEELNET_TILE_OPACITIES - 1.0)) + 0.5);
    return peelnet_halves(vec3f((PEELNET_TILE_DEPTHS - 1.0 - bin) * PEELNET_TILE_OPACITIES + opacity)).x;
}

// What the columns of bins before each hold together.
fn peelnet_before(bins: mat4x4f) -> vec4f {
    let all = vec4f(1.0) * bins;
    return vec4f(0.0, all.x, all.x + all.y, all.x + all.y + all.z);
}

// Of four bins what is seen behind the nearest fragment. before: what all bins before them hold.
fn peelnet_seen(bins: vec4f, taken: vec4f, before: f32) -> vec4f {
    let through = peelnet_seen_behind(before, bins);
    let seen = vec4f(exp(before * (-255.0 / PEELNET_BIN_LEVELS)), through.xyz) - through;
    return seen * max(bins - taken, vec4f(0.0)) / max(bins, vec4f(1.0 / 255.0));
}

// What is seen in a tile's pixel behind its nearest fragment. bins, nearest: as the targets hold them.
fn peelnet_tile_seen(bins: mat4x4f, nearest: f32) -> mat4x4f {
    let level = max(peelnet_levels(vec3f(nearest)).x, 0.0);
    let back = floor(level * (1.0 / PEELNET_TILE_OPACITIES));
    let opacity = (level - back * PEELNET_TILE_OPACITIES) * (1.0 / (PEELNET_TILE_OPACITIES - 1.0));
    let depth = (PEELNET_TILE_DEPTHS - back - 0.5) / PEELNET_TILE_DEPTHS;
    let taken = peelnet_tile_levels(peelnet_level(opacity / (1.0625 - opacity)), depth);
    let before = peelnet_before(bins);
    return mat4x4f(
        peelnet_seen(bins[0], taken[0], before.x),
        peelnet_seen(bins[1], taken[1], before.y),
        peelnet_seen(bins[2], taken[2], before.z),
        peelnet_seen(bins[3], taken[3], before.w),
    );
}

// How many of four bins lie before a share. before: what the bins before them hold.
fn peelnet_passed(share: f32, before: f32, bins: vec4f) -> f32 {
    let two = bins.x + bins.y;
    let begin = vec4f(before) + vec4f(0.0, bins.x, two, two + bins.z);
    return dot(clamp((vec4f(share) - begin) / max(bins, vec4f(1e-9)), vec4f(0.0), vec4f(1.0)), vec4f(1.0));
}

// The depth before which a share of sixteen bins lies. before: as of peelnet_before.
fn peelnet_depth_at(share: f32, bins: mat4x4f, before: vec4f) -> f32 {
    let front = peelnet_passed(share, before.x, bins[0]) + peelnet_passed(share, before.y, bins[1]);
    return 0.0625 * (front + peelnet_passed(share, before.z, bins[2]) + peelnet_passed(share, before.w, bins[3]));
}

// The quantiles of what is seen in nine pixels together.
fn peelnet_quantiles(seen: mat4x4f) -> vec4f {
    // Evenly spread where nothing is known.
    let even = vec4f(0.00125);
    let bins = seen + mat4x4f(even, even, even, even);
    let before = peelnet_before(bins);
    let shares = peelnet_even() * (before.w + dot(bins[3], vec4f(1.0)));
    return vec4f(
        peelnet_depth_at(shares.x, bins, before),
        peelnet_depth_at(shares.y, bins, before),
        peelnet_depth_at(shares.z, bins, before),
        peelnet_depth_at(shares.w, bins, before),
    );
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

// What is seen of three sums by the formula. before: absorbance of the sums before them.
fn peelnet_seen_of(b: vec3f, before: f32) -> vec3f {
    let ahead = vec3f(before + peelnet_inside(b.x), before + b.x + peelnet_inside(b.y), before + b.x + b.y + peelnet_inside(b.z));
    return b * exp(-ahead);
}

// What three sums that are even between two places hold in front of four depths.
fn peelnet_until(depths: vec4f, seen: vec3f, begins: vec3f, ends: vec3f, quantiles: vec4f) -> vec4f {
    let scale = 1.0 / (ends - begins);
    return vec4f(
        dot(seen, clamp((vec3f(peelnet_place_among(depths.x, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.y, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.z, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
        dot(seen, clamp((vec3f(peelnet_place_among(depths.w, quantiles)) - begins) * scale, vec3f(0.0), vec3f(1.0))),
    );
}

// The same by sixteen bins of depth; as of peelnet_tile_seen.
fn peelnet_spread(seen: vec3f, begins: vec3f, ends: vec3f, quantiles: vec4f) -> mat4x4f {
    let depths = vec4f(0.0625, 0.125, 0.1875, 0.25);
    let a = peelnet_until(depths, seen, begins, ends, quantiles);
    let b = peelnet_until(depths + 0.25, seen, begins, ends, quantiles);
    let c = peelnet_until(depths + 0.5, seen, begins, ends, quantiles);
    let d = peelnet_until(depths + 0.75, seen, begins, ends, quantiles);
    return mat4x4f(a - vec4f(0.0, a.xyz), b - vec4f(a.w, b.xyz), c - vec4f(b.w, c.xyz), d - vec4f(c.w, d.xyz));
}

// The pixel's colour over black, and its coverage. seen: of all sums what is seen of red, green, blue and absorbance.
fn peelnet_over_black(nearest: PeelnetNearest, seen: vec4f) -> vec4f {
    let rest = select(nearest.color, seen.rgb / max(seen.a, 1.17549435e-38), seen.a > 0.0);
    return vec4f(nearest.alpha * nearest.color + nearest.left * rest, nearest.coverage);
}
