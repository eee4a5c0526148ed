// Transmittance in front of an angle from two or three trigonometric moments (Muenstermann et al. 2018, supplement); the steps are explained
// in the CPU reference, peelnet_core::methods::moments::trigonometric. Without arrays, whose loops took several times the time.
import package::methods::mboit::trigonometric::circle::{WRAPPING_ZONE, conjugate, times, turn};
import package::methods::mboit::trigonometric::roots::{cubic, quadratic};
import package::parameters::{BIAS, MOMENTS, OVERESTIMATION};

// How much of points counts as in front of phi; they are x = cot(angle / 2) from there.
fn front(x: vec3f, phi: f32) -> vec3f {
    let theta = phi + 2.0 * atan2(vec3f(1.0), x);
    let wrapped = (theta - (6.2831853 - WRAPPING_ZONE)) / WRAPPING_ZONE;
    return clamp(wrapped, vec3f(0.0), vec3f(1.0));
}

// Complex numbers in pairs of vectors.
struct Points {
    re: vec3f,
    im: vec3f,
}

fn turned(a: Points, by: vec2f) -> Points {
    return Points(a.re * by.x - a.im * by.y, a.re * by.y + a.im * by.x);
}

fn product(a: Points, b: Points) -> Points {
    return Points(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

fn difference(a: Points, b: Points) -> Points {
    return Points(a.re - b.re, a.im - b.im);
}

fn transmittance_from_moments(total: f32, m12: vec4f, m3: vec2f, phi: f32) -> f32 {
    if total < 1e-4 {
        return 1.0;
    }
    // Around phi at angle 0.
    let back = turn(-phi);
    let first = back * ((1.0 - BIAS) / total);
    let second = times(first, back);
    let c1 = times(m12.xy, first);
    let c2 = times(m12.zw, second);
    // Szegoe's recursion of the orthogonal polynomials z - r1, z^2 + p z - r2 and z^3 + ... - r3.
    let r1 = c1;
    let n1 = 1.0 - dot(r1, r1);
    let r2 = (c2 - times(r1, c1)) / n1;
    let n2 = n1 * (1.0 - dot(r2, r2));
    let p = times(r2, conjugate(r1)) - r1;
    let at1 = vec2f(1.0, 0.0) - r1;
    let at2 = vec2f(1.0, 0.0) + p - r2;
    // Their kernel at 1: one over the mass there, and its two lowest coefficients.
    var inverse_norms = vec3f(1.0 / n1, 1.0 / n2, 0.0);
    var kernel_at_one = 1.0 + dot(at1, at1) * inverse_norms.x + dot(at2, at2) * inverse_norms.y;
    let of1 = conjugate(at1) * inverse_norms.x;
    let of2 = conjugate(at2) * inverse_norms.y;
    var k0 = vec2f(1.0, 0.0) - times(of1, r1) - times(of2, r2);
    var k1 = of1 + times(of2, p);
    var r3 = vec2f(0.0);
    if MOMENTS == 3 {
        let c3 = times(m3, times(second, back));
        r3 = (c3 + times(p, c2) - times(r2, c1)) / n2;
        inverse_norms.z = 1.0 / (n2 * (1.0 - dot(r3, r3)));
        let linear = -r2 - times(r3, conjugate(p));
        let at3 = vec2f(1.0, 0.0) + p + times(r3, conjugate(r2)) + linear - r3;
        let of3 = conjugate(at3) * inverse_norms.z;
        kernel_at_one += dot(at3, at3) * inverse_norms.z;
        k0 -= times(of3, r3);
        k1 += times(of3, linear);
    }
    // Its zeros as cot(angle / 2).
    var x: vec3f;
    if MOMENTS == 3 {
        x = cubic(vec4f(k1.y - k0.y, k1.x - 3.0 * k0.x, 3.0 * k0.y + k1.y, k0.x + k1.x));
    } else {
        x = vec3f(quadratic(vec3f(k1.x - 2.0 * k0.x, 4.0 * k0.y, 2.0 * k0.x + k1.x)), 0.0);
    }
    // (x + i) / (x - i), and the squares of the polynomials there.
    let scale = 1.0 / (x * x + 1.0);
    let z = Points((x * x - 1.0) * scale, 2.0 * x * scale);
    let one = Points(vec3f(1.0), vec3f(0.0));
    let p1 = difference(z, turned(one, r1));
    let reversed1 = difference(one, turned(z, conjugate(r1)));
    let moved2 = product(z, p1);
    let p2 = difference(moved2, turned(reversed1, r2));
    let reversed2 = difference(reversed1, turned(moved2, conjugate(r2)));
    let p3 = difference(product(z, p2), turned(reversed2, r3));
    let squares = mat3x3f(
        p1.re * p1.re + p1.im * p1.im,
        p2.re * p2.re + p2.im * p2.im,
        p3.re * p3.re + p3.im * p3.im,
    ) * inverse_norms;
    let masses = front(x, phi) / (1.0 + squares);
    let others = masses.x + masses.y + select(0.0, masses.z, MOMENTS == 3);
    let share = OVERESTIMATION / kernel_at_one + others;
    // Degenerate points give NaN, which no comparison finds true.
    let t = exp(-total * share);
    return select(1.0, min(t, 1.0), t >= 0.0);
}
