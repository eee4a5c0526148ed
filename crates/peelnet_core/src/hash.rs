//! A small integer hash that shaders can compute too: it decides which pixels a sampled extraction keeps.

/// PCG's output permutation over a 32-bit word (Jarzynski & Olano, "Hash Functions for GPU Rendering", 2020).
pub const fn pcg(v: u32) -> u32 {
    let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Whether the pixel (x, y) of a view belongs to a sample: `hash(seed, view, x, y) < threshold`.
///
/// [`sample_threshold`] turns a fraction into the threshold. The shader is `helpers/hash.wgsl`.
pub const fn pixel_hash(seed: u32, view: u32, x: u32, y: u32) -> u32 {
    pcg(pcg(pcg(pcg(seed) ^ view) ^ x) ^ y)
}

/// The threshold that keeps about `fraction` of all pixels; 1 keeps every one (the comparison is `≤`).
pub fn sample_threshold(fraction: f64) -> u32 {
    (fraction.clamp(0.0, 1.0) * f64::from(u32::MAX)) as u32
}
