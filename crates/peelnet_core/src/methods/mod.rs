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

/// Absorbance and warped depth of fragments that are given as (linear depth, α).
fn points(fragments: &[(f32, f32)], warp: &DepthWarp) -> Vec<(f64, f64)> {
    let point = |&(depth, alpha): &(f32, f32)| (absorbance(alpha), warp.apply(depth.into()));
    fragments.iter().map(point).collect()
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

    /// A single surface comes out exact at 801 depths across the range, whatever its opacity, with moments of all kinds.
    #[test]
    fn a_single_surface_is_exact_with_moments() {
        use moments::Settings;
        let warp = DepthWarp::new(0.1, 100.0);
        let trigonometric = [2, 3].map(Settings::trigonometric);
        let all = [Settings::FOUR, Settings::SIX, Settings::EIGHT].into_iter();
        for (settings, own_share_out) in all
            .chain(trigonometric)
            .flat_map(|s| [(s, false), (s, true)])
        {
            let settings = Settings {
                own_share_out,
                ..settings
            };
            for i in 0..801 {
                let z = 0.1 * 1000f32.powf(i as f32 / 800.0);
                for alpha in [0.01, 0.5, 0.99] {
                    let f = [Fragment::new(z, alpha, [0.9, 0.1, 0.4])];
                    let t = moments::transmittances(&[(z, alpha)], &warp, &settings);
                    let (got, want) = (composite(&f, C0, &t), over::composite(&f, C0));
                    for k in 0..3 {
                        assert!(
                            (got[k] - want[k]).abs() < 1e-6,
                            "{z} {alpha}: {got:?} {want:?}"
                        );
                    }
                }
            }
        }
    }
}
