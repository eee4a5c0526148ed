// The least and the most of the rest that can lie in front of the fragment, given its first four moments, as shares
// (Muenstermann et al. 2018).
fn peelnet_moment_bounds(rest: PeelnetRest) -> vec2f {
    let x = rest.place;
    let m = mix(rest.means, vec4f(0.0, 0.375, 0.0, 0.375), rest.bias);
    // The kernel polynomial from the factors L D of the Hankel matrix, times all denominators: only its roots matter, and
    // its value at x, which is one over what lies at x itself.
    let variance = m.y - m.x * m.x;
    let third = m.z - m.x * m.y;
    let d = variance * (m.w - m.y * m.y) - third * third;
    let linear = x - m.x;
    let quadratic = (x * x - m.y) * variance - third * linear;
    let determinant = variance * d;
    let kc = quadratic * variance;
    let kb = linear * d - third * quadratic;
    let ka = determinant - m.x * kb - m.y * kc;
    // Divisors are kept from 0, and shares of noise from infinity: no real pixel has such.
    let whole = determinant + linear * linear * d + quadratic * quadratic;
    let own = clamp(determinant / select(whole, 1e-20, abs(whole) < 1e-20), -1e4, 1e4);
    // Its roots are the extreme measure's other points: the smaller one, and one over the larger, which may be infinite.
    let half = 0.5 * kb;
    let root = sqrt(max(half * half - ka * kc, 0.0));
    let inverse = select(1.0, -1.0, half >= 0.0) / max(abs(half) + root, 1e-20);
    let p = ka * inverse;
    let q = kc * inverse;
    // What lies at either.
    let apart = 1.0 - p * q;
    let at_p = clamp((1.0 - own - q * (m.x - own * x)) / select(apart, 1e-20, apart == 0.0), -1e4, 1e4);
    let at_q = 1.0 - own - at_p;
    let low = select(0.0, at_p, p < x) + select(0.0, at_q, (1.0 - x * q) * q < 0.0);
    return clamp(vec2f(low, low + own), vec2f(0.0), vec2f(1.0));
}
