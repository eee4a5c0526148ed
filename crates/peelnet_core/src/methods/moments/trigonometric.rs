//! Bounds from trigonometric moments: depth becomes an angle, as with power moments the estimate comes from the one measure with these
//! moments that has a point at the asked depth, and M others.
//!
//! Depths use the circle but for a wrapping zone behind the farthest, where points may lie that belong to either end: those count as in front
//! by how far through the zone they are. The zone of a tenth of π and the overestimation of 0.25 are the paper's.
//!
//! The reconstruction is written anew: the circle is turned so that the asked depth is at angle 0; Szegő's recursion gives the orthogonal
//! polynomials of the moments, their kernel at 1 has the other points as zeros, and `x = cot(angle / 2)` makes it a real polynomial of degree
//! M whose zeros are real. The bias is ours: it mixes in the uniform measure, whose matrix is the identity, so that one
//! bias serves all M. There are no four moments: asked at one of four layers, the last norm's inverse is 2,800 with this bias, 32-bit sums move
//! two close points of the measure by 2e-3, and 2 % of its mass is lost (a colour off by 0.04 on the worked example).

use super::roots;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

pub const MOST: usize = 3;

/// Behind the farthest depth, an angle that no depth has.
pub const WRAPPING_ZONE: f64 = 0.1 * PI;

/// For 32-bit moments, by the stress cases: with 5e-6 and with 3e-5, layers of α = 0.99 let behind them shine through by up to 72/255 and
/// 49/255, and the order of drawing shows; with 1e-4 by 5/255, with 3e-4 by 6/255, and the order does not show. Sines and cosines are less
/// exact than sums, so that power moments can do with less.
pub const BIAS: f64 = 1e-4;

/// For 16-bit moments: two roundings of a sum.
pub const BIAS_HALF: f64 = 1e-3;

fn angle(zeta: f64) -> f64 {
    (zeta + 1.0) * (PI - 0.5 * WRAPPING_ZONE)
}

/// The point of the circle at `x = cot(angle / 2)`.
fn on_circle(x: f64) -> Complex64 {
    Complex64::new(x, 1.0) / Complex64::new(x, -1.0)
}

/// Adds absorbance `b` at a depth to absorbance and moments.
pub(super) fn add(sums: &mut [f64; 9], b: f64, zeta: f64) {
    sums[0] += b;
    let turn = Complex64::cis(angle(zeta));
    let mut power = turn * b;
    for moment in sums[1..].chunks_exact_mut(2) {
        moment[0] += power.re;
        moment[1] += power.im;
        power *= turn;
    }
}

/// The least and the most of a measure that can lie in front of a depth, from its moments over its absorbance.
pub(super) fn bounds(means: [f64; 9], count: usize, bias: f64, zeta: f64) -> (f64, f64) {
    let phi = angle(zeta);
    let back = Complex64::cis(-phi);
    let mut turn = Complex64::ONE;
    // Around the asked depth at angle 0.
    let turned = means[1..=2 * count].chunks_exact(2).map(|m| {
        turn *= back;
        Complex64::new(m[0], m[1]) * turn * (1.0 - bias)
    });
    let (own, others) = measure(&turned.collect::<Vec<_>>());
    let in_front = others.map(|(x, mass)| mass * front(x, phi));
    let low = in_front.iter().take(count).sum();
    (low, low + own)
}

/// How much of a point counts as in front of the angle `phi`; the point is `x = cot(angle / 2)` from there.
fn front(x: f64, phi: f64) -> f64 {
    let ahead = 2.0 * f64::atan2(1.0, x);
    let theta = phi + ahead;
    if theta >= TAU {
        return 1.0;
    }
    ((theta - (TAU - WRAPPING_ZONE)) / WRAPPING_ZONE).max(0.0)
}

/// The measure with the moments `c` that has a point at angle 0: what it has there, and its other points, as (cot(angle / 2), mass), as many
/// as there are moments.
fn measure(c: &[Complex64]) -> (f64, [(f64, f64); 4]) {
    let count = c.len();
    // Coefficients of the orthogonal polynomial of the last degree, by Szegő's recursion, and of the kernel at 1.
    let mut phi = [Complex64::ZERO; MOST + 1];
    phi[0] = Complex64::ONE;
    let mut kernel = phi;
    let mut norm = 1.0;
    let mut reflections = [Complex64::ZERO; MOST];
    let mut norms = [1.0; MOST + 1];
    for k in 0..count {
        let moved: Complex64 = (0..=k).map(|j| phi[j] * c[j]).sum();
        let reflection = moved / norm;
        reflections[k] = reflection;
        let before = phi;
        let at = |j: Option<usize>| j.map_or(Complex64::ZERO, |j| before[j]);
        for (j, p) in phi.iter_mut().enumerate().take(k + 2) {
            let (shifted, reversed) = (at(j.checked_sub(1)), at(k.checked_sub(j)));
            *p = shifted - reflection * reversed.conj();
        }
        norm *= 1.0 - reflection.norm_sqr();
        norms[k + 1] = norm;
        let at_one: Complex64 = phi.iter().take(k + 2).sum();
        for (sum, p) in kernel.iter_mut().zip(phi) {
            *sum += at_one.conj() * p / norm;
        }
    }
    // One over the mass at a point: the sum of squares of the orthogonal polynomials there.
    let mass = |x: f64| {
        let z = on_circle(x);
        let (mut p, mut reversed) = (Complex64::ONE, Complex64::ONE);
        let mut sum = 1.0;
        for k in 0..count {
            (p, reversed) = (
                z * p - reflections[k] * reversed,
                reversed - reflections[k].conj() * z * p,
            );
            sum += p.norm_sqr() / norms[k + 1];
        }
        1.0 / sum
    };
    let own = 1.0 / kernel.iter().map(|p| p.re).sum::<f64>();
    // Zeros of the kernel `Σ p_k z^k` on the circle, as cot(angle / 2). Its coefficients mirror each other.
    let [[a0, b0], [a1, b1]] = [kernel[0], kernel[1]].map(|p| [p.re, p.im]);
    let points = if count == 2 {
        roots::real(&[a1 - 2.0 * a0, 4.0 * b0, 2.0 * a0 + a1])
    } else {
        roots::real(&[b1 - b0, a1 - 3.0 * a0, 3.0 * b0 + b1, a0 + a1])
    };
    (own, points.map(|x| (x, mass(x))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the measure has at its points is the whole, and has the moments that were given.
    #[test]
    fn the_measure_has_the_moments() {
        let layers = [
            (0.2, -0.7),
            (0.3, -0.2),
            (0.1, 0.2),
            (0.25, 0.5),
            (0.15, 0.9),
        ];
        for count in 2..=MOST {
            // From the zeroth, which is 1.
            let of_layers = |k: usize| -> Complex64 {
                let turns = layers.iter().map(|&(b, zeta)| (b, k as f64 * angle(zeta)));
                turns.map(|(b, turn)| b * Complex64::cis(turn)).sum()
            };
            let wanted: Vec<_> = (0..=count).map(of_layers).collect();
            let (own, others) = measure(&wanted[1..]);
            for (k, want) in wanted.iter().enumerate() {
                let points = others.iter().take(count);
                let of_points = points.map(|&(x, mass)| on_circle(x).powi(k as i32) * mass);
                let found = of_points.sum::<Complex64>() + own;
                assert!((found - want).norm() < 1e-9, "{count} {k}: {found} {want}");
            }
        }
    }
}
