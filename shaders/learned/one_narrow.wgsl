struct PeelnetStatistics {
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    absorbances: vec4f,
}

// How a fragment at a place among the quantiles is shared between the sums.
fn peelnet_shares(place: f32) -> vec3f {
    let off = (vec3f(place) - vec3f(0.224, 0.485, 1.028)) * (1.0 / vec3f(0.158, 0.168, 0.191));
    let bumps = exp(-0.5 * off * off);
    return bumps * (1.0 / (bumps.x + bumps.y + bumps.z));
}

// What a fragment writes.
fn peelnet_statistics(alpha: f32, rgb: vec3f, zeta: f32, quantiles: vec4f, noise: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let depth = 0.5 * zeta + 0.5;
    let place = peelnet_place_among(depth, quantiles);
    let record = peelnet_record(b, rgb, depth, place, noise);
    let shares = b * peelnet_shares(place);
    return PeelnetStatistics(
        vec4f(rgb * shares.x, record.x),
        vec4f(rgb * shares.y, record.y),
        vec4f(rgb * shares.z, record.z),
        vec4f(shares, record.w),
    );
}

// The colour of a pixel over black, and its coverage.
fn peelnet_pixel(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> vec4f {
    let b = min(absorbances.xyz, vec3f(65504.0));
    let all = vec4f(sum_a.rgb + sum_b.rgb + sum_c.rgb, b.x + b.y + b.z);
    let nearest = peelnet_nearest(vec4f(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all, quantiles, noise);
    let shares = peelnet_shares(nearest.place);
    let first = peelnet_behind(sum_a.rgb, b.x, shares.x, nearest);
    let second = peelnet_behind(sum_b.rgb, b.y, shares.y, nearest);
    let third = peelnet_behind(sum_c.rgb, b.z, shares.z, nearest);
    let two = first.w + second.w;
    let total = two + third.w;
    let seen = first * peelnet_part(first.w, 0.0, 0.0, second.w, total, 0.0, nearest)
        + second * peelnet_part(second.w, first.w, first.w, third.w, total, 0.5, nearest)
        + third * peelnet_part(third.w, two, second.w, 0.0, total, 1.0, nearest);
    return peelnet_over_black(nearest, seen);
}

// The colour and coverage of a pixel.
fn peelnet_resolve(
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    absorbances: vec4f,
    quantiles: vec4f,
    noise: f32,
    background: vec3f,
) -> vec4f {
    let pixel = peelnet_pixel(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    return vec4f(pixel.rgb + (1.0 - pixel.a) * background, pixel.a);
}
