// Transmittance in front of a warped depth from four power moments (Muenstermann et al. 2018); the steps are explained
// in the CPU reference, four_moment_bounds of peelnet_core::methods::moments::power, whose products of pivots would be too small for 32 bits at the paper's bias:
// here they are divided out.
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
    let own = 1.0 / (1.0 + y1 * y1 * inverse_variance + y2 * c2);
    let half = 0.5 * c1;
    let root = sqrt(max(half * half - c0 * c2, 0.0));
    let inverse = -1.0 / (half + select(-root, root, half >= 0.0));
    let p = c0 * inverse;
    let q = c2 * inverse;
    let at_p = (1.0 - own - q * (m.x - own * zeta)) / (1.0 - p * q);
    let at_q = 1.0 - own - at_p;
    let low = select(0.0, at_p, p < zeta) + select(0.0, at_q, (1.0 - zeta * q) * q < 0.0);
    let share = low + OVERESTIMATION * own;
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
