//! `weighted-average`: Bavoil & Myers, "Order Independent Transparency with Dual Depth Peeling", NVIDIA 2008.

use peelnet_core::fragment::Fragment;
use peelnet_core::methods::wboit::{Sums, normalised};

/// `(Σ C_i / Σ α_i)·(1 − (1−ᾱ)ⁿ) + C_0 (1−ᾱ)ⁿ` with `ᾱ = Σ α_i / n`.
pub fn composite(fragments: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    let mut sums = Sums::of(fragments, |_| 1.0);
    let n = fragments.len() as f32;
    if n > 0.0 {
        sums.transmittance = (1.0 - sums.alpha / n).max(0.0).powf(n);
    }
    normalised(&sums, background)
}
