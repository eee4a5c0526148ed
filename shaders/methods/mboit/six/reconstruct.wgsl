// Transmittance in front of a warped depth from six power moments (Muenstermann et al. 2018); the steps are explained in
// the CPU reference, peelnet_core::methods::moments::power.
// Loops: 1: a constant.
import package::parameters::{BIAS, OVERESTIMATION};

// Pivots and multipliers of the Hankel matrix of moments.
struct Factors {
    inverse_pivots: vec3f,
    l32: f32,
    l42: f32,
    l43: f32,
    mean: vec3f,
}

fn residuals(f: Factors, t: f32) -> vec3f {
    let y1 = t - f.mean.x;
    let y2 = t * t - f.mean.y - f.l32 * y1;
    return vec3f(y1, y2, t * t * t - f.mean.z - f.l42 * y1 - f.l43 * y2);
}

// What the extreme measure has at one of its points.
fn mass(f: Factors, t: f32) -> f32 {
    let y = residuals(f, t);
    return 1.0 / (1.0 + dot(y * y, f.inverse_pivots));
}

fn transmittance_from_moments(total: f32, m1234: vec4f, m56: vec2f, zeta: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    let m = mix(m1234 / total, vec4f(0.0, 0.48, 0.0, 0.451), BIAS);
    let n = mix(m56 / total, vec2f(0.0, 0.45), BIAS);
    let d2 = m.y - m.x * m.x;
    let l32 = (m.z - m.x * m.y) / d2;
    let l42 = (m.w - m.x * m.z) / d2;
    let d3 = m.w - m.y * m.y - l32 * l32 * d2;
    let l43 = (n.x - m.y * m.z - l32 * l42 * d2) / d3;
    let d4 = n.y - m.z * m.z - l42 * l42 * d2 - l43 * l43 * d3;
    let f = Factors(1.0 / vec3f(d2, d3, d4), l32, l42, l43, m.xyz);
    let y = residuals(f, zeta);
    let scaled = y * f.inverse_pivots;
    let c3 = scaled.z;
    let c2 = scaled.y - l43 * c3;
    let c1 = scaled.x - l32 * c2 - l42 * c3;
    let c0 = 1.0 - dot(m.xyz, vec3f(c1, c2, c3));
    // The roots, or one over them where that keeps them finite.
    let reversed = abs(c0) > abs(c3);
    let inverse = 1.0 / select(c3, c0, reversed);
    let a = select(c2, c1, reversed) * inverse;
    let b = select(c1, c2, reversed) * inverse;
    let c = select(c0, c3, reversed) * inverse;
    let q = max(a * a / 9.0 - b / 3.0, 1e-30);
    let r = (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0;
    let angle = acos(clamp(r / (q * sqrt(q)), -1.0, 1.0)) / 3.0;
    let third = 2.0943951;
    let roots = -2.0 * sqrt(q) * cos(angle + vec3f(0.0, third, -third)) - a / 3.0;
    var share = OVERESTIMATION / (1.0 + dot(y, scaled));
    for (var i = 0; i < 3; i++) {
        let root = select(roots[i], 1.0 / roots[i], reversed);
        let t = clamp(root, -1e4, 1e4);
        share += select(0.0, mass(f, t), t < zeta);
    }
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
