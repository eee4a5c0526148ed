// Transmittance in front of a warped depth from eight power moments (Muenstermann et al. 2018); the steps are explained in the CPU reference,
// peelnet_core::methods::moments::power.
// Loops: 11: constants.
import package::methods::mboit::trigonometric::roots::quartic;
import package::parameters::{BIAS, OVERESTIMATION};

fn transmittance_from_moments(total: f32, m1234: vec4f, m5678: vec4f, zeta: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    let a = mix(m1234 / total, vec4f(0.0, 0.75, 0.0, 0.67666667), BIAS);
    let b = mix(m5678 / total, vec4f(0.0, 0.63, 0.0, 0.60030303), BIAS);
    var m = array<f32, 9>(1.0, a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w);
    // Factors L D of the Hankel matrix; rows of L one behind the other.
    var lower: array<f32, 25>;
    var pivots: array<f32, 5>;
    for (var j = 0; j < 5; j++) {
        var pivot = m[2 * j];
        for (var k = 0; k < j; k++) {
            pivot -= lower[5 * j + k] * lower[5 * j + k] * pivots[k];
        }
        pivots[j] = pivot;
        for (var i = j + 1; i < 5; i++) {
            var entry = m[i + j];
            for (var k = 0; k < j; k++) {
                entry -= lower[5 * i + k] * lower[5 * j + k] * pivots[k];
            }
            lower[5 * i + j] = entry / pivot;
        }
    }
    // The kernel at zeta: one over the mass there, and its coefficients.
    var c: array<f32, 5>;
    c[0] = 1.0;
    var squares = 1.0;
    var power = 1.0;
    for (var i = 1; i < 5; i++) {
        power *= zeta;
        var y = power;
        for (var k = 0; k < i; k++) {
            y -= lower[5 * i + k] * c[k];
        }
        c[i] = y;
        squares += y * y / pivots[i];
    }
    for (var i = 4; i >= 0; i--) {
        var entry = c[i] / pivots[i];
        for (var k = i + 1; k < 5; k++) {
            entry -= lower[5 * k + i] * c[k];
        }
        c[i] = entry;
    }
    // Its zeros, or one over them where that keeps them finite.
    let reversed = abs(c[0]) > abs(c[4]);
    let up = vec4f(c[0], c[1], c[2], c[3]);
    let down = vec4f(c[4], c[3], c[2], c[1]);
    let zeros = quartic(select(up, down, reversed), select(c[4], c[0], reversed));
    let points = clamp(select(zeros, 1.0 / zeros, vec4<bool>(reversed)), vec4f(-1e3), vec4f(1e3));
    var share = OVERESTIMATION / squares;
    for (var n = 0; n < 4; n++) {
        let t = points[n];
        var y: array<f32, 5>;
        y[0] = 1.0;
        var own = 1.0;
        var t_power = 1.0;
        for (var i = 1; i < 5; i++) {
            t_power *= t;
            var value = t_power;
            for (var k = 0; k < i; k++) {
                value -= lower[5 * i + k] * y[k];
            }
            y[i] = value;
            own += value * value / pivots[i];
        }
        share += select(0.0, 1.0 / own, t < zeta);
    }
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
