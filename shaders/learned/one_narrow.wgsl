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

// A finished pixel: its nearest fragment, and its sums without it.
struct PeelnetRest {
    nearest: PeelnetNearest,
    first: vec4f,
    second: vec4f,
    third: vec4f,
}

fn peelnet_rest(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> PeelnetRest {
    let b = min(absorbances.xyz, vec3f(65504.0));
    let all = vec4f(sum_a.rgb + sum_b.rgb + sum_c.rgb, b.x + b.y + b.z);
    let nearest = peelnet_nearest(vec4f(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all, quantiles, noise);
    let shares = peelnet_shares(nearest.place);
    return PeelnetRest(
        nearest,
        peelnet_behind(sum_a.rgb, b.x, shares.x, nearest),
        peelnet_behind(sum_b.rgb, b.y, shares.y, nearest),
        peelnet_behind(sum_c.rgb, b.z, shares.z, nearest),
    );
}

// The colour of a pixel over black, and its coverage.
fn peelnet_pixel(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> vec4f {
    let r = peelnet_rest(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    let two = r.first.w + r.second.w;
    let total = two + r.third.w;
    let seen = r.first * peelnet_part(r.first.w, 0.0, 0.0, r.second.w, total, 0.0, r.nearest)
        + r.second * peelnet_part(r.second.w, r.first.w, r.first.w, r.third.w, total, 0.5, r.nearest)
        + r.third * peelnet_part(r.third.w, two, r.second.w, 0.0, total, 1.0, r.nearest);
    return peelnet_over_black(r.nearest, seen);
}

// What is seen behind the nearest fragment of a finished pixel, by sixteen bins of depth, for the quantiles of the next frame: by the formula,
// each sum taken as even between two places.
fn peelnet_last_seen(sum_a: vec4f, sum_b: vec4f, sum_c: vec4f, absorbances: vec4f, quantiles: vec4f, noise: f32) -> mat4x4f {
    let r = peelnet_rest(sum_a, sum_b, sum_c, absorbances, quantiles, noise);
    let b = vec3f(r.first.w, r.second.w, r.third.w);
    let seen = peelnet_seen_of(b, 0.0);
    let scale = r.nearest.left / max(dot(seen, vec3f(1.0)), 1.17549435e-38);
    let begins = vec3f(0.0, 0.345, 0.738);
    return peelnet_spread(seen * scale, begins, vec3f(0.345, 0.738, 1.0), quantiles);
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
