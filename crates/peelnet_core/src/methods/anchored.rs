//! `deep-anchored-small`, `deep-anchored-medium`: a learned share of what lies in front, anchored at both ends.
//!
//! The nearest fragment has weight 1 and the farthest `e^−m_0` (`m_0` the absorbance of all others): both are exact.
//! Between them `w_i = e^−(b_n + s_i r_i)`: the nearest fragment's absorbance `b_n` is known, and a network says which
//! share `s_i` of the *rest* `r_i` (all but the fragment itself and the two ends) lies in front. The weights are in (0, 1],
//! their sum cannot vanish, and up to three layers come out exact but for the ends' quantised opacities. With *separate
//! ends* the nearest and the farthest accumulate apart, and only what lies between is normalised to what they leave of
//! `1 − T_∞`; three layers are exact then.

use crate::{
    absorbance::{DepthWarp, absorbance},
    features::Rest,
    fragment::{Fragment, points},
    guards::FILL_MAX,
    statistics::{
        self, FAR_END, NEAR_END, SAME_CODE, Statistics, SumPrecision, depth_code, zeta_of_code,
    },
};

/// Fragments of less opacity are composited, but are never a pixel's nearest or farthest: an invisible fragment would
/// waste the anchor.
pub const FAINT: f32 = 1.0 / 255.0;

/// Where in its pixel a fragment lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Among the nearest.
    Nearest,
    /// Neither.
    Between,
    /// Among the farthest.
    Farthest,
}

/// What pass 2 knows of a fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Nearest, farthest or between.
    pub place: Place,
    /// Absorbance of all other fragments, `m_0`.
    pub others: f64,
    /// Absorbance of the nearest fragment, `b_n`; 0 where it does not lie in front.
    pub front: f64,
    /// All fragments but this one and the ends, which the network is asked about.
    pub rest: Rest<f64>,
}

impl Seen {
    /// The weight, given what the network answers for a fragment that lies between the ends.
    pub fn weight(&self, share: impl FnOnce(&Rest<f64>) -> f64) -> f64 {
        match self.place {
            Place::Nearest => 1.0,
            Place::Between => (-(self.front + self.rest.absorbance * share(&self.rest))).exp(),
            Place::Farthest => (-self.others).exp(),
        }
    }
}

/// What the network knows of each fragment of a pixel, in the order given: fragments are (linear depth, α).
pub fn seen(fragments: &[(f32, f32)], warp: &DepthWarp, precision: SumPrecision) -> Vec<Seen> {
    let points = super::points(fragments, warp);
    let mut s = Statistics::rounded(points.iter().copied(), precision);
    let visible = || {
        fragments
            .iter()
            .zip(&points)
            .filter(|((_, alpha), _)| *alpha >= FAINT)
            .map(|(_, &(b, zeta))| (zeta, b))
    };
    // Without a visible fragment the targets keep their clear values.
    let first = visible().map(|(zeta, _)| depth_code(zeta)).min();
    let first = first.unwrap_or(statistics::DEPTH_CODES - 1);
    let near = visible().map(|(z, b)| NEAR_END.mirrored(z, b)).max();
    let near = near.unwrap_or(0);
    let far = visible()
        .map(|(z, b)| FAR_END.level(z, b))
        .max()
        .unwrap_or(0);
    s.nearest = zeta_of_code(first);
    s.farthest = FAR_END.zeta(far);
    fragments
        .iter()
        .zip(&points)
        .map(|(&(_, alpha), &(b, zeta))| {
            let code = depth_code(zeta);
            let (own_near, own_far) = (NEAR_END.mirrored(zeta, b), FAR_END.level(zeta, b));
            let place = if alpha < FAINT {
                Place::Between
            } else if code <= first + SAME_CODE {
                Place::Nearest
            } else if own_far == far {
                Place::Farthest
            } else {
                Place::Between
            };
            // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a
            // more opaque one in the same bin), stays with the rest.
            let front = if code > first && own_near != near {
                NEAR_END.absorbance(near)
            } else {
                0.0
            };
            let back = if own_far < far {
                FAR_END.absorbance(far)
            } else {
                0.0
            };
            let rest = s.without(&[(b, zeta), (front, s.nearest), (back, s.farthest)]);
            Seen {
                place,
                others: s.without(&[(b, zeta)])[0],
                front,
                rest: Rest::new(&s, &rest, zeta),
            }
        })
        .collect()
}

/// Composites a pixel; `share` is the network.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    separate_ends: bool,
    share: impl Fn(&Rest<f64>) -> f64,
) -> [f32; 3] {
    let seen = seen(&points(fragments), warp, SumPrecision::Exact);
    let weights = seen
        .iter()
        .map(|s| (s.weight(&share), s.place != Place::Between));
    composite_weighted(fragments, background, separate_ends, weights)
}

/// Composites a pixel with the weight of each fragment, and whether it is known. Those have sums of their own where they are `apart`.
pub(super) fn composite_weighted(
    fragments: &[Fragment],
    background: [f32; 3],
    apart: bool,
    weights: impl Iterator<Item = (f64, bool)>,
) -> [f32; 3] {
    let total: f64 = fragments.iter().map(|f| absorbance(f.alpha)).sum();
    if total == 0.0 {
        return background;
    }
    // Premultiplied colour and alpha of what is guessed, and of what is known.
    let mut sums = [[0.0f64; 4]; 2];
    for (f, (w, is_known)) in fragments.iter().zip(weights) {
        let sum = &mut sums[usize::from(apart && is_known)];
        for (sum, c) in sum.iter_mut().zip(f.premultiplied()) {
            *sum += f64::from(c) * w;
        }
        sum[3] += f64::from(f.alpha) * w;
    }
    let (t, background) = ((-total).exp(), background.map(f64::from));
    if apart {
        resolve_separate_ends(sums[0], sums[1], t, background)
    } else {
        resolve(sums[0], t, background)
    }
    .map(|c| c as f32)
}

/// A pixel's colour from the sums of all its fragments, `Σ α c w` and `Σ α w`, its transmittance and the background. The shader
/// twin is `peelnet_composite` in `learned/resolve.wgsl`.
pub fn resolve(sums: [f64; 4], transmittance: f64, background: [f64; 3]) -> [f64; 3] {
    let share = if sums[3] > 0.0 {
        (1.0 - transmittance) / sums[3].max(f64::MIN_POSITIVE)
    } else {
        0.0
    };
    std::array::from_fn(|k| sums[k] * share + background[k] * transmittance)
}

/// The same with the pixel's ends in sums of their own. The shader twin is `peelnet_composite` in
/// `learned/resolve_separate_ends.wgsl`.
pub fn resolve_separate_ends(
    between: [f64; 4],
    ends: [f64; 4],
    transmittance: f64,
    background: [f64; 3],
) -> [f64; 3] {
    let coverage = 1.0 - transmittance;
    let floor = f64::MIN_POSITIVE;
    // The ends never take more than the coverage, and what lies between no more than it can fill. Both then fill what is missing.
    let own = ends[3].min(coverage);
    let left = (coverage - own).min(f64::from(FILL_MAX) * between[3]);
    let fill = coverage / (own + left).max(floor);
    let own = fill * own / ends[3].max(floor);
    let left = fill * left / between[3].max(floor);
    std::array::from_fn(|k| ends[k] * own + between[k] * left + background[k] * transmittance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{features::all, methods::over, random::Random};

    const C0: [f32; 3] = [0.3, 0.1, 0.7];

    fn stack(n: usize, seed: u32) -> Vec<Fragment> {
        let mut random = Random::new(seed.into(), &[]);
        (0..n)
            .map(|_| {
                Fragment::new(
                    0.1 * 5000f32.powf(random.unit()),
                    random.between(0.02, 0.98),
                    random.color(),
                )
            })
            .collect()
    }

    /// 1e−6: about ten roundings of values ≤ 1, as for the other normalised methods. The depth range spans 8.5 e-folds, of
    /// which a level is 1.4e−4: fragments closer than that share an end, so the stacks are spread evenly.
    #[test]
    fn few_layers_are_exact_whatever_the_network_says() {
        let warp = DepthWarp::new(0.1, 500.0);
        for seed in 0..200 {
            for (n, separate_ends) in [(1, false), (2, false), (1, true), (2, true), (3, true)] {
                let mut f = stack(n, seed * 7 + n as u32);
                for (i, f) in f.iter_mut().enumerate() {
                    f.depth = 0.2 * 8f32.powi(i as i32) * (1.0 + 0.5 * f.color[0]);
                }
                let exact = over::composite(&f, C0);
                let got = composite(&f, C0, &warp, separate_ends, |_| f64::from(seed % 3) / 2.0);
                for k in 0..3 {
                    assert!((got[k] - exact[k]).abs() < 1e-6, "{f:?}: {got:?} {exact:?}");
                }
            }
        }
    }

    /// Given the true shares, any number of layers is exact: w_i is T_i then.
    #[test]
    fn the_true_share_gives_the_exact_image() {
        let warp = DepthWarp::new(0.1, 500.0);
        for seed in 0..100 {
            let mut f = stack(12, seed);
            crate::fragment::sort_front_to_back(&mut f);
            let points = points(&f);
            let exact = over::composite(&f, C0);
            let all = seen(&points, &warp, SumPrecision::Exact);
            for separate_ends in [false, true] {
                let got = composite(&f, C0, &warp, separate_ends, |x| {
                    // Which fragment it is, by what it sees.
                    let i = all.iter().position(|s| s.rest == *x).expect("one of them");
                    let front: f64 = f[..i].iter().map(|f| absorbance(f.alpha)).sum();
                    (front - all[i].front) / all[i].rest.absorbance
                });
                let same_level = all.iter().filter(|s| s.place != Place::Between).count() > 2;
                for k in 0..3 {
                    assert!(
                        same_level || (got[k] - exact[k]).abs() < 1e-5,
                        "{seed}: {got:?} {exact:?}"
                    );
                }
            }
        }
    }

    /// Scaling a scene changes no feature beyond rounding: ζ errs by 1e−7 of its range from 32-bit depths, and
    /// differences over the pixel's range amplify it by the inverse of that range's share, here at most 1e3.
    #[test]
    fn features_are_free_of_scale() {
        for seed in 0..50 {
            let f = stack(9, seed);
            let points = points(&f);
            let near = points.iter().map(|p| p.0).fold(f32::MAX, f32::min);
            let far = points.iter().map(|p| p.0).fold(0.0, f32::max);
            let base = seen(
                &points,
                &DepthWarp::new(near.into(), far.into()),
                SumPrecision::Exact,
            );
            for factor in [1e-3f32, 1e3] {
                let scaled: Vec<_> = points.iter().map(|&(z, a)| (z * factor, a)).collect();
                let warp = DepthWarp::new((near * factor).into(), (far * factor).into());
                for (a, b) in base.iter().zip(seen(&scaled, &warp, SumPrecision::Exact)) {
                    assert_eq!(a.place, b.place);
                    // A depth at the edge of a bin may fall on its other side, and another end be known then.
                    let rests = a.rest.absorbance - b.rest.absorbance;
                    if (a.front - b.front).abs() + rests.abs() > 1e-9 {
                        continue;
                    }
                    // The share bounds jump where a point of the bound passes the fragment.
                    for (x, y) in all(&a.rest).iter().zip(all(&b.rest)).take(3) {
                        assert!((x - y).abs() < 1e-3, "{a:?} {b:?}");
                    }
                }
            }
        }
    }

    /// Hand-worked: five equal layers (α = ½) at ζ = −1, −½, 0, ½, 1, seen from the middle one. The rest lies a quarter and
    /// three quarters into the range: mean ½, deviation ¼, no skew, half in front, and the nearest is known.
    #[test]
    fn the_middle_of_five() {
        let f = [0.0, 0.5, 1.0, 1.5, 2.0].map(|e| (10f32.powf(e), 0.5));
        let s = seen(&f, &DepthWarp::new(1.0, 100.0), SumPrecision::Exact);
        assert_eq!(s[0].place, Place::Nearest);
        assert_eq!(s[4].place, Place::Farthest);
        assert!(s[1..4].iter().all(|s| s.place == Place::Between));
        let half = 2f64.ln();
        // b/(1 + b) is quantised to steps of 1/255 (near) and 1/31 (far): b is off by half of that times (1 + b)² at most.
        let near = 0.5 / 255.0 * (1.0 + half).powi(2);
        let far = 0.5 / 31.0 * (1.0 + half).powi(2);
        assert!((s[2].front - half).abs() < near);
        let rest = s[2].rest;
        assert!((rest.absorbance - 2.0 * half).abs() < near + far);
        let want = [(2.0 * half).sqrt(), 0.5, 0.5, 0.5, 0.5];
        for (k, want) in want.into_iter().enumerate() {
            // What is left of the ends weighs 2, 4, 8 and 16 times as much in the moments as the rest, which lies half as far
            // from the middle; the bounds sum up all four.
            let tolerance = [1.0, 0.0, 2.0, 16.0, 16.0][k] * (near + far)
                // The farthest fragment's depth is known to half a bin.
                + 1.0 / f64::from(FAR_END.bins);
            assert!(
                (all(&rest)[k] - want).abs() < tolerance,
                "{k}: {:?}",
                all(&rest)
            );
        }
        // The second layer has nothing of the rest in front, the fourth all.
        let exact = [1.0, 0.5, 0.25, 0.125, 0.0625];
        for (i, share) in [(1, 0.0), (2, 0.5), (3, 1.0)] {
            let w = s[i].weight(|_| share);
            assert!((w / exact[i] - 1.0).abs() < 2.0 * (near + far), "{i}: {w}");
        }
    }

    /// Faint fragments take part, and take no anchor.
    #[test]
    fn a_faint_fragment_is_no_anchor() {
        let s = seen(
            &[(1.0, 0.002), (2.0, 0.5), (3.0, 0.5)],
            &DepthWarp::new(1.0, 3.0),
            SumPrecision::Exact,
        );
        assert_eq!(
            [s[0].place, s[1].place, s[2].place],
            [Place::Between, Place::Nearest, Place::Farthest]
        );
        // Two hundred of them and nothing else: coverage is exact, nothing is lost.
        let f: Vec<_> = (0..200)
            .map(|i| Fragment::new(1.0 + i as f32, 0.003, [1.0; 3]))
            .collect();
        let got = composite(&f, [0.0; 3], &DepthWarp::new(1.0, 200.0), true, |_| 0.5);
        let want = 1.0 - 0.997f32.powi(200);
        assert!((got[0] - want).abs() < 1e-5, "{} {want}", got[0]);
    }
}
