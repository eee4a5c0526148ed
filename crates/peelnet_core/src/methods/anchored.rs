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
    fragment::{Fragment, points},
    guards::FILL_MAX,
    methods::{known::KnownFragment, moments::power::four_moment_bounds},
    statistics::{
        DEPTH_CODES, FARTHEST_CODE, NEAREST_CODE, SAME_CODE, Statistics, SumPrecision, depth_code,
        zeta_of_code,
    },
};

/// Fragments of less opacity are composited, but are never a pixel's nearest or farthest: an invisible fragment would
/// waste the anchor.
pub const LOW_ALPHA: f32 = 1.0 / 255.0;

/// Below this share of the pixel's absorbance the moments of the rest are rounding noise of 16-bit sums.
const NOISE: f64 = 1.0 / 1024.0;

/// Pull of the moments towards a measure that can be inverted, for [`Residual::moment_bounds`].
const BIAS: f64 = 1.0 / 1024.0;

/// More of that pull for narrow pixels: moments of the frame's range lose `scale⁴` of their precision where they are moved to
/// the pixel's, and without it the bounds depend on the last bits of 32-bit sums.
const BIAS_BY_SCALE: f64 = 1.0 / 65_536.0;

/// Limit of the mean powers 2 to 4. In narrow pixels, the rounding of the ends and of the sums takes them beyond 1; bounds multiply
/// up to seven of them, which 32 bits hold.
const POWER_MAX: f64 = 65_536.0;

/// The most of that pull.
const BIAS_MAX: f64 = 0.25;

/// The rest of a pixel, seen from one fragment: all fragments but that one and the pixel's ends. Depths are over the pixel's
/// range, −1 at the nearest and 1 at the farthest fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    pub absorbance: f64,
    pub place: f64,
    /// Mean powers 1 to 4 of the rest's depth.
    pub means: [f64; 4],
    /// Pull of the moments towards a measure that can be inverted.
    pub bias: f64,
}

impl Residual {
    /// Of a fragment at depth `zeta`, given the pixel's statistics and the moments `m` of the rest.
    pub fn new(s: &Statistics, m: &[f64; 5], zeta: f64) -> Self {
        let level = 2.0 / f64::from(DEPTH_CODES - 1);
        let extent = (s.farthest - s.nearest).max(level);
        let total = m[0].max(s.moments[0] * NOISE).max(1e-6);
        // Moments over the pixel's range as −1 … 1: of (ζ − middle)·scale.
        let middle = (s.nearest + s.farthest) / 2.0;
        let scale = 2.0 / extent;
        let [m1, m2, m3, m4] = [m[1] / total, m[2] / total, m[3] / total, m[4] / total];
        let x1 = ((m1 - middle) * scale).clamp(-1.0, 1.0);
        let x2 = (m2 - middle * (2.0 * m1 - middle)) * scale.powi(2);
        let x3 = (m3 - middle * (3.0 * m2 - middle * (3.0 * m1 - middle))) * scale.powi(3);
        let x4 = {
            let inner = 6.0 * m2 - middle * (4.0 * m1 - middle);
            (m4 - middle * (4.0 * m3 - middle * inner)) * scale.powi(4)
        };
        let power = |mean: f64| mean.clamp(-POWER_MAX, POWER_MAX);
        Self {
            absorbance: m[0],
            place: ((zeta - middle) * scale).clamp(-1.0, 1.0),
            means: [x1, power(x2), power(x3), power(x4)],
            bias: (BIAS + BIAS_BY_SCALE * scale.powi(4)).min(BIAS_MAX),
        }
    }

    /// The least and the most of the rest's absorbance that can lie in front of the fragment, as shares, given four moments
    /// (Münstermann et al. 2018, §3.2; overestimation 0 and 1). NaN, where the points of a bound coincide, becomes 0.
    pub fn moment_bounds(&self) -> [f64; 2] {
        let (low, high) = four_moment_bounds(self.means, self.bias, self.place);
        [low, high].map(|fraction| {
            if fraction > 0.0 {
                fraction.min(1.0)
            } else {
                0.0
            }
        })
    }
}

/// What is known of each fragment of a pixel, in the order given: fragments are (linear depth, α). The unknown is all fragments but
/// this one and the ends.
pub fn known_fragments(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    precision: SumPrecision,
) -> Vec<KnownFragment<Residual>> {
    let points = super::points(fragments, warp);
    let visible = points.iter().filter(|point| point.2);
    // Without a visible fragment the targets keep their clear values.
    let (mut first, mut near, mut far) = (DEPTH_CODES - 1, 0, 0);
    for &(b, zeta, _) in visible {
        first = first.min(depth_code(zeta));
        near = near.max(NEAREST_CODE.mirrored(zeta, b));
        far = far.max(FARTHEST_CODE.level(zeta, b));
    }
    let s = Statistics {
        moments: Statistics::moments(&points, precision),
        nearest: zeta_of_code(first),
        farthest: FARTHEST_CODE.zeta(far),
    };
    points
        .iter()
        .map(|&(b, zeta, is_visible)| {
            let code = depth_code(zeta);
            let (own_near, own_far) =
                (NEAREST_CODE.mirrored(zeta, b), FARTHEST_CODE.level(zeta, b));
            if is_visible && code <= first + SAME_CODE {
                return KnownFragment::known(0.0);
            }
            if is_visible && own_far == far {
                return KnownFragment::known(s.without(&[(b, zeta)])[0]);
            }
            // An end that does not lie on its side of the fragment, or whose place in the target the fragment took itself (a
            // more opaque one in the same bin), stays with the rest.
            let front = if code > first && own_near != near {
                NEAREST_CODE.absorbance(near)
            } else {
                0.0
            };
            let back = if own_far < far {
                FARTHEST_CODE.absorbance(far)
            } else {
                0.0
            };
            let rest = s.without(&[(b, zeta), (front, s.nearest), (back, s.farthest)]);
            let residual = Residual::new(&s, &rest, zeta);
            KnownFragment {
                front,
                absorbance: residual.absorbance,
                bounds: [0.0, 1.0],
                unknown: Some(residual),
            }
        })
        .collect()
}

pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    separate_extremes: bool,
    fraction: impl Fn(&Residual) -> f64,
) -> [f32; 3] {
    let known = known_fragments(&points(fragments), warp, SumPrecision::Exact);
    let weights = known
        .iter()
        .map(|f| (f.weight(&fraction), f.unknown.is_none()));
    composite_weighted(fragments, background, separate_extremes, weights)
}

/// Composites a pixel with the weight of each fragment, and whether it is known. Those have sums of their own where they are `apart`.
pub fn composite_weighted(
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
        resolve_separate_extremes(sums[0], sums[1], t, background)
    } else {
        resolve(sums[0], t, background)
    }
    .map(|c| c as f32)
}

/// A pixel's colour from the sums of all its fragments, `Σ α c w` and `Σ α w`, its transmittance and the background. The shader
/// shader is `peelnet_composite` in `learned/resolve.wgsl`.
pub fn resolve(sums: [f64; 4], transmittance: f64, background: [f64; 3]) -> [f64; 3] {
    let fraction = if sums[3] > 0.0 {
        (1.0 - transmittance) / sums[3].max(f64::MIN_POSITIVE)
    } else {
        0.0
    };
    std::array::from_fn(|k| sums[k] * fraction + background[k] * transmittance)
}

/// The same with the pixel's ends in sums of their own. The shader is `peelnet_composite` in
/// `learned/resolve_separate_ends.wgsl`.
pub fn resolve_separate_extremes(
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
    use crate::{methods::over, random::Random};

    const C0: [f32; 3] = [0.3, 0.1, 0.7];

    /// Given the true shares, any number of layers is exact: w_i is T_i then.
    #[test]
    fn the_true_share_gives_the_exact_image() {
        let warp = DepthWarp::new(0.1, 500.0);
        for seed in 0..100 {
            let mut random = Random::new(seed, &[]);
            let mut layer = |_| {
                let depth = random.log_between(0.1, 500.0);
                Fragment::new(depth, random.between(0.02, 0.98), random.color())
            };
            let f = over::sorted(&(0..12).map(&mut layer).collect::<Vec<_>>());
            let points = points(&f);
            let exact = over::composite(&f, C0);
            let all = known_fragments(&points, &warp, SumPrecision::Exact);
            for separate_extremes in [false, true] {
                let got = composite(&f, C0, &warp, separate_extremes, |x| {
                    // Which fragment it is, by what it sees.
                    let i = all.iter().position(|f| f.unknown == Some(*x));
                    let i = i.expect("one of them");
                    let front: f64 = f[..i].iter().map(|f| absorbance(f.alpha)).sum();
                    (front - all[i].front) / x.absorbance
                });
                let same_level = all.iter().filter(|f| f.unknown.is_none()).count() > 2;
                let is_near = (0..3).all(|k| (got[k] - exact[k]).abs() < 1e-5);
                assert!(same_level || is_near, "{seed}: {got:?} {exact:?}");
            }
        }
    }

    /// Faint fragments take no anchor.
    #[test]
    fn a_low_alpha_fragment_is_no_anchor() {
        let f = [(1.0, 0.002), (2.0, 0.5), (3.0, 0.5)];
        let all = known_fragments(&f, &DepthWarp::new(1.0, 3.0), SumPrecision::Exact);
        let [low_alpha, nearest, farthest] = &all[..] else {
            panic!("{all:?}")
        };
        assert!(low_alpha.unknown.is_some() && farthest.unknown.is_none());
        assert_eq!((nearest.front, nearest.unknown), (0.0, None));
    }
}
