//! A small integer hash that shaders can compute too: it decides which pixels a sampled extraction keeps.

/// PCG's output permutation over a 32-bit word (Jarzynski & Olano, "Hash Functions for GPU Rendering", 2020).
pub const fn pcg(v: u32) -> u32 {
    let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Whether the pixel (x, y) of a view belongs to a sample: `hash(seed, view, x, y) < threshold`.
///
/// [`sample_threshold`] turns a fraction into the threshold. The shader twin is `helpers/hash.wgsl`.
pub const fn pixel_hash(seed: u32, view: u32, x: u32, y: u32) -> u32 {
    pcg(pcg(pcg(pcg(seed) ^ view) ^ x) ^ y)
}

/// The threshold that keeps about `fraction` of all pixels; 1 keeps every one (the comparison is `≤`).
pub fn sample_threshold(fraction: f64) -> u32 {
    (fraction.clamp(0.0, 1.0) * f64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kept fraction is binomial: five standard deviations of `n = 10⁶` draws are 5·√(p(1−p)/n).
    #[test]
    fn a_fraction_is_kept() {
        for p in [0.01, 0.25, 0.9] {
            let limit = sample_threshold(p);
            let kept = (0..1000)
                .flat_map(|y| (0..1000).map(move |x| pixel_hash(3, 1, x, y)))
                .filter(|&h| h <= limit)
                .count() as f64
                / 1e6;
            assert!(
                (kept - p).abs() < 5.0 * (p * (1.0 - p) / 1e6f64).sqrt(),
                "{p}: {kept}"
            );
        }
        assert_eq!(sample_threshold(1.0), u32::MAX);
    }
}
