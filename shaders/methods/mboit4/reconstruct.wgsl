// Transmittance in front of a warped depth from four power moments (Muenstermann et al. 2018); the steps are explained
// in the twin, peelnet_core::methods::mboit4.
import package::parameters::{BIAS, OVERESTIMATION};

fn transmittance_from_moments(total: f32, higher: vec4f, zeta: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    let m = mix(higher * (1.0 / total), vec4f(0.0, 0.375, 0.0, 0.375), BIAS);
    let variance = m.y - m.x * m.x;
    let l21_variance = m.z - m.x * m.y;
    let inverse_variance = 1.0 / variance;
    let l21 = l21_variance * inverse_variance;
    let d22 = m.w - m.y * m.y - l21_variance * l21;
    let y1 = zeta - m.x;
    let y2 = zeta * zeta - m.y - l21 * y1;
    let c2 = y2 / d22;
    let c1 = y1 * inverse_variance - l21 * c2;
    let c0 = 1.0 - m.x * c1 - m.y * c2;
    let inverse_c2 = 1.0 / c2;
    let half_p = 0.5 * c1 * inverse_c2;
    let root = sqrt(max(half_p * half_p - c0 * inverse_c2, 0.0));
    let z1 = -half_p - root;
    let z2 = -half_p + root;
    let f1 = select(0.0, 1.0, z1 < zeta);
    let f2 = select(0.0, 1.0, z2 < zeta);
    let f01 = (f1 - OVERESTIMATION) / (z1 - zeta);
    let f12 = (f2 - f1) / (z2 - z1);
    let f012 = (f12 - f01) / (z2 - zeta);
    let a0 = OVERESTIMATION - zeta * (f01 - f012 * z1);
    let a1 = f01 - f012 * (z1 + zeta);
    let share = a0 + a1 * m.x + f012 * m.y;
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
