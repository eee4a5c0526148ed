//! `avboit`: absorbance in a view-aligned grid of voxels, each a block of pixels and a slice of depth.
//!
//! Source: Epic Games' documentation of adaptive voxel-based order-independent transparency, which describes a volume of low resolution whose
//! transmittance surfaces look up. Its shaders were not read. Ours: blocks of 8 × 8 pixels and 64 slices by default, the mean absorbance of a
//! block's pixels, linear between blocks and slices; slices of equal ratio of depth over what transparent objects span, as other methods
//! have; the slice of the fragment itself does not count, so that it does not hide itself; coverage is the exact `T_∞`.

use peelnet_core::absorbance::{DepthWarp, absorbance};

/// Absorbances are added in whole numbers of this: the sum does not depend on the order.
pub const UNIT: f64 = 1.0 / 2048.0;

/// The estimated transmittance in front of each of a pixel's fragments, given as (linear depth, α), where all pixels around are like this one.
pub fn transmittances(fragments: &[(f32, f32)], warp: &DepthWarp, slices: usize) -> Vec<f64> {
    let depth = |z: f32| (warp.apply(z.into()) * 0.5 + 0.5) * slices as f64;
    // Absorbance up to the near end of each slice, and behind the last.
    let mut up_to = vec![0.0; slices + 1];
    for &(z, alpha) in fragments {
        let slice = (depth(z) as usize).min(slices - 1);
        let b = (absorbance(alpha) / UNIT).round() * UNIT;
        for sum in &mut up_to[slice + 1..] {
            *sum += b;
        }
    }
    let in_front = |&(z, _): &(f32, f32)| {
        let depth = (depth(z).min(slices as f64 - 0.5) - 1.0).max(0.0);
        let (slice, t) = (depth as usize, depth.fract());
        up_to[slice] + (up_to[slice + 1] - up_to[slice]) * t
    };
    fragments.iter().map(|f| (-in_front(f)).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Absorbances of up to two fragments, each rounded to half of 1/2048.
    const ROUNDED: f64 = 1.0 / 2048.0;

    /// Slices of the logarithm: depth e^(s / 64) begins slice s.
    fn at(slice: f64) -> f32 {
        (slice / 64.0).exp() as f32
    }

    fn warp() -> DepthWarp {
        DepthWarp::new(1.0, std::f64::consts::E)
    }

    /// Two slices apart nothing is blurred, one slice apart by the place in it, and in one slice nothing is in front.
    #[test]
    fn slices_are_linear() {
        let behind = |slice: f64| {
            let t = transmittances(&[(at(10.5), 0.5), (at(slice), 0.5)], &warp(), 64);
            assert_eq!(t[0], 1.0);
            t[1]
        };
        let close = |a: f64, b: f64| (a - b).abs() < ROUNDED;
        assert!(close(behind(12.5), 0.5));
        assert!(close(behind(60.0), 0.5));
        assert!(close(behind(11.25), 0.5f64.powf(0.25)));
        assert_eq!(behind(10.9), 1.0);
    }

    /// The last slice has an end of its own.
    #[test]
    fn depths_at_the_far_end_are_in_the_last_slice() {
        let far = std::f32::consts::E * 2.0;
        let t = transmittances(&[(at(60.0), 0.75), (far, 0.5)], &warp(), 64);
        assert!((t[1] - 0.25).abs() < ROUNDED);
    }
}
