//! `blended`: McGuire & Bavoil 2013, eq 5 — unweighted average colour with the exact coverage.

use peelnet_core::fragment::Fragment;
use peelnet_core::methods::wboit::{Sums, normalised};

/// `(Σ C_i / Σ α_i)·(1 − T_∞) + C_0 T_∞`.
pub fn composite(fragments: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    normalised(&Sums::of(fragments, |_| 1.0), background)
}
