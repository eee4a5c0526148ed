//! `weighted-sum`: Meshkin, "Sort-Independent Alpha Blending", GDC 2007.

use peelnet_core::fragment::Fragment;
use peelnet_core::methods::wboit::Sums;

/// `Σ C_i + C_0 (1 − Σ α_i)`. May leave the gamut: that is a known failure.
pub fn composite(fragments: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    let Sums { color, alpha, .. } = Sums::of(fragments, |_| 1.0);
    std::array::from_fn(|k| color[k] + background[k] * (1.0 - alpha))
}
