struct PeelnetStatistics {
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    sum_d: vec4f,
    sum_e: vec4f,
    sum_f: vec4f,
    absorbances: vec4f,
    absorbances_back: vec4f,
}

// How a fragment at a place among the quantiles is shared between the sums.
struct PeelnetShares {
    front: vec3f,
    back: vec3f,
}

fn peelnet_shares(place: f32) -> PeelnetShares {
    let off_front = (vec3f(place) - vec3f(0.199, 0.315, 0.495)) * (1.0 / vec3f(0.069, 0.074, 0.072));
    let off_back = (vec3f(place) - vec3f(0.635, 0.784, 0.948)) * (1.0 / vec3f(0.058, 0.068, 0.093));
    let front = exp(-0.5 * off_front * off_front);
    let back = exp(-0.5 * off_back * off_back);
    let all = front + back;
    let scale = 1.0 / (all.x + all.y + all.z);
    return PeelnetShares(front * scale, back * scale);
}

// What a fragment writes.
fn peelnet_statistics(alpha: f32, rgb: vec3f, zeta: f32, quantiles: vec4f, noise: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let depth = 0.5 * zeta + 0.5;
    let place = peelnet_place_among(depth, quantiles);
    let record = peelnet_record(b, rgb, depth, place, noise);
    let shares = peelnet_shares(place);
    let front = b * shares.front;
    let back = b * shares.back;
    return PeelnetStatistics(
        vec4f(rgb * front.x, record.x),
        vec4f(rgb * front.y, record.y),
        vec4f(rgb * front.z, record.z),
        vec4f(rgb * back.x, -65504.0),
        vec4f(rgb * back.y, -65504.0),
        vec4f(rgb * back.z, -65504.0),
        vec4f(front, record.w),
        vec4f(back, -65504.0),
    );
}

// The colour of a pixel over black, and its coverage.
fn peelnet_pixel(
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    sum_d: vec4f,
    sum_e: vec4f,
    sum_f: vec4f,
    absorbances: vec4f,
    absorbances_back: vec4f,
    quantiles: vec4f,
    noise: f32,
) -> vec4f {
    let front = min(absorbances.xyz, vec3f(65504.0));
    let back = min(absorbances_back.xyz, vec3f(65504.0));
    let both = front + back;
    let colors = sum_a.rgb + sum_b.rgb + sum_c.rgb + sum_d.rgb + sum_e.rgb + sum_f.rgb;
    let all = vec4f(colors, both.x + both.y + both.z);
    let nearest = peelnet_nearest(vec4f(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all, quantiles, noise);
    let shares = peelnet_shares(nearest.place);
    let a = peelnet_behind(sum_a.rgb, front.x, shares.front.x, nearest);
    let b = peelnet_behind(sum_b.rgb, front.y, shares.front.y, nearest);
    let c = peelnet_behind(sum_c.rgb, front.z, shares.front.z, nearest);
    let d = peelnet_behind(sum_d.rgb, back.x, shares.back.x, nearest);
    let e = peelnet_behind(sum_e.rgb, back.y, shares.back.y, nearest);
    let f = peelnet_behind(sum_f.rgb, back.z, shares.back.z, nearest);
    let to_c = a.w + b.w;
    let to_d = to_c + c.w;
    let to_e = to_d + d.w;
    let to_f = to_e + e.w;
    let total = to_f + f.w;
    let seen = a * peelnet_part(a.w, 0.0, 0.0, b.w, total, 0.0, nearest)
        + b * peelnet_part(b.w, a.w, a.w, c.w, total, 0.2, nearest)
        + c * peelnet_part(c.w, to_c, b.w, d.w, total, 0.4, nearest)
        + d * peelnet_part(d.w, to_d, c.w, e.w, total, 0.6, nearest)
        + e * peelnet_part(e.w, to_e, d.w, f.w, total, 0.8, nearest)
        + f * peelnet_part(f.w, to_f, e.w, 0.0, total, 1.0, nearest);
    return peelnet_over_black(nearest, seen);
}

// The colour and coverage of a pixel.
fn peelnet_resolve(
    sum_a: vec4f,
    sum_b: vec4f,
    sum_c: vec4f,
    sum_d: vec4f,
    sum_e: vec4f,
    sum_f: vec4f,
    absorbances: vec4f,
    absorbances_back: vec4f,
    quantiles: vec4f,
    noise: f32,
    background: vec3f,
) -> vec4f {
    let pixel = peelnet_pixel(
        sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise);
    return vec4f(pixel.rgb + (1.0 - pixel.a) * background, pixel.a);
}
