// How many half standard deviations the fragment lies behind the rest's mean, and half the rest's skewness, each in -2 .. 2.
fn peelnet_shape(rest: PeelnetRest) -> vec2f {
    let m = rest.means.xyz;
    let sigma = sqrt(max(m.y - m.x * m.x, 0.0009765625));
    let wide = max(sigma, 0.25);
    let third = m.z - m.x * (3.0 * m.y - 2.0 * m.x * m.x);
    return clamp(0.5 * vec2f((rest.place - m.x) / sigma, third / (wide * wide * wide)), vec2f(-2.0), vec2f(2.0));
}
