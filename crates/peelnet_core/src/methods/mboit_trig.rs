//! `mboit-trig-M`: moment-based transparency with M = 2 or 3 trigonometric moments (Münstermann et al. 2018, supplement). The shader
//! twin is `methods/mboit_trig/`. Four moments are here, in 64 bits, and have no shader: asked at one of four layers, the last norm's inverse
//! is 2,800 with this bias, 32-bit sums move two close points of the measure by 2e-3, and 2 % of its mass is lost (a colour off by 0.04 on
//! the worked example).
//!
//! Depth becomes an angle, and pass 1 sums absorbance and `c_k = Σ b_i e^{ikθ_i}`, k = 1 … M: complex numbers, 2M values. As with power
//! moments, the estimate in front of a depth comes from the one measure with these moments that has a point there; it has M others. Depths use
//! the circle but for a wrapping zone behind the farthest, where points may lie that belong to either end: those count as in front by how
//! far through the zone they are. The zone of a tenth of π and the overestimation of 0.25 are the paper's.
//!
//! The reconstruction is written anew: the circle is turned so that the asked depth is at angle 0; Szegő's recursion gives the orthogonal
//! polynomials of the moments, their kernel at 1 has the other points as zeros, and `x = cot(angle / 2)` makes it a real polynomial of degree
//! M whose zeros are real. The bias is ours: it mixes in the uniform measure, whose matrix is the identity, so that one
//! bias serves all M.

use super::moments::{MomentSums, Settings};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// The most moments.
pub const MOST: usize = 4;

/// Behind the farthest depth, an angle that no depth has.
pub const WRAPPING_ZONE: f64 = 0.1 * PI;

/// For 32-bit moments, by the hard cases: with 5e-6 and with 3e-5, layers of α = 0.99 let behind them shine through by up to 72/255 and
/// 49/255, and the order of drawing shows; with 1e-4 by 5/255, with 3e-4 by 6/255, and the order does not show. Sines and cosines are less
/// exact than sums, so that power moments can do with less.
pub const BIAS: f64 = 1e-4;

/// For 16-bit moments: two roundings of a sum.
pub const BIAS_HALF: f64 = 1e-3;

/// Absorbance and its trigonometric moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    absorbance: f64,
    moments: [Complex64; MOST],
    count: usize,
}

/// The angle of a warped depth.
fn angle(zeta: f64) -> f64 {
    (zeta + 1.0) * (PI - 0.5 * WRAPPING_ZONE)
}

impl Moments {
    /// Of a pixel without fragments, with `count` complex moments, 1 to 4.
    pub fn new(count: usize) -> Self {
        Self {
            absorbance: 0.0,
            moments: [Complex64::ZERO; MOST],
            count,
        }
    }
}

impl MomentSums for Moments {
    fn add(&mut self, b: f64, zeta: f64) {
        self.absorbance += b;
        let turn = Complex64::cis(angle(zeta));
        let mut power = turn * b;
        for m in &mut self.moments {
            *m += power;
            power *= turn;
        }
    }

    fn transmittance(&self, zeta: f64, settings: &Settings) -> f64 {
        let total = self.absorbance;
        // Less than that is invisible, as with power moments.
        if total < 1e-4 {
            return 1.0;
        }
        let phi = angle(zeta);
        let back = Complex64::cis(-phi);
        let mut turn = Complex64::ONE;
        // Around the asked depth at angle 0.
        let turned = self.moments.map(|m| {
            turn *= back;
            m * turn * ((1.0 - settings.bias) / total)
        });
        let (own, others) = measure(turned, self.count);
        let in_front: f64 = others
            .iter()
            .take(self.count)
            .map(|&(x, mass)| mass * front(x, phi))
            .sum();
        let t = (-total * (in_front + settings.overestimation * own)).exp();
        if t.is_nan() { 1.0 } else { t.min(1.0) }
    }
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

/// The measure with the moments `c` that has a point at angle 0: what it has there, and its other points, as (cot(angle / 2), mass).
fn measure(c: [Complex64; MOST], count: usize) -> (f64, [(f64, f64); MOST]) {
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
        for j in 0..=k + 1 {
            let shifted = if j > 0 {
                before[j - 1]
            } else {
                Complex64::ZERO
            };
            let reversed = if j <= k {
                before[k - j].conj()
            } else {
                Complex64::ZERO
            };
            phi[j] = shifted - reflection * reversed;
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
        let z = Complex64::new(x, 1.0) / Complex64::new(x, -1.0);
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
    let roots = real_roots(kernel, count);
    (own, roots.map(|x| (x, mass(x))))
}

/// Zeros of the kernel `Σ p_k z^k` on the circle, as cot(angle / 2). Its coefficients mirror each other.
fn real_roots(p: [Complex64; MOST + 1], count: usize) -> [f64; MOST] {
    let ([a0, b0], [a1, b1]) = ([p[0].re, p[0].im], [p[1].re, p[1].im]);
    match count {
        2 => {
            let [x, y] = super::roots::quadratic([a1 - 2.0 * a0, 4.0 * b0, 2.0 * a0 + a1]);
            [x, y, 0.0, 0.0]
        }
        3 => {
            let c = [b1 - b0, a1 - 3.0 * a0, 3.0 * b0 + b1, a0 + a1];
            let [x, y, z] = super::roots::cubic(c);
            [x, y, z, 0.0]
        }
        _ => {
            let middle = p[2].re;
            super::roots::quartic([
                2.0 * a0 - 2.0 * a1 + middle,
                4.0 * b1 - 8.0 * b0,
                2.0 * middle - 12.0 * a0,
                8.0 * b0 + 4.0 * b1,
                2.0 * a0 + 2.0 * a1 + middle,
            ])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: Settings = Settings {
        bias: BIAS,
        ..Settings::PAPER
    };

    /// M layers: a measure of as many points, which M moments determine, so that the estimate between them is sharp.
    #[test]
    fn as_many_layers_as_moments_are_told_apart() {
        for count in 2..=MOST {
            let layers = [(0.7, -0.8), (1.1, -0.1), (0.4, 0.3), (0.6, 0.8)];
            let layers = &layers[..count];
            let mut m = Moments::new(count);
            for &(b, zeta) in layers {
                m.add(b, zeta);
            }
            for (i, zeta) in [-0.95, -0.45, 0.1, 0.55, 0.97].into_iter().enumerate() {
                let front: f64 = layers.iter().filter(|l| l.1 < zeta).map(|l| l.0).sum();
                let t = m.transmittance(zeta, &PAPER);
                let error = (t - (-front).exp()).abs();
                assert!(error < 2e-2, "{count} {i}: {t} for {}", (-front).exp());
            }
        }
    }

    /// At a lone layer a quarter of it counts, as published, anywhere in the range; nothing with its own share out.
    #[test]
    fn a_lone_layer_counts_a_quarter_of_itself() {
        for count in 2..=MOST {
            for i in 0..=100 {
                let zeta = f64::from(i) / 50.0 - 1.0;
                let mut m = Moments::new(count);
                m.add(0.8, zeta);
                let t = m.transmittance(zeta, &PAPER);
                assert!((t - f64::exp(-0.2)).abs() < 2e-3, "{count} {zeta}: {t}");
                m.add(-0.8, zeta);
                assert_eq!(m.transmittance(zeta, &PAPER), 1.0);
            }
        }
    }

    /// What the measure has at its points is the whole, and has the moments that were given.
    #[test]
    fn the_measure_has_the_moments() {
        for count in 2..=MOST {
            let mut m = Moments::new(count);
            for (b, zeta) in [
                (0.2, -0.7),
                (0.3, -0.2),
                (0.1, 0.2),
                (0.25, 0.5),
                (0.15, 0.9),
            ] {
                m.add(b, zeta);
            }
            let (own, others) = measure(m.moments, count);
            for k in 0..=count {
                let z = |x: f64| Complex64::new(x, 1.0) / Complex64::new(x, -1.0);
                let of_points = others
                    .iter()
                    .take(count)
                    .map(|&(x, mass)| z(x).powi(k as i32) * mass);
                let found = of_points.sum::<Complex64>() + own;
                let want = if k == 0 {
                    Complex64::ONE
                } else {
                    m.moments[k - 1]
                };
                assert!((found - want).norm() < 1e-9, "{count} {k}: {found} {want}");
            }
        }
    }

    /// More moments are nearer, over random stacks.
    #[test]
    fn more_moments_are_nearer() {
        let mut errors = [0.0; 3];
        for seed in 0..50 {
            let mut stream = crate::random::Random::new(seed, &[]);
            let mut random = move || f64::from(stream.unit());
            let layers: Vec<_> = (0..8)
                .map(|_| (0.1 + 0.5 * random(), 1.8 * random() - 0.9))
                .collect();
            for (error, count) in errors.iter_mut().zip(2..) {
                let mut m = Moments::new(count);
                for &(b, zeta) in &layers {
                    m.add(b, zeta);
                }
                for i in 0..100 {
                    let zeta = f64::from(i) / 50.0 - 1.0;
                    let front: f64 = layers.iter().filter(|l| l.1 < zeta).map(|l| l.0).sum();
                    let t = m.transmittance(zeta, &PAPER);
                    assert!((0.0..=1.0).contains(&t), "{t}");
                    *error += (t - (-front).exp()).abs();
                }
            }
        }
        assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
    }
}
