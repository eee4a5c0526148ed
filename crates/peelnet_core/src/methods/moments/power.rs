//! Bounds from power moments over warped depth.

use super::roots;

/// The least and the most of a measure on −1 … 1 that can lie in front of `zeta`, from its first four moments over its
/// zeroth: the share without and with all that the bound's measure has at `zeta` itself. Of three points: the depth and two others.
///
/// NaN where the points of that measure coincide.
pub fn four_moment_bounds(moments: [f64; 4], bias: f64, zeta: f64) -> (f64, f64) {
    // A measure with these moments (0, ⅜, 0, ⅜) has more than two points, so that the matrix below is never singular.
    let mut m = moments.map(|mean| mean * (1.0 - bias));
    m[1] += 0.375 * bias;
    m[3] += 0.375 * bias;
    // Factors L D of the Hankel matrix [1 m1 m2; m1 m2 m3; m2 m3 m4], times their denominators.
    let variance = m[1] - m[0] * m[0];
    let l21 = m[2] - m[0] * m[1];
    let d = variance * (m[3] - m[1] * m[1]) - l21 * l21;
    let determinant = variance * d;
    // Coefficients of the kernel polynomial, times the determinant: H c = (1, ζ, ζ²). Its value at ζ is one over what the
    // measure has there (the Christoffel function), a sum of squares.
    let y1 = zeta - m[0];
    let y2 = (zeta * zeta - m[1]) * variance - l21 * y1;
    let c2 = y2 * variance;
    let c1 = y1 * d - l21 * y2;
    let c0 = determinant - m[0] * c1 - m[1] * c2;
    let own = determinant / (determinant + y1 * y1 * d + y2 * y2);
    // Its roots are the other two points of the measure: the smaller one, p, and one over the larger, q, so that a point at
    // infinity is none in particular, and neither is a difference of large numbers.
    let root = ((0.5 * c1).powi(2) - c0 * c2).max(0.0).sqrt();
    let inverse = -(0.5 * c1 + if c1 >= 0.0 { root } else { -root }).recip();
    let (p, q) = (c0 * inverse, c2 * inverse);
    // What lies at either, from the measure's zeroth and first moment.
    let at_p = (1.0 - own - q * (m[0] - own * zeta)) / (1.0 - p * q);
    let at_q = 1.0 - own - at_p;
    let in_front = |yes: bool, mass: f64| if yes { mass } else { 0.0 };
    let low = in_front(p < zeta, at_p) + in_front((1.0 - zeta * q) * q < 0.0, at_q);
    (low, low + own)
}

/// Moments of measures of more than three and four points, so that their matrices are never singular: of six moments, and, as in the
/// paper's code, of eight.
const NEUTRAL: [[f64; 8]; 2] = [
    [0.0, 0.48, 0.0, 0.451, 0.0, 0.45, 0.0, 0.0],
    [0.0, 0.75, 0.0, 0.676_666_67, 0.0, 0.63, 0.0, 0.600_303_03],
];

/// Factors L D of the Hankel matrix of a measure's moments.
struct Factors<const N: usize> {
    lower: [[f64; N]; N],
    pivots: [f64; N],
}

impl<const N: usize> Factors<N> {
    /// Of the moments `m_0 … m_{2N − 2}`.
    fn new(m: &[f64; 9]) -> Self {
        let (mut lower, mut pivots) = ([[0.0; N]; N], [0.0; N]);
        for j in 0..N {
            let done: f64 = (0..j).map(|k| lower[j][k] * lower[j][k] * pivots[k]).sum();
            pivots[j] = m[2 * j] - done;
            for i in j + 1..N {
                let done: f64 = (0..j).map(|k| lower[i][k] * lower[j][k] * pivots[k]).sum();
                lower[i][j] = (m[i + j] - done) / pivots[j];
            }
        }
        Self { lower, pivots }
    }

    /// The orthogonal polynomials of the measure at `t`.
    fn polynomials(&self, t: f64) -> [f64; N] {
        let mut y = [1.0; N];
        let mut power = 1.0;
        for i in 1..N {
            power *= t;
            y[i] = power - (0..i).map(|k| self.lower[i][k] * y[k]).sum::<f64>();
        }
        y
    }

    /// What the extreme measure has at one of its points: one over the kernel there (the Christoffel function).
    fn mass(&self, t: f64) -> f64 {
        let squares = self.polynomials(t).into_iter().zip(self.pivots);
        squares.map(|(y, d)| y * y / d).sum::<f64>().recip()
    }
}

/// As [`four_moment_bounds`], met by measures of N points, 4 or 5: from six or eight moments over the zeroth, which is the first here.
pub fn bounds<const N: usize>(means: [f64; 9], bias: f64, zeta: f64) -> (f64, f64) {
    let mut m = means;
    for (m, neutral) in m[1..].iter_mut().zip(NEUTRAL[N - 4]) {
        *m = *m * (1.0 - bias) + neutral * bias;
    }
    let factors = Factors::<N>::new(&m);
    // Coefficients of the kernel at ζ, whose zeros are the other points.
    let mut c = factors.polynomials(zeta);
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|k| factors.lower[k][i] * c[k]).sum();
        c[i] = c[i] / factors.pivots[i] - known;
    }
    let points = roots::real(&c);
    let in_front = points.into_iter().filter(|&t| t < zeta);
    let low = in_front.map(|t| factors.mass(t)).sum();
    (low, low + factors.mass(zeta))
}
