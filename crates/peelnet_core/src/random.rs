//! Random numbers that never change: scenes, datasets and weights made from a seed must be the same with every version of
//! every library.

/// SplitMix64 (Steele, Lea & Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A stream for a seed and any number of words that tell streams apart.
    pub fn new(seed: u64, words: &[u64]) -> Self {
        let mut random = Self(seed);
        for &word in words {
            random.0 = random.word() ^ word;
        }
        random
    }

    /// 64 random bits.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly from 0 (inclusive) to 1 (exclusive), 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Evenly from `low` to `high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + self.unit() * (high - low)
    }

    /// Evenly on a logarithmic scale from `low` to `high`, both positive.
    pub fn log_between(&mut self, low: f32, high: f32) -> f32 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A whole number below `n`, for small `n`.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f32) as usize).min(n.saturating_sub(1))
    }

    /// A colour.
    pub fn color(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    /// `0..n` in random order (Fisher and Yates).
    pub fn permutation(&mut self, n: u32) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n).collect();
        for i in (1..n).rev() {
            // By multiplication: the bias is below `i / 2⁶⁴`.
            let j = (u128::from(self.word()) * u128::from(i + 1)) >> 64;
            order.swap(i as usize, j as usize);
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published first outputs of SplitMix64 with seed 0.
    #[test]
    fn it_is_splitmix64() {
        let mut r = Random(0);
        assert_eq!(r.word(), 0xe220_a839_7b1d_cdaf);
        assert_eq!(r.word(), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn a_permutation_holds_every_index_once() {
        let mut order = Random::new(7, &[]).permutation(1000);
        assert_ne!(order[..3], [0, 1, 2]);
        order.sort_unstable();
        assert_eq!(order, (0..1000).collect::<Vec<_>>());
        assert_eq!(Random::new(7, &[]).permutation(0), Vec::<u32>::new());
    }
}
