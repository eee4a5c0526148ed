// The least and the most of a distribution on 0 .. 1 that can lie in front of x, given its first three moments, as shares.
// The extreme distribution has the points x, y and one of the ends (Krein & Nudelman 1977).
fn peelnet_interval_bounds(m: vec3f, x: f32) -> vec2f {
    let y0 = (m.z - x * m.y) / (m.y - x * m.x);
    let at_zero = y0 >= 0.0 && y0 <= 1.0;
    // Moments of t dm or of (1 - t) dm, whose points are x and y alone.
    let n = select(vec3f(1.0, m.xy) - m, m, at_zero);
    let y = select((n.z - x * n.y) / (n.y - x * n.x), y0, at_zero);
    let at = (n.y - y * n.x) / ((x - y) * select(1.0 - x, x, at_zero));
    let other = (n.y - x * n.x) / ((y - x) * select(1.0 - y, y, at_zero));
    let low = select(0.0, 1.0 - at - other, at_zero) + select(0.0, other, y < x);
    let share = vec2f(low, low + at);
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}
