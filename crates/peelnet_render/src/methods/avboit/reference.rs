//! `avboit`: absorbance in a view-aligned grid of voxels, each a block of pixels and a slice of depth.
//!
//! Source: M. Drobot, "Adaptive Voxel-Based Order-Independent Transparency", SIGGRAPH 2025, Advances in Real-Time Rendering, as an independent
//! implementation describes it (yangrc1234/avboit-exp). Depth is cut into 2,048 intervals of equal ratio. Those where something is, and three on
//! either side, have a slice of their own; as long as there are 128 or more, pairs of intervals are joined. A pass at an eighth of the width
//! and the height adds absorbances to the two slices around each fragment, and colours are weighed with the transmittance two intervals
//! in front of them, linear between slices and columns. Ours: intervals of what transparent objects span, and not from the camera to a distance;
//! where something is, is found by one pixel in 64, and not by the bounds of objects; one absorbance for all colours; sums of 32 bits and not
//! of 8; coverage is the exact `T_∞`. The depth behind which nothing is seen saves time there and is left out.

use peelnet_core::absorbance::{DepthWarp, absorbance};

/// Absorbances are added in whole numbers of this: the sum does not depend on the order.
pub const UNIT: f64 = 1.0 / 2048.0;

/// Of depth, before pairs are joined.
pub const INTERVALS: usize = 2048;

/// On either side of an interval where something is.
const GUARDS: usize = 3;

/// Which intervals have a slice.
struct Used(Vec<bool>);

impl Used {
    /// Fewer than `slices`, from the places of all fragments, 0 … 1.
    fn new(places: impl Iterator<Item = f64>, slices: usize) -> Self {
        let mut occupied = vec![false; INTERVALS];
        for place in places {
            occupied[at(place, INTERVALS) as usize] = true;
        }
        loop {
            let is_used = |k: usize| {
                let last = (k + GUARDS).min(occupied.len() - 1);
                occupied[k.saturating_sub(GUARDS)..=last].contains(&true)
            };
            let used: Vec<_> = (0..occupied.len()).map(is_used).collect();
            if used.iter().filter(|used| **used).count() < slices || used.len() == 32 {
                return Self(used);
            }
            occupied = occupied.chunks(2).map(|pair| pair[0] || pair[1]).collect();
        }
    }

    /// A place as one in slices; nothing in front of all intervals. An interval without a slice is where the slice before it ends.
    fn slice(&self, place: f64, nearer: f64) -> Option<f64> {
        let depth = at(place, self.0.len()) - nearer;
        let interval = (depth >= 0.0).then_some(depth as usize)?;
        let before = self.0[..interval].iter().filter(|used| **used).count();
        Some(before as f64 + if self.0[interval] { depth.fract() } else { 0.0 })
    }
}

/// A place of 0 … 1 in intervals.
fn at(place: f64, intervals: usize) -> f64 {
    (place * intervals as f64).min(intervals as f64 - 0.001)
}

/// The estimated transmittance in front of each of a pixel's fragments, given as (linear depth, α), where all pixels around are like this one.
pub fn transmittances(fragments: &[(f32, f32)], warp: &DepthWarp, slices: usize) -> Vec<f64> {
    let place = |z: f32| warp.apply(z.into()) * 0.5 + 0.5;
    let used = Used::new(fragments.iter().map(|f| place(f.0)), slices);
    let mut sums = vec![0.0; slices];
    for &(z, alpha) in fragments {
        let slice = used.slice(place(z), 0.0).unwrap_or_default();
        let b = absorbance(alpha) / UNIT;
        let far = (b * slice.fract()).round();
        sums[slice as usize] += (b.round() - far) * UNIT;
        sums[slice as usize + 1] += far * UNIT;
    }
    // Behind each slice.
    let behind = sums.iter().scan(0.0, |sum, b| {
        *sum += b;
        Some((-*sum).exp())
    });
    let behind: Vec<f64> = behind.collect();
    let in_front = |&(z, _): &(f32, f32)| {
        let slice = used.slice(place(z), 2.0)?;
        let (k, t) = (slice as usize, slice.fract());
        Some(behind[k] * (1.0 - t) + behind[k + 1] * t)
    };
    let in_front = fragments.iter().map(|f| in_front(f).unwrap_or(1.0));
    in_front.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Absorbances of up to two fragments, each rounded to half of 1/2048.
    const ROUNDED: f64 = 1.0 / 2048.0;

    /// Depth e^(s / 2048) begins interval s.
    fn depth(interval: f64) -> f32 {
        (interval / INTERVALS as f64).exp() as f32
    }

    fn behind(interval: f64, slices: usize) -> f64 {
        let warp = DepthWarp::new(1.0, std::f64::consts::E);
        let fragments = [(depth(1000.0), 0.5), (depth(interval), 0.5)];
        let t = transmittances(&fragments, &warp, slices);
        assert_eq!(t[0], 1.0);
        t[1]
    }

    /// Three intervals behind another fragment all of it is in front, one and a half behind it none; between, half of it is splatted into
    /// either slice.
    #[test]
    fn slices_are_linear() {
        let close = |a: f64, b: f64| (a - b).abs() < ROUNDED;
        assert!(close(behind(1003.0, 128), 0.5));
        assert!(close(behind(1900.0, 128), 0.5));
        assert_eq!(behind(1000.9, 128), 1.0);
        // At depth 1.5 behind, half way to the slice that holds 1000 whole.
        assert!(close(behind(1001.5, 128), 0.75));
    }

    /// With less slices than two fragments and their neighbours take, pairs of intervals are joined.
    #[test]
    fn intervals_are_joined_until_slices_are_enough() {
        let used = |slices| Used::new([0.25, 0.75].into_iter(), slices).0;
        let count = |slices| used(slices).iter().filter(|used| **used).count();
        assert_eq!((used(15).len(), count(15)), (2048, 14));
        let all = |slices: usize| Used::new((0..2048).map(|k| f64::from(k) / 2048.0), slices).0;
        assert_eq!(all(128).len(), 64);
        assert!(all(128).iter().all(|used| *used));
    }
}
