//! `wboit-*`: McGuire & Bavoil 2013, eq 6 — weighted average colour with the exact coverage.

use crate::fragment::Fragment;
use crate::weights::Weight;

/// What one geometry pass accumulates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sums {
    /// `Σ C_i w_i`.
    pub color: [f32; 3],
    /// `Σ α_i w_i`.
    pub alpha: f32,
    /// `T_∞ = ∏ (1 − α_i)`.
    pub transmittance: f32,
}

impl Sums {
    pub fn of(fragments: &[Fragment], mut weight: impl FnMut(&Fragment) -> f32) -> Self {
        let mut sums = Self {
            color: [0.0; 3],
            alpha: 0.0,
            transmittance: 1.0,
        };
        for f in fragments {
            let w = weight(f);
            for (s, c) in sums.color.iter_mut().zip(f.premultiplied()) {
                *s += c * w;
            }
            sums.alpha += f.alpha * w;
            sums.transmittance *= 1.0 - f.alpha;
        }
        sums
    }
}

/// What the shader of Papakostas' thesis (Ioannina 2022) accumulates as it is printed: `Σ C_i w_i` against `Σ w_i`, and
/// `∏ (1 − w_i)` in the place of `T_∞`. A weight above 1 lets no light through, as one that is blended into a fixed-point target.
///
/// ```
/// use peelnet_core::{fragment::Fragment, methods::wboit};
///
/// // One surface with w = α: its colour is darkened by α once more.
/// let surface = Fragment::new(2.0, 0.5, [0.8, 0.4, 0.0]);
/// let sums = wboit::printed(&[surface], |f| f.alpha);
/// assert_eq!(wboit::normalised(&sums, [1.0; 3]), [0.7, 0.6, 0.5]);
/// ```
pub fn printed(fragments: &[Fragment], mut weight: impl FnMut(&Fragment) -> f32) -> Sums {
    let mut sums = Sums::of(fragments, &mut weight);
    (sums.alpha, sums.transmittance) = (0.0, 1.0);
    for f in fragments {
        let w = weight(f);
        sums.alpha += w;
        sums.transmittance *= 1.0 - w.clamp(0.0, 1.0);
    }
    sums
}

/// The resolve that all normalised methods share: `(Σ C w / Σ α w)(1 − T_∞) + C_0 T_∞`.
///
/// A pixel with `T_∞ = 1` keeps `C_0` bit for bit.
pub fn normalised(sums: &Sums, background: [f32; 3]) -> [f32; 3] {
    let t = sums.transmittance;
    if t == 1.0 {
        return background;
    }
    let average = sums.color.map(|c| c / sums.alpha.max(f32::MIN_POSITIVE));
    std::array::from_fn(|k| average[k] * (1.0 - t) + background[k] * t)
}

/// `(Σ C_i w_i / Σ α_i w_i)(1 − T_∞) + C_0 T_∞` with a published weight.
pub fn composite(fragments: &[Fragment], background: [f32; 3], weight: Weight) -> [f32; 3] {
    let w = |f: &Fragment| weight.eval(f.depth, f.alpha, f.window_depth);
    normalised(&Sums::of(fragments, w), background)
}
