//! `wavelet-3`: absorbance in front of a depth as a step function in Haar wavelets of rank 3 (Aizenshtein, Smal & McGuire,
//! "Wavelet Transparency", 2022). The shader twin is `methods/wavelet/`.
//!
//! Wavelets keep, of a function, its averages over equal bins; here these are computed directly. A fragment asks for the
//! value between the averages of the bin before its own and its own, by its place in it.

use crate::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    guards::WEIGHT_FLOOR,
    methods::deep,
};

/// Bins of rank 3; the last one lies behind all depths.
pub const BINS: usize = 16;

/// Average absorbance in front, over each bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Averages(pub [f64; BINS]);

/// Bin and place in it, 0 … 1, of a warped depth.
fn place(zeta: f64) -> (usize, f64) {
    let position = (zeta * 0.5 + 0.5) * (BINS - 1) as f64;
    let bin = (position as usize).min(BINS - 1);
    (bin, position - bin as f64)
}

impl Averages {
    /// Adds absorbance `b` at warped depth `zeta`.
    pub fn add(&mut self, b: f64, zeta: f64) {
        let (bin, t) = place(zeta);
        self.0[bin] += b * (1.0 - t);
        for later in &mut self.0[bin + 1..] {
            *later += b;
        }
    }

    /// The estimate of the absorbance in front of `zeta`.
    pub fn in_front(&self, zeta: f64) -> f64 {
        let (bin, t) = place(zeta);
        let before = bin.checked_sub(1).map_or(0.0, |i| self.0[i]);
        before + (self.0[bin] - before) * t
    }
}

/// The transmittance in front of each of a pixel's fragments, given as (linear depth, α).
pub fn transmittances(fragments: &[(f32, f32)], warp: &DepthWarp, own_share_out: bool) -> Vec<f64> {
    let estimate = |a: &Averages, zeta| (-a.in_front(zeta)).exp().min(1.0);
    super::transmittances(
        fragments,
        warp,
        Averages::default(),
        own_share_out,
        Averages::add,
        estimate,
    )
}

/// Eq 6's composite with the estimated transmittance as the weight; `own_share_out` leaves a fragment's own absorbance out
/// of what it asks for.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    own_share_out: bool,
) -> [f32; 3] {
    let zeta = |f: &Fragment| warp.apply(f.depth.into());
    let mut averages = Averages::default();
    for f in fragments {
        averages.add(absorbance(f.alpha), zeta(f));
    }
    deep::composite(fragments, background, |f| {
        let t = place(zeta(f)).1;
        let own = absorbance(f.alpha) * t * (1.0 - t);
        let in_front = averages.in_front(zeta(f)) - if own_share_out { own } else { 0.0 };
        (-in_front).exp().clamp(WEIGHT_FLOOR.into(), 1.0) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::over;

    /// In front of everything nothing lies, behind everything all of it; the estimate does not fall between.
    #[test]
    fn it_grows_from_nothing_to_all() {
        let mut a = Averages::default();
        let layers = [(0.4, -0.9), (1.1, -0.2), (0.3, -0.15), (0.8, 0.85)];
        for (b, zeta) in layers {
            a.add(b, zeta);
        }
        assert_eq!(a.in_front(-1.0), 0.0);
        assert!((a.0[BINS - 1] - 2.6).abs() < 1e-12);
        let at = |i: i32| a.in_front(f64::from(i) / 500.0 - 1.0);
        assert!((1..=1000).all(|i| at(i) >= at(i - 1) - 1e-12));
    }

    /// Layers two bins and more apart are separated exactly.
    #[test]
    fn separate_layers_are_exact() {
        let warp = DepthWarp::new(1.0, 100.0);
        let f: Vec<_> = (0..4)
            .map(|i| {
                let zeta = (2.0 * (4.0 * i as f64 + 0.5) / 15.0 - 1.0) * 0.5 + 0.5;
                let t = i as f32 * 0.3;
                Fragment::new(100f64.powf(zeta) as f32, 0.6, [t, 1.0 - t, 0.5])
            })
            .collect();
        let (got, want) = (
            composite(&f, [0.1; 3], &warp, true),
            over::composite(&f, [0.1; 3]),
        );
        for k in 0..3 {
            // Roundings of 32-bit depths in a logarithm, times a slope of b/bin.
            assert!((got[k] - want[k]).abs() < 1e-5, "{got:?} {want:?}");
        }
    }
}
