// Transmittance in front of a warped depth from eight power moments (Muenstermann et al. 2018); the steps are explained in the CPU reference,
// peelnet_core::methods::moments::power. Without arrays: these loops took five times the time.
import package::methods::mboit::trigonometric::roots::quartic;
import package::parameters::{BIAS, OVERESTIMATION};

fn transmittance_from_moments(total: f32, m1234: vec4f, m5678: vec4f, zeta: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    let m = mix(m1234 / total, vec4f(0.0, 0.75, 0.0, 0.67666667), BIAS);
    let n = mix(m5678 / total, vec4f(0.0, 0.63, 0.0, 0.60030303), BIAS);
    // Factors L D of the Hankel matrix.
    let d1 = m.y - m.x * m.x;
    let l1 = (vec3f(m.zw, n.x) - m.x * m.yzw) / d1;
    let d2 = m.w - m.y * m.y - l1.x * l1.x * d1;
    let l2 = (n.xy - m.y * m.zw - l1.x * l1.yz * d1) / d2;
    let d3 = n.y - m.z * m.z - l1.y * l1.y * d1 - l2.x * l2.x * d2;
    let l3 = (n.z - m.z * m.w - l1.y * l1.z * d1 - l2.x * l2.y * d2) / d3;
    let d4 = n.w - m.w * m.w - l1.z * l1.z * d1 - l2.y * l2.y * d2 - l3 * l3 * d3;
    let inverse_pivots = 1.0 / vec4f(d1, d2, d3, d4);
    // The kernel at zeta: one over the mass there, and its coefficients.
    let z2 = zeta * zeta;
    var y = vec4f(zeta, z2, z2 * zeta, z2 * z2) - m;
    y.y -= l1.x * y.x;
    y.z -= l1.y * y.x + l2.x * y.y;
    y.w -= l1.z * y.x + l2.y * y.y + l3 * y.z;
    var c = y * inverse_pivots;
    var share = OVERESTIMATION / (1.0 + dot(y, c));
    c.z -= l3 * c.w;
    c.y -= dot(l2, c.zw);
    c.x -= dot(l1, c.yzw);
    let c0 = 1.0 - dot(m, c);
    // Its zeros, or one over them where that keeps them finite.
    let reversed = abs(c0) > abs(c.w);
    let zeros = quartic(select(vec4f(c0, c.xyz), c.wzyx, reversed), select(c.w, c0, reversed));
    let t = clamp(select(zeros, 1.0 / zeros, vec4<bool>(reversed)), vec4f(-1e3), vec4f(1e3));
    // What the measure has at each of them.
    let t2 = t * t;
    let y1 = t - m.x;
    let y2 = t2 - m.y - l1.x * y1;
    let y3 = t2 * t - m.z - l1.y * y1 - l2.x * y2;
    let y4 = t2 * t2 - m.w - l1.z * y1 - l2.y * y2 - l3 * y3;
    let squares = mat4x4f(y1 * y1, y2 * y2, y3 * y3, y4 * y4) * inverse_pivots;
    share += dot(select(vec4f(0.0), 1.0 / (1.0 + squares), t < vec4f(zeta)), vec4f(1.0));
    // Degenerate points give NaN, which no comparison finds true.
    let transmittance = exp(-total * share);
    return select(1.0, min(transmittance, 1.0), transmittance >= 0.0);
}
