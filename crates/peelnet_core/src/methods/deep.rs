//! `deep-thesis`: Papakostas 2022 — eq 6 with a weight that a network predicts.

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
    pub fn new(fragment: &Fragment, pixel: &[Fragment]) -> Self {
        Self {
            linear_depth: fragment.depth,
            alpha_sum: pixel.iter().map(|f| f.alpha).sum(),
            fragment_count: pixel.len() as f32,
        }
    }
}

/// Eq 6 with `weight(fragment)` as the weight; the weight must be positive and finite.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    weight: impl FnMut(&Fragment) -> f32,
) -> [f32; 3] {
    normalised(&Sums::of(fragments, weight), background)
}
