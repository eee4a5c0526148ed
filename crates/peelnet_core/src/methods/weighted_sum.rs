//! `weighted-sum`: Meshkin, "Sort-Independent Alpha Blending", GDC 2007.

use crate::fragment::Fragment;

/// `Σ C_i + C_0 (1 − Σ α_i)`. May leave the gamut: that is the method's known flaw.
pub fn composite(fragments: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    let alpha: f32 = fragments.iter().map(|f| f.alpha).sum();
    let mut sum = [0.0f32; 3];
    for f in fragments {
        for (s, c) in sum.iter_mut().zip(f.premultiplied()) {
            *s += c;
        }
    }
    std::array::from_fn(|k| sum[k] + background[k] * (1.0 - alpha))
}
