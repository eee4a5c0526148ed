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
pub mod mboit4;
pub mod mboit6;
pub mod mboit8;
pub mod mboit_trig;
pub mod mlab;
pub mod moments;
pub mod nmt;
pub mod over;
pub mod range;
mod roots;
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

/// Asks the sums over a pixel's fragments, given as (linear depth, α), for the transmittance in front of each: with the
/// fragment's own absorbance in the sums or taken out of them.
fn transmittances<S: Copy>(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    empty: S,
    own_out: bool,
    add: impl Fn(&mut S, f64, f64),
    estimate: impl Fn(&S, f64) -> f64,
) -> Vec<f64> {
    let point = |&(depth, alpha): &(f32, f32)| (absorbance(alpha), warp.apply(depth.into()));
    let mut sums = empty;
    for (b, zeta) in fragments.iter().map(point) {
        add(&mut sums, b, zeta);
    }
    fragments
        .iter()
        .map(point)
        .map(|(b, zeta)| {
            let mut seen = sums;
            if own_out {
                add(&mut seen, -b, zeta);
            }
            estimate(&seen, zeta)
        })
        .collect()
}

/// Eq 6's composite with estimates of the transmittance as weights, which `transmittances` gives of fragments as (linear depth, α).
fn composite_by(
    fragments: &[Fragment],
    background: [f32; 3],
    transmittances: impl FnOnce(&[(f32, f32)]) -> Vec<f64>,
) -> [f32; 3] {
    let points: Vec<_> = fragments.iter().map(|f| (f.depth, f.alpha)).collect();
    let mut weights = transmittances(&points).into_iter();
    deep::composite(fragments, background, |_| {
        // One estimate a fragment.
        let t = weights.next().unwrap_or_default();
        t.max(WEIGHT_FLOOR.into()) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::worked_example;
    use crate::weights::Weight;

    const C0: [f32; 3] = [0.1, 0.2, 0.9];

    fn normalised(fragments: &[Fragment]) -> Vec<[f32; 3]> {
        let mut all = vec![
            weighted_average::composite(fragments, C0),
            blended::composite(fragments, C0),
            deep::composite(fragments, C0, |f| 1.0 / f.depth),
        ];
        all.extend(Weight::ALL.map(|w| wboit::composite(fragments, C0, w)));
        all
    }

    /// One fragment: every normalised method is exact. 1e−6: about ten roundings of values ≤ 1.
    #[test]
    fn a_single_fragment_is_exact() {
        for alpha in [1e-3, 0.25, 0.5, 0.99, 1.0] {
            let f = [Fragment::new(3.0, alpha, [0.8, 0.4, 0.2])];
            let exact = over::composite(&f, C0);
            for c in normalised(&f) {
                for k in 0..3 {
                    assert!((c[k] - exact[k]).abs() < 1e-6, "{alpha} {c:?} {exact:?}");
                }
            }
        }
    }

    /// No fragment, and fragments of α = 0: the background comes back bit for bit.
    #[test]
    fn nothing_leaves_the_background() {
        for f in [vec![], vec![Fragment::new(2.0, 0.0, [1.0; 3]); 3]] {
            assert_eq!(over::composite(&f, C0), C0);
            for c in normalised(&f) {
                assert_eq!(c, C0);
            }
        }
    }

    /// Fragments of one colour over the same colour: any convex combination gives that colour.
    #[test]
    fn one_colour_stays() {
        let f: Vec<_> = (1..9)
            .map(|i| Fragment::new(i as f32, 0.1 * i as f32, C0))
            .collect();
        for c in normalised(&f) {
            for k in 0..3 {
                assert!((c[k] - C0[k]).abs() < 2e-6);
            }
        }
    }

    #[test]
    fn the_worked_example() {
        let f = worked_example();
        let close = |a: [f32; 3], b: [f64; 3]| {
            for k in 0..3 {
                assert!((f64::from(a[k]) - b[k]).abs() < 1e-6, "{a:?} {b:?}");
            }
        };
        close(over::composite(&f, [0.0; 3]), [0.6125, 0.3625, 0.2375]);
        // Σ C = (1.4, 1.4, 1.4): out of the gamut.
        close(weighted_sum::composite(&f, [0.0; 3]), [1.4, 1.4, 1.4]);
        // (1.4 / 2.4)·(1 − ½³·0.1)
        close(blended::composite(&f, [0.0; 3]), [1.4 / 2.4 * 0.9875; 3]);
        // ᾱ = 0.6: (1.4 / 2.4)·(1 − 0.4⁴)
        close(
            weighted_average::composite(&f, [0.0; 3]),
            [1.4 / 2.4 * (1.0 - 0.0256); 3],
        );
        // w = 1/z: Σ C w = ½·(1, ½, ¼) + 0.1125, Σ α w = 0.9875
        close(
            wboit::composite(&f, [0.0; 3], Weight::InversePower { k: 1, epsilon: 0.0 }),
            [0.6125, 0.3625, 0.2375],
        );
    }
}
