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
use crate::{
    absorbance::{DepthWarp, absorbance},
    features::Feature,
};

/// The most absorbance of one fragment: `e⁻¹⁰ ≈ 4.5e−5`.
pub const ABSORBANCE_MAX: f64 = 10.0;

/// The least `e^(d_far − d_near) − 1` that depth is divided by. Warped depths err by 2⁻²³ in 32 bits, which moves the input by less
/// than a hundredth then.
pub const EXTENT_FLOOR: f64 = 1.0 / 65_536.0;

/// What is known of a fragment and its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    pub zeta: f64,
    /// Warped depths of the pixel's nearest and farthest fragment.
    pub extent: [f64; 2],
    pub count: usize,
    /// Moments `b_0 … b_4` of the pixel.
    pub moments: [f64; 5],
}

impl Seen {
    /// What is known of each of a pixel's fragments, given as (linear depth, α), in any order.
    pub fn all(points: &[(f32, f32)], warp: &DepthWarp) -> Vec<Self> {
        let zetas: Vec<f64> = points.iter().map(|&(z, _)| warp.apply(z.into())).collect();
        let mut moments = Moments::new(Basis::Power(4));
        for (&(_, alpha), &zeta) in points.iter().zip(&zetas) {
            moments.add(absorbance(alpha).min(ABSORBANCE_MAX), zeta);
        }
        let nearest = zetas.iter().copied().fold(f64::INFINITY, f64::min);
        let farthest = zetas.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let seen = |&zeta: &f64| Self {
            zeta,
            extent: [nearest, farthest],
            count: points.len(),
            moments: std::array::from_fn(|k| moments.sums[k]),
        };
        zetas.iter().map(seen).collect()
    }

    /// `(e^d − e^d_near) / (e^d_far − e^d_near)`, 0 at the nearest and 1 at the farthest fragment.
    pub fn depth(&self) -> f64 {
        let [nearest, farthest] = self.extent;
        let beyond = |zeta: f64| ((zeta - nearest) / 2.0).exp() - 1.0;
        (beyond(self.zeta) / beyond(farthest).max(EXTENT_FLOOR)).clamp(0.0, 1.0)
    }
}

/// The inputs of the network, in the published order: depth, the number of fragments, `b_0`, and `b_1 … b_4`. In WGSL functions of `zeta`,
/// `extent`, `totals` and `moments`.
pub static INPUTS: [&Feature<Seen>; 7] = [
    &Feature::new(
        "depth",
        "exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment",
        "peelnet_depth(zeta, extent)",
        Seen::depth,
    ),
    &Feature::new("fragment_count", "1", "totals.y", |seen| seen.count as f64),
    &Feature::new("absorbance", "1", "totals.x", |seen| seen.moments[0]),
    &Feature::new("moment_1", "1", "moments.x", |seen| seen.moments[1]),
    &Feature::new("moment_2", "1", "moments.y", |seen| seen.moments[2]),
    &Feature::new("moment_3", "1", "moments.z", |seen| seen.moments[3]),
    &Feature::new("moment_4", "1", "moments.w", |seen| seen.moments[4]),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a range 1 … e², ζ = ln z − 1.
    fn inputs(points: &[(f32, f32)]) -> Vec<[f64; 7]> {
        let warp = DepthWarp::new(1.0, 2f64.exp());
        let all = Seen::all(points, &warp);
        all.iter()
            .map(|seen| INPUTS.map(|f| (f.value)(seen)))
            .collect()
    }

    /// 32-bit depths and opacities.
    fn close(got: [f64; 7], want: [f64; 7]) {
        for (a, b) in got.iter().zip(&want) {
            assert!((a - b).abs() < 1e-6, "{got:?} {want:?}");
        }
    }

    /// Two fragments of α = ½ and ¾ at ζ = −½ and 1, one between them at ζ = ½: b = ln 2, ln 4 and 0. The middle one's depth is
    /// `(e^½ − 1)/(e^¾ − 1)`.
    #[test]
    fn known_fragments_have_known_inputs() {
        let (a, b) = (0.5f32.exp(), 2f32.exp());
        let middle = 1.5f32.exp();
        let ln2 = 2f64.ln();
        let rest = [
            3.0,
            3.0 * ln2,
            (-0.5 + 2.0) * ln2,
            (0.25 + 2.0) * ln2,
            (-0.125 + 2.0) * ln2,
            (0.0625 + 2.0) * ln2,
        ];
        let with = |depth: f64| {
            let [n, b0, b1, b2, b3, b4] = rest;
            [depth, n, b0, b1, b2, b3, b4]
        };
        let got = inputs(&[(b, 0.75), (middle, 0.0), (a, 0.5)]);
        close(got[0], with(1.0));
        close(got[1], with((0.5f64.exp() - 1.0) / (0.75f64.exp() - 1.0)));
        close(got[2], with(0.0));
    }

    /// A pixel without an extent has the depth 0, and opaque fragments an absorbance of 10.
    #[test]
    fn single_and_opaque_fragments_are_finite() {
        let got = inputs(&[(1f32.exp(), 1.0)]);
        close(got[0], [0.0, 1.0, 10.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
