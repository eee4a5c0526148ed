//! What all moment-based methods share (Münstermann, Krumpen, Klein & Peters 2018): settings, power moments, and eq 6 with the
//! estimate as the weight.

use crate::{absorbance::DepthWarp, fragment::Fragment};

/// How moments are turned into transmittance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Where between the two bounds the estimate lies: 0 the most light, 1 the least; 0.25 in the paper.
    pub overestimation: f64,
    /// Pull towards moments of a measure that can always be inverted; 5e−7 for 32-bit power moments in the paper's
    /// code, 6e−5 for 16-bit ones.
    pub bias: f64,
    /// Whether a fragment's own absorbance is taken out of the moments before it is asked what lies in front of it.
    pub own_share_out: bool,
}

impl Settings {
    /// The paper's, for 32-bit moments.
    pub const PAPER: Self = Self {
        overestimation: 0.25,
        bias: 5e-7,
        own_share_out: false,
    };
}

/// The absorbance of a pixel and its power moments, `b_0 … b_{N−1}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerMoments<const N: usize>(pub [f64; N]);

impl<const N: usize> Default for PowerMoments<N> {
    fn default() -> Self {
        Self([0.0; N])
    }
}

impl<const N: usize> PowerMoments<N> {
    /// Adds absorbance `b` at warped depth `zeta`.
    pub(super) fn add_powers(&mut self, b: f64, zeta: f64) {
        let mut power = b;
        for m in &mut self.0 {
            *m += power;
            power *= zeta;
        }
    }

    /// The estimate of the transmittance in front of a depth, from the share of the absorbance that can lie there: its `bounds`
    /// given `b_k / b_0`, `k` from 1.
    pub(super) fn estimate<const M: usize>(
        &self,
        settings: &Settings,
        bounds: impl FnOnce([f64; M]) -> (f64, f64),
    ) -> f64 {
        let total = self.0[0];
        // Less than that is invisible (1 − e^−x ≈ x) and its normalised moments are noise.
        if total < 1e-4 {
            return 1.0;
        }
        let (low, high) = bounds(std::array::from_fn(|k| self.0[k + 1] / total));
        let share = low + settings.overestimation * (high - low);
        let t = (-total * share).exp();
        // Degenerate points give NaN; nothing in front is the harmless answer.
        if t.is_nan() { 1.0 } else { t.min(1.0) }
    }
}

/// Absorbance and moments of a pixel, which bound how much of the absorbance lies in front of a depth.
pub trait MomentSums: Copy {
    /// Adds absorbance `b` at warped depth `zeta`; a negative `b` takes it away.
    fn add(&mut self, b: f64, zeta: f64);

    /// The estimate of the transmittance in front of `zeta`.
    fn transmittance(&self, zeta: f64, settings: &Settings) -> f64;
}

/// The transmittance in front of each of a pixel's fragments, given as (linear depth, α), from sums that begin as `empty`.
pub fn transmittances<M: MomentSums>(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    empty: M,
    settings: &Settings,
) -> Vec<f64> {
    super::transmittances(
        fragments,
        warp,
        empty,
        settings.own_share_out,
        M::add,
        |m, zeta| m.transmittance(zeta, settings),
    )
}

/// Eq 6's composite with the estimated transmittance as the weight.
pub fn composite<M: MomentSums>(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    empty: M,
    settings: &Settings,
) -> [f32; 3] {
    super::composite_by(fragments, background, |points| {
        transmittances(points, warp, empty, settings)
    })
}
