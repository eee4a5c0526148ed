//! `wavelet-R`: absorbance in front of a depth as a step function in Haar wavelets of rank R (Aizenshtein, Smal & McGuire,
//! "Wavelet Transparency", 2022): 8 coefficients of rank 2, 16 of rank 3.
//!
//! Wavelets keep, of a function, its averages over equal bins; here these are computed directly. A fragment asks for the
//! value between the averages of the bin before its own and its own, by its place in it. Bins over the pixel's own bounds, and the
//! fragment's own share taken out, are from the write-up by Osorio López (osor.io/OIT) and from Flywheel's shaders
//! (`signal_corrected_transmittance`).

use crate::methods::bins::range::{Bounds, places};
use peelnet_core::absorbance::DepthWarp;

/// What the wavelets are spread over, and asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// 2 or 3.
    pub rank: u32,
    /// What is divided into bins.
    pub bounds: Bounds,
    /// Whether a fragment's own absorbance is left out of what it asks for.
    pub own_share_out: bool,
}

/// Average absorbance in front, over each bin. The last one lies behind all depths.
#[derive(Clone, Debug, PartialEq)]
pub struct Averages(Vec<f64>);

impl Averages {
    /// Of a pixel without fragments.
    pub fn of_rank(rank: u32) -> Self {
        Self(vec![0.0; 2 << rank])
    }

    /// Bin and place in it, 0 … 1, of a place in the range, 0 … 1.
    fn bin(&self, place: f64) -> (usize, f64) {
        let last = self.0.len() - 1;
        let position = place * last as f64;
        let bin = (position as usize).min(last);
        (bin, position - bin as f64)
    }

    /// Adds absorbance `b` at a place in the range.
    pub fn add(&mut self, b: f64, place: f64) {
        let (bin, t) = self.bin(place);
        self.0[bin] += b * (1.0 - t);
        for later in &mut self.0[bin + 1..] {
            *later += b;
        }
    }

    /// The estimate of the absorbance in front of a place in the range.
    pub fn in_front(&self, place: f64) -> f64 {
        let (bin, t) = self.bin(place);
        let before = bin.checked_sub(1).map_or(0.0, |i| self.0[i]);
        before + (self.0[bin] - before) * t
    }

    /// What absorbance `b` at a place adds to the estimate there: nothing before its bin, and of its bin what lies behind it.
    fn own(&self, b: f64, place: f64) -> f64 {
        let (_, t) = self.bin(place);
        b * t * (1.0 - t)
    }
}

/// The transmittance in front of each of a pixel's fragments, given as (linear depth, α).
pub fn transmittances(fragments: &[(f32, f32)], warp: &DepthWarp, settings: &Settings) -> Vec<f64> {
    let points = peelnet_core::methods::points(fragments, warp);
    let zetas: Vec<f64> = points.iter().map(|p| p.1).collect();
    let places = places(settings.bounds, &zetas);
    let points = || points.iter().map(|p| p.0).zip(places.iter().copied());
    let mut averages = Averages::of_rank(settings.rank);
    for (b, place) in points() {
        averages.add(b, place);
    }
    let in_front = points().map(|(b, place)| {
        let own = if settings.own_share_out {
            averages.own(b, place)
        } else {
            0.0
        };
        averages.in_front(place) - own
    });
    in_front.map(|b| (-b).exp().min(1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In front of everything nothing lies, behind everything all of it; the estimate does not fall between.
    #[test]
    fn it_grows_from_nothing_to_all() {
        for rank in [2, 3] {
            let mut a = Averages::of_rank(rank);
            for (b, place) in [(0.4, 0.05), (1.1, 0.4), (0.3, 0.425), (0.8, 0.925)] {
                a.add(b, place);
            }
            assert_eq!(a.in_front(0.0), 0.0);
            assert!((a.0[a.0.len() - 1] - 2.6).abs() < 1e-12);
            let at = |i: i32| a.in_front(f64::from(i) / 1000.0);
            assert!((1..=1000).all(|i| at(i) >= at(i - 1) - 1e-12));
        }
    }

    /// Layers two bins and more apart are separated exactly, but for roundings of 32-bit depths in a logarithm, times a slope of b/bin.
    #[test]
    fn separate_layers_are_exact() {
        let warp = DepthWarp::new(1.0, 100.0);
        for (rank, layers) in [(2, 2), (3, 4)] {
            let last = f64::from((2 << rank) - 1);
            let place = |i| (4.0 * f64::from(i) + 0.5) / last;
            let layer = |i| (100f64.powf(place(i)) as f32, 0.6);
            let f: Vec<_> = (0..layers).map(layer).collect();
            let settings = Settings {
                rank,
                bounds: Bounds::Frame,
                own_share_out: true,
            };
            for (i, t) in (0..).zip(transmittances(&f, &warp, &settings)) {
                assert!((t - 0.4f64.powi(i)).abs() < 1e-5, "{rank}, {i}: {t}");
            }
        }
    }

    /// Over its own bounds a pixel of two fragments is exact however close they are; over the frame's it is not.
    #[test]
    fn two_fragments_within_their_own_bounds_are_exact() {
        let warp = DepthWarp::new(1.0, 100.0);
        let f = [(10.0, 0.5), (10.1, 0.5)];
        let behind = |bounds| {
            let settings = Settings {
                rank: 2,
                bounds,
                own_share_out: true,
            };
            transmittances(&f, &warp, &settings)[1]
        };
        assert!((behind(Bounds::Pixel) - 0.5).abs() < 1e-12);
        assert!((behind(Bounds::Frame) - 0.5).abs() > 0.1);
    }
}
