//! Zeros of polynomials all of whose zeros are real, as the kernels of moment problems have them. Coefficients are given from the constant
//! one up.

/// The zeros of a polynomial of degree 2 to 4, then infinities. Those of a cubic and a quartic lie within ±1e4 and ±1e3: farther points of a
/// measure on −1 … 1 hold nothing.
pub(super) fn real(c: &[f64]) -> [f64; 4] {
    let mut all = [f64::INFINITY; 4];
    match *c {
        [c0, c1, c2] => all[..2].copy_from_slice(&quadratic([c0, c1, c2])),
        [c0, c1, c2, c3] => all[..3].copy_from_slice(&cubic([c0, c1, c2, c3])),
        [c0, c1, c2, c3, c4] => all = quartic([c0, c1, c2, c3, c4]),
        _ => {}
    }
    all
}

/// Of a quadratic; two equal values where rounding left no real zero.
fn quadratic([c0, c1, c2]: [f64; 3]) -> [f64; 2] {
    let half = 0.5 * c1;
    let root = (half * half - c0 * c2).max(0.0).sqrt();
    // Of the two sums, the one without cancellation.
    let q = -(half + root.copysign(half));
    if q == 0.0 {
        return [0.0; 2];
    }
    [q / c2, c0 / q]
}

/// Of a cubic, by cosines (Viète).
fn cubic([c0, c1, c2, c3]: [f64; 4]) -> [f64; 3] {
    // The polynomial of 1/t, where that keeps the roots finite.
    let reversed = c0.abs() > c3.abs();
    let [a, b, c] = if reversed {
        [c1 / c0, c2 / c0, c3 / c0]
    } else {
        [c2 / c3, c1 / c3, c0 / c3]
    };
    let q = (a * a / 9.0 - b / 3.0).max(1e-30);
    let r = (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0;
    let angle = (r / (q * q.sqrt())).clamp(-1.0, 1.0).acos() / 3.0;
    let third = std::f64::consts::TAU / 3.0;
    [0.0, third, -third].map(|turn| {
        let root = -2.0 * q.sqrt() * (angle + turn).cos() - a / 3.0;
        let root = if reversed { root.recip() } else { root };
        root.clamp(-1e4, 1e4)
    })
}

/// Steps of Laguerre's method, which triples the number of right digits; the bound that it starts at is within a few times the root.
const STEPS: usize = 6;

/// Of a quartic: the zero of the largest magnitude by Laguerre's method, which approaches it from
/// beyond without passing it, then the cubic that is left.
fn quartic(mut c: [f64; 5]) -> [f64; 4] {
    // The polynomial of 1/t, where that keeps the zeros finite.
    let reversed = c[0].abs() > c[4].abs();
    if reversed {
        c.reverse();
    }
    let [b0, b1, b2, b3] = [c[0] / c[4], c[1] / c[4], c[2] / c[4], c[3] / c[4]];
    // Laguerre's and Samuelson's bound of the zeros, on the side of their mean.
    let side = f64::copysign(1.0, -b3);
    let spread = (b3 * b3 - 8.0 / 3.0 * b2).max(0.0).sqrt();
    let mut x = -0.25 * b3 + 0.75 * side * spread;
    for _ in 0..STEPS {
        let p = (((x + b3) * x + b2) * x + b1) * x + b0;
        let slope = ((4.0 * x + 3.0 * b3) * x + 2.0 * b2) * x + b1;
        let bend = (12.0 * x + 6.0 * b3) * x + 2.0 * b2;
        let root = (9.0 * slope * slope - 12.0 * p * bend).max(0.0).sqrt();
        let divisor = slope + root.copysign(slope);
        if divisor != 0.0 {
            x -= 4.0 * p / divisor;
        }
    }
    // Dividing from the end that keeps the errors small.
    let [d0, d1, d2] = if x.abs() > 1.0 {
        let d0 = -b0 / x;
        let d1 = (d0 - b1) / x;
        [d0, d1, (d1 - b2) / x]
    } else {
        let d2 = b3 + x;
        let d1 = b2 + x * d2;
        [b1 + x * d1, d1, d2]
    };
    let [r, s, t] = cubic([d0, d1, d2, 1.0]);
    [x, r, s, t].map(|t| {
        let t = if reversed { t.recip() } else { t };
        t.clamp(-1e3, 1e3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial with these zeros, times 3.
    fn polynomial<const N: usize>(roots: &[f64]) -> [f64; N] {
        let mut c = [0.0; N];
        c[0] = 3.0;
        for (degree, r) in roots.iter().enumerate() {
            for k in (0..=degree + 1).rev() {
                let below = if k > 0 { c[k - 1] } else { 0.0 };
                c[k] = below - r * c[k];
            }
        }
        c
    }

    fn assert_roots(found: &[f64], want: &[f64]) {
        for w in want {
            // A double zero is known to the root of the precision.
            let near = |r: &f64| (r - w).abs() < 1e-6 * w.abs().max(1.0);
            assert!(found.iter().any(near), "{found:?} {want:?}");
        }
    }

    #[test]
    fn zeros_are_found() {
        for want in [[1.0, -2.0], [1e-6, 1e6], [0.0, 0.0], [3.0, 3.0]] {
            assert_roots(&real(&polynomial::<3>(&want)), &want);
        }
        // (t − 1)(t + 2)(t − 0.5), and two zeros with one at infinity.
        assert_roots(&real(&[1.0, -2.5, 0.5, 1.0]), &[-2.0, 0.5, 1.0]);
        assert_roots(&real(&[-2.0, 1.0, 1.0, 0.0]), &[-2.0, 1.0]);
        for want in [
            [1.0, -2.0, 0.5, 3.0],
            [-1.0, -2.0, -0.5, 0.25],
            [1e3, 1.0, -1.0, 0.1],
            [-1e3, 50.0, 2.0, 1e-3],
            [0.1, 0.2, 0.3, 0.4],
            [0.0, 0.0, 0.0, 1.0],
        ] {
            assert_roots(&real(&polynomial::<5>(&want)), &want);
        }
    }
}
