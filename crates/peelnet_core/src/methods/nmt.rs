//! `nmt`: eq 6 with the transmittance that a network reads off a pixel's raw moments ("Neural Moment Transparency",
//! Tsopouridis, Vasilakis & Fudos 2024).
//!
//! Inputs, network (7-32-16-1), constants and targets are those of the authors' shaders (github.com/gtsopus/NMT): absorbance is cut off
//! at [`ABSORBANCE_MAX`], the moments `b_1 … b_4` are not divided by `b_0`, and depth is normalised exponentially between the
//! pixel's own nearest and farthest fragment. Ours are three things. Their depth is window depth, which depends on the clip planes;
//! here it is warped depth, as for all moment methods of this project: `d = (ζ + 1)/2` in the place of theirs. A pixel without an extent,
//! where they divide zero by zero, has the depth 0 ([`EXTENT_FLOOR`]). Pixels of `b_0` below 0.001 are drawn as all others, where they
//! sum no colour.

use super::moments::{Basis, Moments};
use crate::absorbance::{DepthWarp, absorbance};

/// The most absorbance of one fragment: `e⁻¹⁰ ≈ 4.5e−5`.
pub const ABSORBANCE_MAX: f64 = 10.0;

/// The least `e^(d_far − d_near) − 1` that depth is divided by. Warped depths err by 2⁻²³ in 32 bits, which moves the input by less
/// than a hundredth then.
pub const EXTENT_FLOOR: f64 = 1.0 / 65_536.0;

/// What is known of a fragment and its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragmentMoments {
    pub zeta: f64,
    /// Warped depths of the pixel's nearest and farthest fragment.
    pub extent: [f64; 2],
    pub count: usize,
    /// Moments `b_0 … b_4` of the pixel.
    pub moments: [f64; 5],
}

impl FragmentMoments {
    /// What is known of each of a pixel's fragments, given as (linear depth, α), in any order.
    pub fn all(points: &[(f32, f32)], warp: &DepthWarp) -> Vec<Self> {
        let zetas: Vec<f64> = points.iter().map(|&(z, _)| warp.apply(z.into())).collect();
        let mut moments = Moments::new(Basis::Power(4));
        for (&(_, alpha), &zeta) in points.iter().zip(&zetas) {
            moments.add(absorbance(alpha).min(ABSORBANCE_MAX), zeta);
        }
        let nearest = zetas.iter().copied().fold(f64::INFINITY, f64::min);
        let farthest = zetas.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let fragment = |&zeta: &f64| Self {
            zeta,
            extent: [nearest, farthest],
            count: points.len(),
            moments: std::array::from_fn(|k| moments.sums[k]),
        };
        zetas.iter().map(fragment).collect()
    }

    /// `(e^d − e^d_near) / (e^d_far − e^d_near)`, 0 at the nearest and 1 at the farthest fragment.
    pub fn depth(&self) -> f64 {
        let [nearest, farthest] = self.extent;
        let beyond = |zeta: f64| ((zeta - nearest) / 2.0).exp() - 1.0;
        (beyond(self.zeta) / beyond(farthest).max(EXTENT_FLOOR)).clamp(0.0, 1.0)
    }
}
