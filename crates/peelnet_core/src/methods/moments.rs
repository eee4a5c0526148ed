//! `mboit4`, `mboit6`, `mboit8` and `mboit-trig-M`: moment-based order-independent transparency (Münstermann, Krumpen, Klein & Peters,
//! "Moment-Based Order-Independent Transparency", PACMCGIT 1(1), 2018) with four, six and eight power moments, and with M = 2 or 3
//! trigonometric ones (its supplement). The shaders are in `methods/mboit/`.
//!
//! Pass 1 sums absorbance `b_i` and its moments over warped depth ζ: `b_k = Σ b_i ζ_i^k`, or `c_k = Σ b_i e^{ikθ_i}` of depths as angles. The
//! moments do not determine where the absorbance lies, but they bound how much of it can lie in front of a depth; the bound's
//! ends are met by the one measure with these moments that has a point at the depth, and the estimate lies between them.

pub mod power;
mod roots;
pub mod trigonometric;

use crate::{absorbance::DepthWarp, statistics::moments_of};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Powers of ζ from the first to the fourth, the sixth or the eighth.
    Power(usize),
    /// Two or three powers of `e^{iθ}`, complex numbers.
    Trigonometric(usize),
}

/// How moments are turned into transmittance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub basis: Basis,
    /// Where between the two bounds the estimate lies: 0 the most light, 1 the least; 0.25 in the paper.
    pub overestimation: f64,
    /// Pull towards moments of a measure that can always be inverted.
    pub bias: f64,
    /// Whether a fragment's own absorbance is taken out of the moments before it is asked what lies in front of it.
    pub own_absorbance_out: bool,
}

impl Settings {
    /// The paper's, for four power moments of 32 bits.
    pub const FOUR: Self = Self::published(Basis::Power(4), 5e-7);
    pub const SIX: Self = Self::published(Basis::Power(6), 5e-6);
    pub const EIGHT: Self = Self::published(Basis::Power(8), 5e-5);

    /// For trigonometric moments of 32 bits.
    pub const fn trigonometric(count: usize) -> Self {
        Self::published(Basis::Trigonometric(count), trigonometric::BIAS)
    }

    const fn published(basis: Basis, bias: f64) -> Self {
        Self {
            basis,
            overestimation: 0.25,
            bias,
            own_absorbance_out: false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    basis: Basis,
    /// Absorbance, then its moments: real and imaginary part of each that is complex.
    pub sums: [f64; 9],
}

impl Moments {
    pub const fn new(basis: Basis) -> Self {
        Self {
            basis,
            sums: [0.0; 9],
        }
    }

    /// Adds absorbance `b` at warped depth `zeta`; a negative `b` takes it away.
    pub fn add(&mut self, b: f64, zeta: f64) {
        match self.basis {
            Basis::Power(_) => {
                for (sum, moment) in self.sums.iter_mut().zip(moments_of(b, zeta)) {
                    *sum += moment;
                }
            }
            Basis::Trigonometric(_) => trigonometric::add(&mut self.sums, b, zeta),
        }
    }

    /// The estimate of the transmittance in front of `zeta`.
    pub fn transmittance(&self, zeta: f64, settings: &Settings) -> f64 {
        let (total, bias) = (self.sums[0], settings.bias);
        // Less than that is invisible (1 − e^−x ≈ x) and its normalised moments are noise.
        if total < 1e-4 {
            return 1.0;
        }
        let means = self.sums.map(|sum| sum / total);
        let [_, m1, m2, m3, m4, ..] = means;
        let (low, high) = match self.basis {
            Basis::Power(4) => power::four_moment_bounds([m1, m2, m3, m4], bias, zeta),
            Basis::Power(6) => power::bounds::<4>(means, bias, zeta),
            Basis::Power(_) => power::bounds::<5>(means, bias, zeta),
            Basis::Trigonometric(count) => trigonometric::bounds(means, count, bias, zeta),
        };
        let fraction = low + settings.overestimation * (high - low);
        let t = (-total * fraction).exp();
        // Degenerate points give NaN; nothing in front is the harmless answer.
        if t.is_nan() { 1.0 } else { t.min(1.0) }
    }
}

/// The transmittance in front of each of a pixel's fragments, given as (linear depth, α).
pub fn transmittances(fragments: &[(f32, f32)], warp: &DepthWarp, settings: &Settings) -> Vec<f64> {
    let points = super::points(fragments, warp);
    let mut all = Moments::new(settings.basis);
    for &(b, zeta, _) in &points {
        all.add(b, zeta);
    }
    let in_front = points.iter().map(|&(b, zeta, _)| {
        let mut others = all;
        if settings.own_absorbance_out {
            others.add(-b, zeta);
        }
        others.transmittance(zeta, settings)
    });
    in_front.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a lone layer a quarter of it counts, as published, anywhere in the range; nothing with its own share out.
    #[test]
    fn a_lone_layer_counts_a_quarter_of_itself() {
        for (settings, tolerance) in [
            (Settings::FOUR, 1e-3),
            (Settings::SIX, 2e-3),
            (Settings::EIGHT, 5e-3),
            (Settings::trigonometric(2), 2e-3),
            (Settings::trigonometric(3), 2e-3),
        ] {
            for zeta in (0..=100).map(|i| f64::from(i) / 50.0 - 1.0) {
                let mut moments = Moments::new(settings.basis);
                moments.add(0.8, zeta);
                let t = moments.transmittance(zeta, &settings);
                let error = (t - f64::exp(-0.25 * 0.8)).abs();
                assert!(error < tolerance, "{settings:?} {zeta}: {t}");
                moments.add(-0.8, zeta);
                assert_eq!(moments.transmittance(zeta, &settings), 1.0);
            }
        }
    }
}
