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

// A finished pixel: its nearest fragment, and its sums without it.
struct PeelnetRest {
    nearest: PeelnetNearest,
    front: mat3x4f,
    back: mat3x4f,
}

fn peelnet_rest(
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
) -> PeelnetRest {
    let front = min(absorbances.xyz, vec3f(65504.0));
    let back = min(absorbances_back.xyz, vec3f(65504.0));
    let both = front + back;
    let colors = sum_a.rgb + sum_b.rgb + sum_c.rgb + sum_d.rgb + sum_e.rgb + sum_f.rgb;
    let all = vec4f(colors, both.x + both.y + both.z);
    let nearest = peelnet_nearest(vec4f(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all, quantiles, noise);
    let shares = peelnet_shares(nearest.place);
    return PeelnetRest(
        nearest,
        mat3x4f(
            peelnet_behind(sum_a.rgb, front.x, shares.front.x, nearest),
            peelnet_behind(sum_b.rgb, front.y, shares.front.y, nearest),
            peelnet_behind(sum_c.rgb, front.z, shares.front.z, nearest),
        ),
        mat3x4f(
            peelnet_behind(sum_d.rgb, back.x, shares.back.x, nearest),
            peelnet_behind(sum_e.rgb, back.y, shares.back.y, nearest),
            peelnet_behind(sum_f.rgb, back.z, shares.back.z, nearest),
        ),
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
    let r = peelnet_rest(
        sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise);
    let front = vec3f(r.front[0].w, r.front[1].w, r.front[2].w);
    let back = vec3f(r.back[0].w, r.back[1].w, r.back[2].w);
    let to_c = front.x + front.y;
    let to_d = to_c + front.z;
    let to_e = to_d + back.x;
    let to_f = to_e + back.y;
    let total = to_f + back.z;
    let seen = r.front[0] * peelnet_part(front.x, 0.0, 0.0, front.y, total, 0.0, r.nearest)
        + r.front[1] * peelnet_part(front.y, front.x, front.x, front.z, total, 0.2, r.nearest)
        + r.front[2] * peelnet_part(front.z, to_c, front.y, back.x, total, 0.4, r.nearest)
        + r.back[0] * peelnet_part(back.x, to_d, front.z, back.y, total, 0.6, r.nearest)
        + r.back[1] * peelnet_part(back.y, to_e, back.x, back.z, total, 0.8, r.nearest)
        + r.back[2] * peelnet_part(back.z, to_f, back.y, 0.0, total, 1.0, r.nearest);
    return peelnet_over_black(r.nearest, seen);
}

// What is seen behind the nearest fragment of a finished pixel, by sixteen bins of depth, for the quantiles of the next frame: by the formula,
// each sum taken as even between two places.
fn peelnet_last_seen(
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
) -> mat4x4f {
    let r = peelnet_rest(
        sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise);
    let front = vec3f(r.front[0].w, r.front[1].w, r.front[2].w);
    let back = vec3f(r.back[0].w, r.back[1].w, r.back[2].w);
    let seen = peelnet_seen_of(front, 0.0);
    let seen_back = peelnet_seen_of(back, dot(front, vec3f(1.0)));
    let scale = r.nearest.left / max(dot(seen + seen_back, vec3f(1.0)), 1.17549435e-38);
    let begins = vec3f(0.0, 0.25, 0.408);
    let begins_back = vec3f(0.576, 0.702, 0.848);
    let bins = peelnet_spread(seen * scale, begins, vec3f(0.25, 0.408, 0.576), quantiles);
    return bins + peelnet_spread(seen_back * scale, begins_back, vec3f(0.702, 0.848, 1.0), quantiles);
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
