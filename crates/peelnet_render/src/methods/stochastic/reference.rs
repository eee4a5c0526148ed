//! `stochastic-s`: screen-door samples with alpha correction (Enderton, Sintorn, Shirley & Luebke 2010). The shader of
//! [`covered`] is `methods/stochastic/samples.wgsl`.

use peelnet_core::{
    fragment::Fragment,
    hash::{pcg, pixel_hash},
};

/// Share of a fragment's opacity that counts though no sample sees it: where none sees anything, the average colour stands in.
pub const UNSEEN: f32 = 1.0 / 4096.0;

/// The samples, of a power of two of them, that a fragment covers: as many as its opacity asks for, rounded up or down at
/// random, on a random walk with an odd stride. Every sample is as likely as any other, whatever other fragments cover, so
/// that the expected share of samples that see a fragment is `α_i T_i`.
pub fn covered(
    alpha: f32,
    samples: u32,
    triangle: u32,
    [x, y]: [u32; 2],
) -> impl Iterator<Item = u32> {
    let h = pixel_hash(0, triangle, x, y);
    let count = (alpha * samples as f32 + (h >> 8) as f32 / 16_777_216.0) as u32;
    let walk = pcg(h);
    let stride = (walk >> 16) | 1;
    (0..count.min(samples)).map(move |t| walk.wrapping_add(t.wrapping_mul(stride)) & (samples - 1))
}

/// Composites a pixel at a place of the frame.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    samples: u32,
    pixel: [u32; 2],
) -> [f32; 3] {
    let mut nearest = vec![f32::INFINITY; samples as usize];
    let covered = |f: &Fragment| covered(f.alpha, samples, f.triangle, pixel);
    for f in fragments {
        for s in covered(f) {
            let depth = &mut nearest[s as usize];
            *depth = depth.min(f.depth);
        }
    }
    let (mut sums, mut transmittance) = ([0.0f32; 4], 1.0f32);
    for f in fragments {
        let seen = covered(f)
            .filter(|&s| nearest[s as usize] == f.depth)
            .count();
        let weight = seen as f32 / samples as f32 + UNSEEN * f.alpha;
        for (sum, c) in sums.iter_mut().zip(f.color) {
            *sum += c * weight;
        }
        sums[3] += weight;
        transmittance *= 1.0 - f.alpha;
    }
    if transmittance == 1.0 {
        return background;
    }
    let scale = (1.0 - transmittance) / sums[3].max(f32::MIN_POSITIVE);
    std::array::from_fn(|k| sums[k] * scale + background[k] * transmittance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over many pixels of the share of samples that see a fragment is `α_i T_i`: the error falls with the root of
    /// their number. Four standard deviations of a share of samples, which is at most a half wide.
    #[test]
    fn it_is_right_on_average() {
        let f: Vec<_> = (0..6)
            .map(|i| Fragment {
                triangle: i,
                ..Fragment::new(1.0 + i as f32, 0.15 + 0.1 * i as f32, [1.0; 3])
            })
            .collect();
        let (pixels, samples) = (4096u32, 4u32);
        let mut seen = [0u32; 6];
        for p in 0..pixels {
            let mut nearest = [usize::MAX; 4];
            for (i, f) in f.iter().enumerate() {
                for s in covered(f.alpha, samples, f.triangle, [p % 64, p / 64]) {
                    nearest[s as usize] = nearest[s as usize].min(i);
                }
            }
            for i in nearest.into_iter().filter(|&i| i < 6) {
                seen[i] += 1;
            }
        }
        let mut transmittance = 1.0;
        for (f, seen) in f.iter().zip(seen) {
            let share = f64::from(seen) / f64::from(pixels * samples);
            let want = f64::from(f.alpha) * transmittance;
            let bound = 4.0 * 0.5 / f64::from(pixels).sqrt();
            assert!((share - want).abs() < bound, "{share} {want}");
            transmittance *= 1.0 - f64::from(f.alpha);
        }
    }
}
