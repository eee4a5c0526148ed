//! Random numbers from a seed: the one generator behind scenes, datasets, initial weights and tests.
//!
//! The numbers are part of what a seed means: a scene, dataset or model made from a seed must be the same on every platform. ChaCha
//! with 8 rounds is fully specified, and `rand_chacha` implements it portably. `rand` makes floats, ranges and shuffles of its output;
//! it promises the same values within 0.10, and a test here holds them, so that a later version that draws others is noticed.

use rand::{Rng, RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream of a seed and any number of words that distinguish its streams.
    pub fn new(seed: u64, words: &[u64]) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut random = Self(ChaCha8Rng::from_seed(key));
        for word in words {
            // Each word and 192 bits of the stream so far are the key of the next stream.
            key[..8].copy_from_slice(&word.to_le_bytes());
            random.0.fill_bytes(&mut key[8..]);
            random.0 = ChaCha8Rng::from_seed(key);
        }
        random
    }

    pub fn word(&mut self) -> u64 {
        self.0.next_u64()
    }

    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Uniform from 0 (inclusive) to 1 (exclusive), in steps of 2⁻²⁴.
    pub fn unit(&mut self) -> f32 {
        self.0.random()
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + self.unit() * (high - low)
    }

    /// Uniform on a logarithmic scale from `low` to `high`, both positive.
    pub fn log_between(&mut self, low: f32, high: f32) -> f32 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A whole number below `n`; 0 if `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { self.0.random_range(0..n) }
    }

    pub fn color(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    pub fn permutation(&mut self, n: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n).collect();
        order.shuffle(&mut self.0);
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ChaCha8 with an all-zero key and nonce: the first words of the published test vector (draft-strombergson-chacha-test-vectors,
    /// TC1, 256-bit key, 8 rounds).
    #[test]
    fn it_is_chacha8() {
        let mut random = Random::new(0, &[]);
        assert_eq!(random.bits(), u32::from_le_bytes([0x3e, 0x00, 0xef, 0x2f]));
        assert_eq!(random.bits(), u32::from_le_bytes([0x89, 0x5f, 0x40, 0xd6]));
    }

    /// Frozen: scenes, datasets and models of a seed change with these numbers.
    #[test]
    fn the_numbers_of_a_seed_never_change() {
        let mut random = Random::new(7, &[1]);
        assert_eq!(random.word(), 4_123_389_294_907_654_205);
        let units = [random.unit(), random.between(-1.0, 1.0)];
        assert_eq!(units, [0.172_458_17, 0.452_397_47]);
        let below = [5, 1000, 1 << 40].map(|n| random.below(n));
        assert_eq!(below, [4, 341, 540_129_913_387]);
        assert_eq!(random.permutation(8), [2, 7, 1, 6, 0, 4, 5, 3]);
        assert_eq!((random.below(0), random.permutation(0)), (0, vec![]));
    }

    #[test]
    fn streams_differ_by_seed_words_and_their_order() {
        let first = |seed, words: &[u64]| Random::new(seed, words).word();
        let all = [
            first(1, &[]),
            first(2, &[]),
            first(1, &[1]),
            first(1, &[0]),
            first(1, &[1, 2]),
            first(1, &[2, 1]),
            first(0, &[1]),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(!all[..i].contains(a), "stream {i}");
        }
    }
}
