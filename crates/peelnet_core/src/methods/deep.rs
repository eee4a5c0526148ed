//! `deep-thesis`: Papakostas 2022 — eq 6 with a weight that a network predicts.

use crate::fragment::Fragment;
use crate::methods::wboit::{Sums, normalised};

/// The inputs of the thesis's network for one fragment: `(z_i, Σα, n)`, the last two over its pixel.
pub fn thesis_inputs(fragment: &Fragment, pixel: &[Fragment]) -> [f32; 3] {
    [
        fragment.depth,
        pixel.iter().map(|f| f.alpha).sum(),
        pixel.len() as f32,
    ]
}

/// Eq 6 with `weight(fragment)` as the weight; the weight must be positive and finite.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    weight: impl FnMut(&Fragment) -> f32,
) -> [f32; 3] {
    normalised(&Sums::of(fragments, weight), background)
}
