//! Every compositing method on a plain list of fragments: the CPU twin of the GPU method of the same name.
//!
//! The commutative methods take fragments in any order; [`over`] sorts first. `background` is `C_0`, linear RGB.

pub mod anchored;
pub mod avboit;
pub mod bins;
pub mod blended;
pub mod deep;
pub mod dfaoit;
pub mod kbuffer;
pub mod mlab;
pub mod moments;
pub mod nmt;
pub mod over;
pub mod range;
pub mod slabs;
pub mod stochastic;
pub mod stored;
pub mod wavelet;
pub mod wboit;
pub mod weighted_average;
pub mod weighted_sum;

use crate::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    guards::WEIGHT_FLOOR,
};

/// A fragment: its absorbance, its warped depth, and whether it is visible enough to be the nearest or the farthest of those around it.
pub type Point = (f64, f64, bool);

fn point(alpha: f32, zeta: f64) -> Point {
    (absorbance(alpha), zeta, alpha >= anchored::FAINT)
}

/// Of fragments that are given as (linear depth, α).
fn points(fragments: &[(f32, f32)], warp: &DepthWarp) -> Vec<Point> {
    let of = |&(depth, alpha): &(f32, f32)| point(alpha, warp.apply(depth.into()));
    fragments.iter().map(of).collect()
}

/// Eq 6's composite with an estimate of the transmittance in front of each fragment as its weight.
pub fn composite(fragments: &[Fragment], background: [f32; 3], transmittances: &[f64]) -> [f32; 3] {
    let mut weights = transmittances.iter();
    deep::composite(fragments, background, |_| {
        // One estimate a fragment.
        let t = weights.next().copied().unwrap_or_default();
        t.max(WEIGHT_FLOOR.into()) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fragment::worked_example, random::Random, weights::Weight};
    use slabs::Design;

    const C0: [f32; 3] = [0.1, 0.2, 0.9];

    /// Up to so many layers, drawn in any order, are exact whatever a network says. 1e−6: about ten roundings of values ≤ 1. Layers closer
    /// than a level of depth would share a record, so the stacks are spread evenly.
    #[test]
    fn few_layers_are_exact() {
        let warp = DepthWarp::new(0.1, 2000.0);
        let mut random = Random::new(7, &[]);
        for seed in 0..800 {
            let n = seed % 4 + 1;
            let mut f: Vec<_> = (0..n)
                .map(|i| {
                    let depth = 0.2 * 8f32.powi(i as i32) * random.between(1.0, 1.5);
                    Fragment::new(depth, random.between(0.02, 0.98), random.color())
                })
                .collect();
            let exact = over::composite(&f, C0);
            f.rotate_left(random.below(n));
            let share = random.below(3) as f64 / 2.0;
            let anchored = |apart| anchored::composite(&f, C0, &warp, apart, |_| share);
            let slabs = |design| slabs::composite(&f, C0, &warp, design, |_| share);
            // The last layer is a tail of its own.
            let kbuffer = |tail| kbuffer::composite(&f, C0, 3, tail, stored::Colors::Full);
            for (name, most, found) in [
                ("anchored", 2, anchored(false)),
                ("anchored, separate ends", 3, anchored(true)),
                ("small slabs", 3, slabs(Design::SMALL)),
                ("medium slabs", 3, slabs(Design::MEDIUM)),
                ("large slabs", 3, slabs(Design::LARGE)),
                ("dfaoit", 2, dfaoit::composite(&f, C0, |_| [9.0; 3])),
                ("kbuffer", 4, kbuffer(None)),
                ("hybrid", 4, kbuffer(Some(Weight::Eq9))),
                ("mlab", 4, mlab::composite(&f, C0, 4)),
                ("stochastic", 1, stochastic::composite(&f, C0, 8, [3, 5])),
            ] {
                let is_near = (0..3).all(|k| (found[k] - exact[k]).abs() < 1e-6);
                assert!(n > most || is_near, "{name}: {found:?} {exact:?}");
            }
        }
    }

    /// Σ C = (1.4, 1.4, 1.4) is out of the gamut. Eq 5: (1.4 / 2.4)·(1 − ½³·0.1). Weighted average: ᾱ = 0.6, 1 − 0.4⁴.
    /// Eq 6 with w = 1/z: Σ C w = ½·(1, ½, ¼) + 0.1125, Σ α w = 0.9875.
    #[test]
    fn the_worked_example() {
        let (f, black) = (worked_example(), [0.0; 3]);
        let inverse = Weight::InversePower { k: 1, epsilon: 0.0 };
        let exact = [0.6125, 0.3625, 0.2375];
        for (got, want) in [
            (over::composite(&f, black), exact),
            (weighted_sum::composite(&f, black), [1.4; 3]),
            (blended::composite(&f, black), [1.4 / 2.4 * 0.9875; 3]),
            (
                weighted_average::composite(&f, black),
                [1.4 / 2.4 * 0.9744; 3],
            ),
            (wboit::composite(&f, black, inverse), exact),
        ] {
            for (a, b) in got.into_iter().zip(want) {
                assert!((f64::from(a) - b).abs() < 1e-6, "{got:?} {want:?}");
            }
        }
    }
}
