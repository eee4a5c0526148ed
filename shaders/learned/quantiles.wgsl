// Bins of depth, and levels of opacity in each, of the nearest fragment of a tile's pixel.
const PEELNET_TILE_DEPTHS: f32 = 240.0;
const PEELNET_TILE_OPACITIES: f32 = 256.0;

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
