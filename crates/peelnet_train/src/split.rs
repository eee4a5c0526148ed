//! Which examples are held out.

use peelnet_dataset::Subset;

use crate::streams::Stream;
use crate::task::Part;

/// Indices of the examples of each part, ascending.
pub(crate) struct Split {
    pub(crate) train: Vec<u32>,
    pub(crate) validation: Vec<u32>,
    pub(crate) test: Vec<u32>,
}

impl Split {
    /// The examples of a part.
    pub(crate) fn part(&self, part: Part) -> &[u32] {
        match part {
            Part::Train => &self.train,
            Part::Validation => &self.validation,
            Part::Test => &self.test,
        }
    }

    /// Draws `⌊n·share⌋` examples for testing at random from the seed. At least one example is left for training.
    pub(crate) fn random(n: u32, share: f64, seed: u64) -> Self {
        let held_out = (f64::from(n) * share) as usize;
        let order = Stream::Split.of(seed).permutation(n);
        let (test, train) = order.split_at(held_out.min((n as usize).saturating_sub(1)));
        let sorted = |part: &[u32]| {
            let mut part = part.to_vec();
            part.sort_unstable();
            part
        };
        Self {
            train: sorted(train),
            validation: Vec::new(),
            test: sorted(test),
        }
    }

    /// As the subsets say.
    pub(crate) fn of(subsets: &[Subset]) -> Self {
        let examples = |wanted: Subset| {
            (0u32..)
                .zip(subsets)
                .filter(|&(_, &subset)| subset == wanted)
                .map(|(example, _)| example)
                .collect()
        };
        Self {
            train: examples(Subset::Train),
            validation: examples(Subset::Validation),
            test: examples(Subset::Test),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_is_held_out_and_no_row_is_lost() {
        let Split { train, test, .. } = Split::random(3000, 1.0 / 3.0, 5);
        assert_eq!((train.len(), test.len()), (2000, 1000));
        let mut all: Vec<u32> = train.into_iter().chain(test).collect();
        all.sort_unstable();
        assert_eq!(all, (0..3000).collect::<Vec<_>>());
        let one = Split::random(1, 0.9, 5);
        assert_eq!((one.train.len(), one.test.len()), (1, 0));
        let named = Split::of(&[
            Subset::Train,
            Subset::Test,
            Subset::Validation,
            Subset::Train,
        ]);
        assert_eq!(
            (named.train, named.validation, named.test),
            (vec![0, 3], vec![2], vec![1])
        );
    }
}
