// A divisor that is not 0.
fn peelnet_divisor(x: f32) -> f32 {
    return select(x, 1e-20, abs(x) < 1e-20);
}

// The same from three moments and that all of the rest lies between the ends. The extreme distribution has the points x, y and one
// of the ends (Krein & Nudelman 1977).
fn peelnet_interval_bounds(rest: PeelnetRest) -> vec2f {
    let x = rest.place;
    let m = rest.means.xyz;
    // Moments of (t + 1) dm, whose points are x and y alone if the end is -1.
    let low_end = vec3f(1.0, m.xy) + m;
    let y_low = (low_end.z - x * low_end.y) / peelnet_divisor(low_end.y - x * low_end.x);
    let at_low = y_low >= -1.0 && y_low <= 1.0;
    // Else those of (1 - t) dm.
    let n = select(vec3f(1.0, m.xy) - m, low_end, at_low);
    let y_any = select((n.z - x * n.y) / peelnet_divisor(n.y - x * n.x), y_low, at_low);
    let y = clamp(y_any, -1e10, 1e10);
    let at = (n.y - y * n.x) / peelnet_divisor((x - y) * select(1.0 - x, 1.0 + x, at_low));
    let other = (n.y - x * n.x) / peelnet_divisor((y - x) * select(1.0 - y, 1.0 + y, at_low));
    // What lies at either; only noise is as large as the limits.
    let here = clamp(at, -1e4, 1e4);
    let there = clamp(other, -1e4, 1e4);
    let low = select(0.0, 1.0 - here - there, at_low) + select(0.0, there, y < x);
    // Nothing lies in front of the near end.
    return select(clamp(vec2f(low, low + here), vec2f(0.0), vec2f(1.0)), vec2f(0.0), at_low && x <= -1.0);
}
