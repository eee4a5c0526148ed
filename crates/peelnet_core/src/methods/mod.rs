//! Compositing on a plain list of fragments, on the CPU: exactly, by the weighted mean that trained weights fill in, and by the methods whose
//! statistics networks read. The references of all other methods stand beside them in `peelnet_render`.
//!
//! The commutative methods take fragments in any order; [`over`] sorts first. `background` is `C_0`, linear RGB.

pub mod anchored;
pub mod deep;
pub mod dfaoit;
pub mod known;
pub mod moments;
pub mod nmt;
pub mod one;
pub mod over;
pub mod quantiles;
pub mod slabs;
pub mod wboit;

use crate::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    guards::WEIGHT_FLOOR,
};

/// A fragment: its absorbance, its warped depth, and whether it is visible enough to be the nearest or the farthest of those around it.
pub type Point = (f64, f64, bool);

pub fn point(alpha: f32, zeta: f64) -> Point {
    (absorbance(alpha), zeta, alpha >= anchored::LOW_ALPHA)
}

/// Of fragments that are given as (linear depth, α).
pub fn points(fragments: &[(f32, f32)], warp: &DepthWarp) -> Vec<Point> {
    let to_point = |&(depth, alpha): &(f32, f32)| point(alpha, warp.apply(depth.into()));
    fragments.iter().map(to_point).collect()
}

/// Eq 6's composite with an estimate of the transmittance in front of each fragment as its weight.
pub fn composite(fragments: &[Fragment], background: [f32; 3], transmittances: &[f64]) -> [f32; 3] {
    let mut weights = transmittances.iter();
    deep::composite(fragments, background, |_| {
        // One estimate a fragment.
        let t = weights.next().copied().unwrap_or_default();
        t.max(WEIGHT_FLOOR.into()) as f32
    })
}
