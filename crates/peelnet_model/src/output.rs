//! What a network answers.

use std::fmt;

use num_traits::Float;
use peelnet_core::guards::{ROOT_ABSORBANCE_LIMIT, WEIGHT_FLOOR};
use serde::{Deserialize, Serialize};

/// The inputs of a network with [`Output::BoundedShare`] that hold the bounds.
pub const BOUNDS: [usize; 2] = [3, 4];

/// What the network's output means, and how it is kept in range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// T_i, kept in [`WEIGHT_FLOOR`] … 1.
    Transmittance,
    /// The share of the rest's absorbance (all but the fragment and the pixel's ends) that lies in front, kept in 0 … 1; the
    /// nearest and the farthest fragment are known without it.
    AnchoredShare,
    /// The same, where the nearest and the farthest fragment accumulate apart.
    AnchoredShareSeparateEnds,
    /// Where between its bounds (inputs [`BOUNDS`]) the share of the absorbance lies that is in front, kept in 0 … 1.
    BoundedShare,
    /// Linear RGB of all transparent fragments of a pixel over black, kept in 0 … 1.
    Color,
}

impl Output {
    /// The number of values.
    pub const fn count(self) -> usize {
        match self {
            Self::Color => 3,
            _ => 1,
        }
    }

    /// The smallest and the largest value after the guard.
    pub const fn range(self) -> (f32, f32) {
        match self {
            Self::Transmittance => (WEIGHT_FLOOR, 1.0),
            _ => (0.0, 1.0),
        }
    }

    /// Whether the value is a share of absorbance `r`, and the function answers with its transmittance `exp(−r s)`.
    pub const fn is_fraction(self) -> bool {
        !matches!(self, Self::Transmittance | Self::Color)
    }

    /// The transmittance that an answer stands for where it is a share ([`Output::is_fraction`]), given the raw inputs: `exp(−x² s)` with the first
    /// input `x`, the root of an absorbance, which is kept in 0 … [`ROOT_ABSORBANCE_LIMIT`]; bounds are kept in 0 … 1.
    ///
    /// # Panics
    /// With fewer inputs than such networks have.
    pub fn transmittance(self, raw_inputs: &[f64], answer: f64) -> f64 {
        let root = raw_inputs[0].clamp(0.0, ROOT_ABSORBANCE_LIMIT.into());
        let mut share = answer;
        if self == Self::BoundedShare {
            let [low, high] = BOUNDS.map(|k| raw_inputs[k].clamp(0.0, 1.0));
            share = low + (high - low) * answer;
        }
        (-root.powi(2) * share).exp()
    }

    /// Keeps one value of the network in range; NaN becomes the smallest value.
    pub(crate) fn guard<F: Float + From<f32>>(self, value: F) -> F {
        let (low, high) = self.range();
        value.max(low.into()).min(high.into())
    }
}

/// The name in files.
impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}
