//! `deep-thesis`: Papakostas 2022 — eq 6 with a weight that a network predicts.

use crate::features::Feature;
use crate::fragment::Fragment;
use crate::methods::wboit::{Sums, normalised};

/// What is known of a fragment: a row of a dataset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Distance along the view axis, in scene units.
    pub linear_depth: f32,
    pub alpha_sum: f32,
    pub fragment_count: f32,
}

impl Row {
    pub fn of(fragment: &Fragment, pixel: &[Fragment]) -> Self {
        Self {
            linear_depth: fragment.depth,
            alpha_sum: pixel.iter().map(|f| f.alpha).sum(),
            fragment_count: pixel.len() as f32,
        }
    }
}

/// The inputs of the thesis's network, `(z_i, Σα, n)`; in WGSL functions of `linear_depth` and `statistics`.
pub static THESIS_INPUTS: [&Feature<Row>; 3] = [
    &Feature::new("linear_depth", "scene units", "linear_depth", |row| {
        row.linear_depth.into()
    }),
    &Feature::new("alpha_sum", "1", "statistics.x", |row| row.alpha_sum.into()),
    &Feature::new("fragment_count", "1", "statistics.y", |row| {
        row.fragment_count.into()
    }),
];

/// Eq 6 with `weight(fragment)` as the weight; the weight must be positive and finite.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    weight: impl FnMut(&Fragment) -> f32,
) -> [f32; 3] {
    normalised(&Sums::of(fragments, weight), background)
}
