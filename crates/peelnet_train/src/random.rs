//! The generator behind initial weights, the split and the order of rows.
//!
//! Our own, because a library's generator may change between versions and the same seed must keep its weights.

/// SplitMix64 (Steele, Lea, Flood: "Fast Splittable Pseudorandom Number Generators", 2014).
pub(crate) struct Random {
    state: u64,
}

/// What a stream of numbers is for: streams of one seed must not overlap.
#[derive(Clone, Copy)]
pub(crate) enum Stream {
    Weights,
    Split,
    /// The order of rows in an epoch.
    Order(u32),
}

impl Random {
    pub(crate) fn new(seed: u64, stream: Stream) -> Self {
        let (kind, index) = match stream {
            Stream::Weights => (1, 0),
            Stream::Split => (2, 0),
            Stream::Order(epoch) => (3, u64::from(epoch)),
        };
        let mut random = Self { state: seed };
        for word in [kind, index] {
            random.state = random.next() ^ word;
        }
        random
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `[-1, 1)`, 24 bits.
    pub(crate) fn signed_unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 8_388_608.0 - 1.0
    }

    /// Uniform in `0..bound`, by multiplication: the bias is below `bound / 2⁶⁴`.
    fn below(&mut self, bound: u32) -> u32 {
        ((u128::from(self.next()) * u128::from(bound)) >> 64) as u32
    }

    /// `0..n` in random order (Fisher and Yates).
    pub(crate) fn permutation(&mut self, n: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i as usize, self.below(i + 1) as usize);
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_holds_every_index_once_and_depends_on_the_epoch() {
        let a = Random::new(7, Stream::Order(1)).permutation(1000);
        let b = Random::new(7, Stream::Order(2)).permutation(1000);
        assert_ne!(a, b);
        assert_eq!(a, Random::new(7, Stream::Order(1)).permutation(1000));
        let mut sorted = a;
        sorted.sort_unstable();
        assert_eq!(sorted, (0..1000).collect::<Vec<_>>());
        assert_eq!(
            Random::new(7, Stream::Split).permutation(0),
            Vec::<u32>::new()
        );
    }

    /// Frozen, because released weights can only be made again if this never changes.
    #[test]
    fn the_stream_never_changes() {
        assert_eq!(
            Random::new(42, Stream::Order(3)).permutation(8),
            [7, 5, 3, 4, 2, 1, 0, 6]
        );
    }
}
