//! Properties of any list of fragments, searched for counterexamples: 10,000 lists for each, or as many as the environment variable
//! `PROPTEST_CASES` says (`cargo xtask search` sets a million). Methods take part by their declarations.
//!
//! proptest chooses a list's seed, length and kind, and shrinks the last two: a list of 512 fragments is then made in microseconds.

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::{Fragment, transmittances},
    methods::{
        anchored::{self, Residual},
        moments::{Moments, Settings},
        over,
        slabs::{self, Design, Interior},
    },
    random::Random,
    statistics::{Statistics, SumPrecision},
    tolerance,
    weights::Weight,
};
use peelnet_model::inputs::{ANCHORED, NINE, values};
use peelnet_render::{
    KnownFailure, MethodSpec, Property,
    methods::{Pixel, wavelet},
};
use proptest::prelude::*;
use std::sync::LazyLock;

fn config() -> ProptestConfig {
    let asked = std::env::var("PROPTEST_CASES").ok();
    ProptestConfig {
        cases: asked.and_then(|n| n.parse().ok()).unwrap_or(10_000),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Opacities around those that break formulas.
const HARD_ALPHAS: [f32; 8] = {
    let almost_one = 1.0 - f32::EPSILON / 2.0;
    [0.0, 1e-45, 1e-20, 1e-5, 0.5, 0.99, almost_one, 1.0]
};

/// Seed and length of a list, and which kinds of depths and opacities it is made of.
type Kind = (u64, usize, u8, u8);

fn lists() -> impl Strategy<Value = Kind> {
    let length = prop_oneof![0usize..=4, 0usize..=32, 0usize..=512];
    (any::<u64>(), length, 0u8..6, 0u8..6)
}

fn list((seed, n, depths, alphas): Kind) -> Vec<Fragment> {
    let mut random = Random::new(seed, &[]);
    let depth = |r: &mut Random| match depths {
        // All over what floats hold, denormals included; a decade; a thin slab; one depth; a few depths; a scene's.
        0 => [1e-42, 1e-38, 1e-30, 1.0, 1e30][r.below(5)] * r.between(0.5, 2.0),
        1 => r.between(1.0, 10.0),
        2 => r.between(5.0, 5.000_05),
        3 => 2.5,
        4 => [1.0, 1.000_000_1, 7.0][r.below(3)],
        _ => r.log_between(0.01, 1e4),
    };
    let alpha = |r: &mut Random| match alphas {
        0 => 0.0,
        1 => 1.0,
        2 => HARD_ALPHAS[r.below(8)],
        3 => r.between(0.9, 1.0),
        4 => r.between(0.0, 0.01),
        _ => r.unit(),
    };
    (0..n)
        .map(|i| Fragment {
            window_depth: random.unit(),
            triangle: i as u32,
            ..Fragment::new(depth(&mut random), alpha(&mut random), random.color())
        })
        .collect()
}

/// The warp over a list's depths, as the renderer takes it.
fn warp(list: &[Fragment]) -> DepthWarp {
    let mut depths: Vec<f64> = list.iter().map(|f| f.depth.into()).collect();
    depths.sort_by(f64::total_cmp);
    match depths[..] {
        [near, .., far] => DepthWarp::new(near, far),
        [only] => DepthWarp::new(only, only),
        [] => DepthWarp::new(0.1, 100.0),
    }
}

/// A share that no network would predict: anything in 0 … 1.
fn share(rest: &Residual) -> f64 {
    let sum = values(&ANCHORED, rest).iter().sum::<f64>();
    (sum * 12.9898).sin().abs()
}

/// The same between a slab's ends.
fn guess(between: &Interior) -> f64 {
    let known = values(&NINE, between);
    (known.iter().sum::<f64>() * 12.9898).sin().abs()
}

/// Every point of every method's curve that needs no network, with its name, and whether its weights are declared to vanish far from the
/// camera.
static POINTS: LazyLock<Vec<(String, bool, MethodSpec)>> = LazyLock::new(|| {
    let far =
        |f: &KnownFailure| f.property == Property::Hull && f.cases().any(|case| case == "far");
    // Twins know no precision of targets.
    let is_one = |s: &MethodSpec| {
        let is_sound = s.guarantees().normalised && !s.guarantees().rounds_fragments;
        is_sound && !s.needs_model() && s.targets().is_none()
    };
    let all = MethodSpec::compared().into_iter().filter(is_one);
    let all = all.map(|s| {
        let vanishes = s.method().expectations.known_failures.iter().any(far);
        (s.to_string(), vanishes, s)
    });
    all.collect()
});

/// Every normalised method's name and colour, and whether its weights may vanish; with those of the learned weights with a network that
/// predicts anything.
fn normalised(fragments: &[Fragment], background: [f32; 3]) -> Vec<(&str, [f32; 3], bool)> {
    let pixel = Pixel {
        fragments,
        background,
        warp: warp(fragments),
        position: [3, 5],
        model: None,
    };
    let references = POINTS.iter();
    let references = references
        .filter_map(|(name, vanishes, s)| Some((&**name, s.reference(&pixel)?, *vanishes)));
    let ends = [("anchored", false), ("anchored, separate ends", true)];
    let anchored = ends.map(|(name, ends)| {
        let color = anchored::composite(fragments, background, &pixel.warp, ends, share);
        (name, color, false)
    });
    let designs = [
        ("small", Design::SMALL),
        ("medium", Design::MEDIUM),
        ("large", Design::LARGE),
    ];
    let in_slabs = designs.map(|(name, design)| {
        let color = slabs::composite(fragments, background, &pixel.warp, design, guess);
        (name, color, false)
    });
    references.chain(anchored).chain(in_slabs).collect()
}

/// Twenty roundings of each of `n` sums of values ≤ 1, relative to what is divided by: the same terms.
fn rounding(n: usize) -> f32 {
    (20.0 + 4.0 * n as f32) * f32::EPSILON
}

/// Products of opacities and weights below the smallest normal float lose their bits. Where all opacities are that small, so is
/// all that they add.
fn is_faint(f: &[Fragment]) -> bool {
    f.iter().map(|f| f.alpha).sum::<f32>() < 1e-15
}

proptest! {
    #![proptest_config(config())]

    /// T falls from 1 and never below 0, and what is seen of the fragments is what `T_∞` leaves.
    #[test]
    fn transmittance_falls_and_contributions_add_up(of in lists()) {
        let f = over::sorted(&list(of));
        let alphas: Vec<f32> = f.iter().map(|f| f.alpha).collect();
        let t = transmittances(&alphas);
        prop_assert_eq!(t[0], 1.0);
        prop_assert!(t.windows(2).all(|w| w[1] <= w[0] && w[1] >= 0.0));
        let seen: f64 = alphas.iter().zip(&t).map(|(&a, &t)| f64::from(a) * f64::from(t)).sum();
        let covered = 1.0 - f64::from(t[f.len()]);
        prop_assert!((seen - covered).abs() <= 2.0 * tolerance::transmittance(f.len() + 1), "{} {}", seen, covered);
    }

    /// The exact composite in 32 bits, front to back, is that in 64 bits, back to front.
    #[test]
    fn exact_is_exact(of in lists()) {
        let f = list(of);
        let (found, want) = (over::composite(&f, [0.3, 0.9, 0.1]), over::composite_f64(&f, [0.3, 0.9, 0.1]));
        for k in 0..3 {
            let error = (f64::from(found[k]) - want[k]).abs();
            prop_assert!(error <= tolerance::composite(f.len(), 1.0) && error <= tolerance::EXACT * 10.0);
        }
    }

    /// Every normalised method stays within what its colours span, component by component, whatever the list. One fragment is exact.
    #[test]
    fn normalised_methods_stay_in_the_hull((seed, n, depths, alphas) in lists()) {
        let c0 = [0.2, 0.7, 0.4];
        for f in [n, 1].map(|n| list((seed, n, depths, alphas))) {
            let exact = over::composite(&f, c0);
            let slack = if is_faint(&f) { 1e-4 } else { rounding(f.len()) };
            for (name, color, vanishes) in normalised(&f, c0) {
                // The published weights end at 2^-24 of opacity times weight: depths of 1e30 vanish, a known failure.
                let vanishes = vanishes && f.iter().any(|f| f.depth > 1e2);
                for k in 0..3 {
                    let all = || f.iter().map(|f| f.color[k]).chain([c0[k]]);
                    let (low, high) = if f.len() == 1 {
                        (exact[k], exact[k])
                    } else {
                        all().fold((f32::INFINITY, 0.0f32), |(l, h), c| (l.min(c), h.max(c)))
                    };
                    let inside = color[k] >= low - slack && color[k] <= high + slack;
                    prop_assert!(inside || (vanishes && color[k].is_finite()), "{}: {:?} outside of {} … {}", name, color, low, high);
                }
            }
        }
    }

    /// Moments and wavelets answer a transmittance at any depth.
    #[test]
    fn estimates_are_transmittances(of in lists(), zeta in -1.0f64..=1.0) {
        let f = list(of);
        let warp = warp(&f);
        let trigonometric = [2, 3].map(Settings::trigonometric);
        let mut all = [Settings::FOUR, Settings::SIX, Settings::EIGHT].to_vec();
        all.extend(trigonometric);
        let mut all: Vec<_> = all.into_iter().map(|s| (s, Moments::new(s.basis))).collect();
        let mut haar = wavelet::reference::Averages::of_rank(3);
        for f in &f {
            let (b, z) = (absorbance(f.alpha), warp.apply(f.depth.into()));
            all.iter_mut().for_each(|(_, moments)| moments.add(b, z));
            haar.add(b, 0.5 + 0.5 * z);
        }
        let at = f.iter().map(|f| warp.apply(f.depth.into())).take(8).chain([zeta]);
        for z in at {
            let moments = all.iter().map(|(settings, moments)| moments.transmittance(z, settings));
            for t in moments.chain([(-haar.in_front(0.5 + 0.5 * z)).exp()]) {
                prop_assert!((0.0..=1.0 + 1e-12).contains(&t), "{} at {}", t, z);
            }
        }
    }

    /// What the learned methods read is finite and within its range, in either precision, and so is the weight of any share.
    #[test]
    fn features_and_weights_are_finite(of in lists()) {
        let f = list(of);
        let warp = warp(&f);
        let points: Vec<(f32, f32)> = f.iter().map(|f| (f.depth, f.alpha)).collect();
        let is_weight = |weight: &dyn Fn(f64) -> f64| {
            [0.0, 0.3, 1.0].iter().all(|share| (0.0..=1.0).contains(&weight(*share)))
        };
        for precision in [SumPrecision::Exact, SumPrecision::Half] {
            for f in anchored::known_fragments(&points, &warp, precision) {
                let features = f.unknown.map(|rest| values(&ANCHORED, &rest));
                prop_assert!(features.iter().flatten().all(|x| x.is_finite()), "{:?}", f);
                let mut shares = features.iter().flat_map(|features| &features[3..]);
                prop_assert!(shares.all(|x| (-1e-6..=1.0 + 1e-6).contains(x)), "{:?}", f);
                prop_assert!(is_weight(&|share| f.weight(|_| share)), "{:?}", f);
            }
            // Between the known ends of slabs, whose bounds hold the share.
            for design in [Design::SMALL, Design::MEDIUM, Design::LARGE] {
                for f in slabs::known_fragments(&points, &warp, design, precision) {
                    let inputs = f.unknown.map(|between| values(&NINE, &between));
                    prop_assert!(inputs.iter().flatten().all(|x| x.is_finite()), "{:?}", f);
                    let bounds = f.unknown.map_or([0.0, 1.0], |between| between.bounds);
                    prop_assert!(0.0 <= bounds[0] && bounds[0] <= bounds[1] && bounds[1] <= 1.0, "{:?}", f);
                    prop_assert!(is_weight(&|share| f.weight(|_| share)), "{:?}", f);
                }
            }
        }
    }

    /// The same of any finite sums, whether or not a list of fragments has them.
    #[test]
    fn features_are_finite_for_any_sums(bits in prop::array::uniform8(any::<u32>()), zeta in -1.0f64..=1.0) {
        let x = bits.map(f32::from_bits).map(|x| f64::from(if x.is_finite() { x } else { 1e30 }));
        let s = Statistics { moments: [x[0].abs(), x[1], x[2], x[3], x[4]], nearest: x[5].clamp(-1.0, 1.0), farthest: x[6].clamp(-1.0, 1.0) };
        let rest = s.without(&[(x[7].abs().min(16.0), zeta)]);
        let seen = Residual::new(&s, &rest, zeta);
        prop_assert!(values(&ANCHORED, &seen).iter().all(|x| x.is_finite()), "{:?} {:?}", s, rest);
    }

    /// Published weights of any depth and opacity.
    #[test]
    fn weights_are_finite(bits in any::<u32>(), alpha in 0.0f32..=1.0, window in 0.0f32..=1.0) {
        let z = f32::from_bits(bits).abs();
        let z = if z.is_finite() { z } else { f32::MAX };
        for w in Weight::ALL {
            let value = w.eval(z, alpha, window);
            prop_assert!(value.is_finite() && value >= 0.0, "{w:?}: {value} at {z}");
        }
    }
}
