//! `bins-N`: absorbance in front of a depth in N intervals between the nearest and the farthest fragment of a pixel, cumulative, and
//! linear within an interval.
//!
//! Sources: the write-up of order-independent transparency by Osorio López (osor.io/OIT) has the bounds of a pixel by MAX blending, and
//! takes a fragment's own share out; a widely played block game ships eight bins of that kind (2026). From there are N = 8, the
//! cap of 4 on a fragment's absorbance, and α > 0.99 as opaque.
//! Ours: depth is warped as for the other methods; coverage is the exact `T_∞` in a target of its own, not what the last bin
//! holds; "opaque" raises what such a fragment hides, to [`ABSORBANCE_MAX`], and leaves its opacity, so that one surface stays exact.

use crate::methods::bins::range::{Bounds, places};
use peelnet_core::absorbance::{ABSORBANCE_MAX, DepthWarp, absorbance};

/// Fragments of more opacity hide all that is behind them.
const OPAQUE: f32 = 0.99;

/// The most absorbance that any other fragment adds: e⁻⁴ is 2 % of the light.
const ABSORBANCE_CAP: f64 = 4.0;

/// The estimated transmittance in front of each of a pixel's fragments, given as (linear depth, α).
pub fn transmittances(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    bins: usize,
    bounds: Bounds,
) -> Vec<f64> {
    let zetas = fragments.iter().map(|&(z, _)| warp.apply(z.into()));
    let places = places(bounds, &zetas.collect::<Vec<_>>());
    let point = |(place, &(_, alpha)): (f64, &(f32, f32))| {
        let position = place * bins as f64;
        let bin = (position as usize).min(bins - 1);
        let b = if alpha > OPAQUE {
            ABSORBANCE_MAX
        } else {
            absorbance(alpha).min(ABSORBANCE_CAP)
        };
        (bin, position - bin as f64, b)
    };
    let points: Vec<_> = places.into_iter().zip(fragments).map(point).collect();
    // Absorbance up to the far end of every bin, behind a zero.
    let mut up_to = vec![0.0; bins + 1];
    for &(bin, _, b) in &points {
        for sum in &mut up_to[bin + 1..] {
            *sum += b;
        }
    }
    let in_front = points.iter().map(|&(bin, t, b)| {
        let (before, after) = (up_to[bin], up_to[bin + 1]);
        // Its own share: nothing at the near end of its bin, all of it at the far end.
        before + (after - before - b) * t
    });
    in_front.map(|b| (-b).exp().min(1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warp() -> DepthWarp {
        DepthWarp::new(1.0, 100.0)
    }

    /// Fragments in bins of their own: before each of them lies exactly what is nearer, at the ends and within bins.
    #[test]
    fn separate_fragments_are_exact() {
        for bins in [4, 8, 16] {
            let f: Vec<(f32, f32)> = (0..bins)
                .map(|i| {
                    // At the ends of the range, and at another place of every bin between.
                    let t = (i as f64 + i as f64 / (bins as f64 - 1.0)) / bins as f64;
                    (100f64.powf(t) as f32, 0.3)
                })
                .collect();
            for bounds in [Bounds::Pixel, Bounds::Frame] {
                let t = transmittances(&f, &warp(), bins, bounds);
                for (i, t) in t.iter().enumerate() {
                    // 32-bit depths: an error of 1e-6 of place, times bins, times absorbance.
                    let want = 0.7f64.powi(i as i32);
                    assert!((t - want).abs() < 1e-5, "{bins} {i}: {t} for {want}");
                }
            }
        }
    }

    /// Two fragments of one bin: the farther one sees the share of the nearer that its place in the bin says.
    #[test]
    fn a_bin_is_linear() {
        let warp = DepthWarp::new(1.0, std::f64::consts::E);
        let at = |t: f64| t.exp() as f32;
        // Four bins over the frame: places 0.25 and 0.75 of the second.
        let f = [(at(0.3125), 0.5), (at(0.4375), 0.5)];
        let t = transmittances(&f, &warp, 4, Bounds::Frame);
        let half = std::f64::consts::LN_2;
        assert!((t[0] - (-0.25 * half).exp()).abs() < 1e-6);
        assert!((t[1] - (-0.75 * half).exp()).abs() < 1e-6);
    }

    /// As shipped: nothing but an opaque fragment hides more than 98 % of what is behind it.
    #[test]
    fn absorbance_is_capped() {
        let behind = |alpha: f32| {
            let f = [(1.0, alpha), (3.0, 0.5)];
            transmittances(&f, &warp(), 8, Bounds::Pixel)[1]
        };
        assert!((behind(0.5) - 0.5).abs() < 1e-12);
        assert!((behind(0.985) - f64::exp(-4.0)).abs() < 1e-12);
        assert!((behind(0.991) - f64::exp(-16.0)).abs() < 1e-12);
    }
}
