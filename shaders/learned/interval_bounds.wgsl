// The least and the most of a distribution on -1 .. 1 that can lie in front of x, given its first three moments, as shares.
// The extreme distribution has the points x, y and one of the ends (Krein & Nudelman 1977).
fn peelnet_interval_bounds(m: vec3f, x: f32) -> vec2f {
    // Moments of (t + 1) dm, whose points are x and y alone if the end is -1.
    let low_end = vec3f(1.0, m.xy) + m;
    let y0 = (low_end.z - x * low_end.y) / (low_end.y - x * low_end.x);
    let at_low = y0 >= -1.0 && y0 <= 1.0;
    // Else those of (1 - t) dm.
    let n = select(vec3f(1.0, m.xy) - m, low_end, at_low);
    let y = select((n.z - x * n.y) / (n.y - x * n.x), y0, at_low);
    let at = (n.y - y * n.x) / ((x - y) * select(1.0 - x, 1.0 + x, at_low));
    let other = (n.y - x * n.x) / ((y - x) * select(1.0 - y, 1.0 + y, at_low));
    let low = select(0.0, 1.0 - at - other, at_low) + select(0.0, other, y < x);
    let share = vec2f(low, low + at);
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}

// How many half standard deviations x lies behind the mean, and half the skewness, each in -2 .. 2.
fn peelnet_shape(m: vec3f, x: f32) -> vec2f {
    let sigma = sqrt(max(m.y - m.x * m.x, 0.0009765625));
    let wide = max(sigma, 0.25);
    let third = m.z - m.x * (3.0 * m.y - 2.0 * m.x * m.x);
    return clamp(0.5 * vec2f((x - m.x) / sigma, third / (wide * wide * wide)), vec2f(-2.0), vec2f(2.0));
}
