// Transmittance in front of an angle from trigonometric moments (Muenstermann et al. 2018, supplement); the steps are explained in the
// CPU reference, peelnet_core::methods::moments::trigonometric.
// Loops: 8: MOMENTS, at most 4.
import package::methods::mboit::trigonometric::circle::{WRAPPING_ZONE, conjugate, times, turn};
import package::methods::mboit::trigonometric::roots::{cubic, quadratic};
import package::parameters::{BIAS, MOMENTS, OVERESTIMATION};

// How much of a point counts as in front of phi; it is x = cot(angle / 2) from there.
fn front(x: f32, phi: f32) -> f32 {
    let theta = phi + 2.0 * atan2(1.0, x);
    let wrapped = max((theta - (6.2831853 - WRAPPING_ZONE)) / WRAPPING_ZONE, 0.0);
    return min(wrapped, 1.0);
}

// Zeros of the kernel as cot(angle / 2).
fn other_points(kernel: array<vec2f, 5>) -> vec4f {
    let a = vec2f(kernel[0].x, kernel[1].x);
    let b = vec2f(kernel[0].y, kernel[1].y);
    if MOMENTS == 2 {
        return vec4f(quadratic(vec3f(a.y - 2.0 * a.x, 4.0 * b.x, 2.0 * a.x + a.y)), 0.0, 0.0);
    }
    return vec4f(cubic(vec4f(b.y - b.x, a.y - 3.0 * a.x, 3.0 * b.x + b.y, a.x + a.y)), 0.0);
}

fn transmittance_from_moments(total: f32, moments: array<vec2f, 4>, phi: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    // Around phi at angle 0.
    var m = moments;
    let back = turn(-phi);
    var turned: array<vec2f, 4>;
    var power = vec2f((1.0 - BIAS) / total, 0.0);
    for (var k = 0; k < MOMENTS; k++) {
        power = times(power, back);
        turned[k] = times(m[k], power);
    }
    // Szegoe's recursion of the orthogonal polynomials, and their kernel at 1.
    var polynomial: array<vec2f, 5>;
    polynomial[0] = vec2f(1.0, 0.0);
    var kernel = polynomial;
    var reflections: array<vec2f, 4>;
    var inverse_norms: array<f32, 4>;
    var norm = 1.0;
    for (var k = 0; k < MOMENTS; k++) {
        var moved = vec2f(0.0);
        for (var j = 0; j <= k; j++) {
            moved += times(polynomial[j], turned[j]);
        }
        let reflection = moved / norm;
        reflections[k] = reflection;
        var before = polynomial;
        var at_one = vec2f(0.0);
        for (var j = 0; j <= k + 1; j++) {
            var next = vec2f(0.0);
            if j > 0 {
                next = before[j - 1];
            }
            if j <= k {
                next -= times(reflection, conjugate(before[k - j]));
            }
            polynomial[j] = next;
            at_one += next;
        }
        norm *= 1.0 - dot(reflection, reflection);
        inverse_norms[k] = 1.0 / norm;
        for (var j = 0; j <= k + 1; j++) {
            kernel[j] += times(conjugate(at_one), polynomial[j]) * inverse_norms[k];
        }
    }
    var at_zero = 0.0;
    for (var j = 0; j <= MOMENTS; j++) {
        at_zero += kernel[j].x;
    }
    var share = OVERESTIMATION / at_zero;
    let points = other_points(kernel);
    for (var i = 0; i < MOMENTS; i++) {
        let x = points[i];
        // (x + i) / (x - i).
        let z = vec2f(x * x - 1.0, 2.0 * x) / (x * x + 1.0);
        var p = vec2f(1.0, 0.0);
        var reversed = p;
        var squares = 1.0;
        for (var k = 0; k < MOMENTS; k++) {
            let moved = times(z, p);
            p = moved - times(reflections[k], reversed);
            reversed -= times(conjugate(reflections[k]), moved);
            squares += dot(p, p) * inverse_norms[k];
        }
        share += front(x, phi) / squares;
    }
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
