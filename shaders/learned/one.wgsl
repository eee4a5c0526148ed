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
