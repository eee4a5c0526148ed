//! Which rows train, which choose, and which judge.
//!
//! A split is never stored: it follows from a seed and the names of scenes or the pixel's place, so that the same pixel is in the
//! same subset in every format, shard and batch. Scenes are split whole where there is more than one, because the pixels of a scene
//! say much about one another; pixels are always split whole, because the fragments of one say almost everything about one another.
//! Scenes that are marked held-out are not trained on at all.

use std::collections::BTreeMap;

use peelnet_core::hash::{pcg, pixel_hash};
use serde::{Deserialize, Serialize};

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

/// What stays together when rows are set aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SplitBy {
    /// Whole scenes, where there are enough of them; else pixels.
    Scene,
    /// Whole pixels, of every scene alike: what the rows that are set aside say of other scenes is little.
    #[default]
    Pixel,
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
    /// If the fractions are negative, not numbers, or more than 1 together.
    pub fn new(seed: u64, validation: f64, test: f64) -> Result<Self, DatasetError> {
        if !(validation >= 0.0 && test >= 0.0 && validation + test <= 1.0) {
            return Err(DatasetError::Setting(format!(
                "split {validation} for validation and {test} for testing: both must be 0 or more, and together at most 1"
            )));
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

    /// Whole scenes for each subset, by name: in an order drawn from the seed, scenes are set aside for testing until they have the
    /// share of the rows that is asked, then for validation, the others train. `None` where there are too few for one in each
    /// subset that is asked.
    pub fn scenes<'a>(&self, rows: &BTreeMap<&'a str, u64>) -> Option<BTreeMap<&'a str, Subset>> {
        let asked = [
            (Subset::Test, self.test),
            (Subset::Validation, self.validation),
        ];
        let mut asked = asked.to_vec();
        asked.retain(|(_, share)| *share > 0.0);
        if rows.len() <= asked.len() {
            return None;
        }
        let total = rows.values().fold(0u64, |a, &b| a.saturating_add(b)) as f64;
        let step = |hash, byte| pcg(hash ^ u32::from(byte));
        let hash = |name: &str| name.bytes().fold(self.mixed_seed(), step);
        let order = rows.iter().map(|(&name, &n)| (hash(name), name, n));
        let mut order: Vec<(u32, &str, u64)> = order.collect();
        order.sort_unstable();
        let mut subsets = BTreeMap::new();
        let mut taken = 0.0;
        for (k, &(_, name, n)) in order.iter().enumerate() {
            // One scene is left for every subset behind this one, training among them.
            let left = order.len() - k;
            while let Some(&(_, share)) = asked.first() {
                // Rounding of a share times a total, in rows.
                if taken > 0.0 && (taken >= share * total - 0.5 || left <= asked.len()) {
                    asked.remove(0);
                    taken = 0.0;
                } else {
                    break;
                }
            }
            let subset = asked.first().map_or(Subset::Train, |(subset, _)| *subset);
            subsets.insert(name, subset);
            taken += n.max(1) as f64;
        }
        Some(subsets)
    }

    /// A split that gives every pixel to one subset.
    pub fn whole(subset: Subset) -> Self {
        let fraction = |other: Subset| if subset == other { 1.0 } else { 0.0 };
        Self {
            seed: 0,
            validation: fraction(Subset::Validation),
            test: fraction(Subset::Test),
        }
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

    /// Shares of scenes of equal size are met to one scene, no subset that is asked is empty, every seed draws others, and a scene
    /// keeps its place whatever the number of its rows.
    #[test]
    fn whole_scenes_are_set_aside() {
        let names: Vec<String> = (0..12).map(|k| format!("s{k}")).collect();
        let rows: BTreeMap<&str, u64> = names.iter().map(|n| (n.as_str(), 50)).collect();
        let count =
            |subsets: &BTreeMap<&str, Subset>, s| subsets.values().filter(|t| **t == s).count();
        let split = |seed| Split::new(seed, 0.25, 1.0 / 3.0).unwrap();
        let third = split(3).scenes(&rows).unwrap();
        let counts = [Subset::Test, Subset::Validation, Subset::Train].map(|s| count(&third, s));
        assert_eq!(counts, [4, 3, 5]);
        assert_ne!(third, split(4).scenes(&rows).unwrap());
        // The smallest shares take a scene, and the largest leave one.
        for (validation, test) in [(1e-6, 1e-6), (0.49, 0.5), (0.0, 0.999), (0.999, 0.0)] {
            for scenes in 2..12 {
                let rows: BTreeMap<&str, u64> =
                    rows.iter().take(scenes).map(|(a, b)| (*a, *b)).collect();
                let split = Split::new(1, validation, test).unwrap();
                let asked = usize::from(validation > 0.0) + usize::from(test > 0.0);
                let Some(subsets) = split.scenes(&rows) else {
                    assert!(scenes <= asked, "{scenes}");
                    continue;
                };
                assert!(count(&subsets, Subset::Train) > 0, "{scenes}");
                assert_eq!(count(&subsets, Subset::Test) > 0, test > 0.0);
                assert_eq!(count(&subsets, Subset::Validation) > 0, validation > 0.0);
            }
        }
        for subset in [Subset::Train, Subset::Validation, Subset::Test] {
            assert_eq!(Split::whole(subset).pixel(3, 4, 5), subset);
        }
        for (validation, test) in [(-0.1, 0.2), (0.6, 0.6), (f64::NAN, 0.1)] {
            assert!(Split::new(0, validation, test).is_err());
        }
    }
}
