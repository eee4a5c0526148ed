//! Which examples are held out.

use crate::random::{Random, Stream};

/// Indices of the training and of the held-out examples, both ascending.
pub(crate) struct Split {
    pub(crate) train: Vec<u32>,
    pub(crate) test: Vec<u32>,
}

impl Split {
    /// Draws `⌊n·share⌋` examples at random from the seed. At least one example is left for training.
    pub(crate) fn random(n: u32, share: f64, seed: u64) -> Self {
        let held_out = (f64::from(n) * share) as usize;
        let order = Random::new(seed, Stream::Split).permutation(n);
        let (test, train) = order.split_at(held_out.min((n as usize).saturating_sub(1)));
        let sorted = |part: &[u32]| {
            let mut part = part.to_vec();
            part.sort_unstable();
            part
        };
        Self {
            train: sorted(train),
            test: sorted(test),
        }
    }

    /// As the mask says: true is held out.
    pub(crate) fn from_mask(held_out: &[bool]) -> Self {
        let rows = |wanted: bool| {
            (0u32..)
                .zip(held_out)
                .filter(|&(_, &held_out)| held_out == wanted)
                .map(|(row, _)| row)
                .collect()
        };
        Self {
            train: rows(false),
            test: rows(true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_is_held_out_and_no_row_is_lost() {
        let Split { train, test } = Split::random(3000, 1.0 / 3.0, 5);
        assert_eq!((train.len(), test.len()), (2000, 1000));
        let mut all: Vec<u32> = train.into_iter().chain(test).collect();
        all.sort_unstable();
        assert_eq!(all, (0..3000).collect::<Vec<_>>());
        let one = Split::random(1, 0.9, 5);
        assert_eq!((one.train.len(), one.test.len()), (1, 0));
        let mask = Split::from_mask(&[false, true, false]);
        assert_eq!((mask.train, mask.test), (vec![0, 2], vec![1]));
    }
}
