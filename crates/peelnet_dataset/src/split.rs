//! Which rows train, which choose, and which judge.
//!
//! A split is never stored: it follows from a seed and the pixel's place, so that the same pixel is in the same
//! subset in every format, shard and batch. Pixels are split whole, because the fragments of one pixel say almost
//! everything about one another. Scenes that are marked held-out are not trained on at all.

use peelnet_core::hash::{pcg, pixel_hash};
use serde::{Deserialize, Serialize};

use crate::batch::FragmentBatch;
use crate::error::DatasetError;

/// What a pixel is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subset {
    /// Gradients come from these.
    Train,
    /// Choices (early stop, best checkpoint) come from these.
    Validation,
    /// Reported only.
    Test,
    /// Of a scene that is not trained on; reported only.
    HeldOut,
}

/// A deterministic assignment of pixels to subsets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Split {
    /// Seed of the assignment.
    pub seed: u64,
    /// Fraction of the pixels for validation.
    pub validation: f64,
    /// Fraction of the pixels for testing.
    pub test: f64,
}

impl Split {
    /// A split with these fractions; the rest trains.
    ///
    /// # Errors
    /// [`DatasetError::Split`] if the fractions are negative, not numbers, or more than 1 together.
    pub fn new(seed: u64, validation: f64, test: f64) -> Result<Self, DatasetError> {
        if !(validation >= 0.0 && test >= 0.0 && validation + test <= 1.0) {
            return Err(DatasetError::Split { validation, test });
        }
        Ok(Self {
            seed,
            validation,
            test,
        })
    }

    /// The subset of a pixel of a scene that is not held out.
    pub fn pixel(&self, view: u32, x: u32, y: u32) -> Subset {
        let u = f64::from(pixel_hash(self.mixed_seed(), view, x, y)) / 4_294_967_296.0;
        if u < self.test {
            Subset::Test
        } else if u < self.test + self.validation {
            Subset::Validation
        } else {
            Subset::Train
        }
    }

    /// The subset of every row of a batch, of a scene that is not held out.
    pub fn rows(&self, batch: &FragmentBatch) -> Vec<Subset> {
        let mut subsets = Vec::with_capacity(batch.len());
        for pixel in batch.pixels() {
            let i = pixel.start;
            let subset = self.pixel(batch.view[i], batch.x[i], batch.y[i]);
            subsets.resize(pixel.end, subset);
        }
        subsets
    }

    /// The seed for the pixels' hash. The sampling of an extraction keeps pixels by the same hash, usually with the
    /// same seed: used as it is, the split would see only the hashes below the sampling's threshold and give all of
    /// them to one subset.
    fn mixed_seed(&self) -> u32 {
        pcg(self.seed as u32 ^ 0x5eed_5b11) ^ pcg((self.seed >> 32) as u32 ^ 0x7e57_0a1d)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use peelnet_core::hash::sample_threshold;

    /// The share of a subset among n pixels is binomial: five standard deviations are 5·√(p(1−p)/n).
    fn assert_share(found: usize, n: usize, p: f64) {
        let share = found as f64 / n as f64;
        let limit = 5.0 * (p * (1.0 - p) / n as f64).sqrt();
        assert!((share - p).abs() < limit, "{share} where {p} was asked");
    }

    #[test]
    fn fractions_hold_also_among_sampled_pixels() {
        for seed in [0, 1, u64::MAX] {
            let split = Split::new(seed, 0.1, 0.33).unwrap();
            let limit = sample_threshold(0.2);
            let sampled: Vec<Subset> = (0..400 * 400)
                .map(|k| (k % 400, k / 400))
                .filter(|&(x, y)| pixel_hash(seed as u32, 3, x, y) <= limit)
                .map(|(x, y)| split.pixel(3, x, y))
                .collect();
            let count = |s| sampled.iter().filter(|&&t| t == s).count();
            assert_share(count(Subset::Test), sampled.len(), 0.33);
            assert_share(count(Subset::Validation), sampled.len(), 0.1);
        }
    }

    #[test]
    fn impossible_fractions_are_refused() {
        for (validation, test) in [(-0.1, 0.2), (0.6, 0.6), (f64::NAN, 0.1)] {
            assert!(Split::new(0, validation, test).is_err());
        }
        let split = Split::new(0, 0.0, 1.0).unwrap();
        assert_eq!(split.pixel(0, 1, 2), Subset::Test);
    }
}
