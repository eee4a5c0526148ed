//! What the learned methods know of a pixel, and the features that their networks read.
//!
//! Pass 1 sums absorbance `b_i` and its moments over warped depth, `b_k = Σ b_i ζ_i^k`, and keeps the pixel's nearest and
//! farthest ζ with their opacities. Pass 2 takes a fragment's *own share* out of the moments, and the shares of the
//! two ends, which are known: what is left to be guessed is where the *rest* lies. What lies in front of a fragment
//! does not depend on the fragment. All features are free of scene scale and unit. The shader twin is the
//! `peelnet_features` of every exported text.
//!
//! Written once for 32 and 64 bits: 32 is what shaders compute, 64 what trains and judges.

use crate::{absorbance::ABSORBANCE_MAX, methods::mboit4};
use num_traits::Float;

/// Number of levels that a depth in −1 … 1 is quantised to before nearest and farthest are told: see [`half_of_code`].
pub const DEPTH_CODES: u32 = 61_440;

/// The level of a warped depth, 0 for −1 and [`DEPTH_CODES`] − 1 for 1.
pub fn depth_code(zeta: f64) -> u32 {
    let top = f64::from(DEPTH_CODES - 1);
    ((zeta * 0.5 + 0.5) * top + 0.5).floor().clamp(0.0, top) as u32
}

/// The warped depth in the middle of a level.
pub fn zeta_of_code(code: u32) -> f64 {
    f64::from(code) / f64::from(DEPTH_CODES - 1) * 2.0 - 1.0
}

/// Bits of the half float that stands for a level: all normal halves in ascending order.
///
/// MAX blending of 16-bit targets compares values, not what they mean, so the levels are spread over *all* normal halves:
/// 61,440 equal steps of 3.3e−5 of the frame's depth range. Storing ζ itself would waste most of the format's values
/// near zero and tell depths near the ends of the range apart by 4.9e−4 only. The negated half is the level counted from
/// the other end, so one MAX blending keeps both extremes.
pub fn half_of_code(code: u32) -> u16 {
    let half = DEPTH_CODES / 2;
    if code >= half {
        (0x400 + code - half) as u16
    } else {
        (0x8400 + half - 1 - code) as u16
    }
}

/// The largest difference of levels at which a fragment still counts as the nearest or the farthest.
///
/// One: two passes of one shader may round a depth that lies between two levels differently. Missing the nearest
/// fragment would cost its anchor, and two fragments within 6.5e−5 of the depth range are as good as one.
pub const SAME_CODE: u32 = 1;

/// A fragment's depth, coarsely, and its opacity in one level: MAX blending of it keeps the opacity of the fragment with
/// the largest depth. Of fragments in one bin it keeps the most opaque one's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndCode {
    /// Levels of depth.
    pub bins: u32,
    /// Levels of opacity: even steps of `b/(1 + b)`, `b` absorbance, which err in transmittance `e^−b` by three quarters of a
    /// step at most, cost a division to read, and reach [`ABSORBANCE_MAX`]. The bins times the alphas are [`DEPTH_CODES`].
    pub alphas: u32,
}

/// Of the nearest fragment, whose exact level is kept beside it, so that its opacity gets most of the levels.
pub const NEAR_END: EndCode = EndCode {
    bins: 240,
    alphas: 256,
};

/// Of the farthest fragment, which is recognised by this level alone.
pub const FAR_END: EndCode = EndCode {
    bins: 1920,
    alphas: 32,
};

/// Makes [`ABSORBANCE_MAX`] the last level of opacity.
const MOST_LEVEL: f64 = (ABSORBANCE_MAX + 1.0) / ABSORBANCE_MAX;

impl EndCode {
    /// The level of a fragment.
    pub fn level(self, zeta: f64, absorbance: f64) -> u32 {
        self.bin(zeta) * self.alphas + self.alpha_level(absorbance)
    }

    /// The level with depth counted from the far end, for the nearest fragment.
    pub fn mirrored(self, zeta: f64, absorbance: f64) -> u32 {
        (self.bins - 1 - self.bin(zeta)) * self.alphas + self.alpha_level(absorbance)
    }

    fn bin(self, zeta: f64) -> u32 {
        let bin = ((zeta * 0.5 + 0.5) * f64::from(self.bins)).floor();
        bin.clamp(0.0, f64::from(self.bins - 1)) as u32
    }

    fn alpha_level(self, absorbance: f64) -> u32 {
        let top = f64::from(self.alphas - 1);
        (absorbance / (absorbance + 1.0) * MOST_LEVEL * top + 0.5).floor() as u32
    }

    /// The absorbance that a level stands for, at most [`ABSORBANCE_MAX`].
    pub fn absorbance(self, level: u32) -> f64 {
        let share = f64::from(level % self.alphas) / f64::from(self.alphas - 1);
        share / (MOST_LEVEL - share)
    }

    /// The warped depth in the middle of a level's bin, not mirrored.
    pub fn zeta(self, level: u32) -> f64 {
        (f64::from(level / self.alphas) + 0.5) / f64::from(self.bins) * 2.0 - 1.0
    }
}

/// How the sums are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SumPrecision {
    /// Without rounding.
    #[default]
    Exact,
    /// As 16-bit targets do it: every term and every sum is rounded to a half.
    Half,
}

impl SumPrecision {
    /// A sum with one more term.
    fn add(self, sum: f64, term: f64) -> f64 {
        let half = |x: f64| f64::from(half::f16::from_f64(x));
        match self {
            Self::Exact => sum + term,
            Self::Half => half(sum + half(term)),
        }
    }
}

/// The sums and extremes of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics<F> {
    /// `b_0 … b_4`.
    pub moments: [F; 5],
    /// Smallest warped depth.
    pub nearest: F,
    /// Largest warped depth.
    pub farthest: F,
}

impl Statistics<f64> {
    /// Of a pixel's fragments, with sums of the given precision.
    pub fn rounded(
        fragments: impl IntoIterator<Item = (f64, f64)>,
        precision: SumPrecision,
    ) -> Self {
        Self::summed(fragments, |sum, term| precision.add(sum, term))
    }
}

impl<F: Float> Statistics<F> {
    /// Of a pixel without fragments.
    pub fn empty() -> Self {
        Self {
            moments: [F::zero(); 5],
            nearest: F::one(),
            farthest: -F::one(),
        }
    }

    /// Of a pixel's fragments, as (absorbance, warped depth).
    pub fn of(fragments: impl IntoIterator<Item = (F, F)>) -> Self {
        Self::summed(fragments, |sum, term| sum + term)
    }

    fn summed(fragments: impl IntoIterator<Item = (F, F)>, add: impl Fn(F, F) -> F) -> Self {
        let mut s = Self::empty();
        for (b, zeta) in fragments {
            let mut power = b;
            for m in &mut s.moments {
                *m = add(*m, power);
                power = power * zeta;
            }
            s.nearest = s.nearest.min(zeta);
            s.farthest = s.farthest.max(zeta);
        }
        s
    }

    /// The moments without some fragments, given as (absorbance, warped depth): `m_k = b_k − Σ b ζ^k`. `m_0` is never
    /// negative.
    pub fn without(&self, fragments: &[(F, F)]) -> [F; 5] {
        let mut m = self.moments;
        for &(b, zeta) in fragments {
            let mut power = b;
            for sum in &mut m {
                *sum = *sum - power;
                power = power * zeta;
            }
        }
        m[0] = m[0].max(F::zero());
        m
    }
}

/// Names and units of [`features`], in order.
pub const FEATURES: [(&str, &str); 9] = [
    ("root_absorbance", "root of the rest's absorbance"),
    ("depth_fraction", "of the pixel's depth range"),
    ("mean_fraction", "of the pixel's depth range"),
    ("share_low", "of the rest's absorbance"),
    ("share_high", "of the rest's absorbance"),
    ("interval_low", "of the rest's absorbance"),
    ("interval_high", "of the rest's absorbance"),
    ("depth_deviation", "half standard deviations"),
    ("skewness", "half skewness"),
];

/// Below this share of the pixel's absorbance the moments of the rest are rounding noise of 16-bit sums.
const NOISE: f64 = 1.0 / 1024.0;

/// The least standard deviation, in halves of the pixel's depth range.
const DEVIATION_FLOOR: f64 = 1.0 / 32.0;

/// The same for the skewness, whose third power makes noise of rounded sums out of narrow distributions.
const SKEWNESS_FLOOR: f64 = 1.0 / 4.0;

/// Pull of the moments towards a measure that can be inverted, for [`features`] 3 and 4.
const BIAS: f64 = 1.0 / 1024.0;

/// More of that pull for narrow pixels: moments of the frame's range lose `scale⁴` of their precision where they are moved to
/// the pixel's, and without it the bounds answer to the last bits of 32-bit sums.
const BIAS_BY_SCALE: f64 = 1.0 / 65_536.0;

/// The most of that pull.
const BIAS_MAX: f64 = 0.25;

/// The features of a fragment at depth `zeta`, given the moments `m` of the rest: all fragments but itself and the
/// pixel's ends.
///
/// 0. `√m_0`
/// 1. where in the pixel's range the fragment lies, 0 … 1
/// 2. where the rest's mean μ lies, 0 … 1
/// 3. and 4.: the least and the most of the rest's absorbance that can lie in front of the fragment, as shares, given four
///    moments (Münstermann et al. 2018, §3.2; overestimation 0 and 1)
/// 5. and 6.: the same from three moments and that all of it lies between the ends ([`interval_bounds`])
/// 7. `clamp((ζ − μ)/2σ, −2, 2)`, σ the rest's standard deviation
/// 8. `clamp(skewness/2, −2, 2)` of the rest, σ at least an eighth of the range in it
pub fn features<F: Float>(s: &Statistics<F>, m: &[F; 5], zeta: F) -> [F; 9] {
    // Every constant below is exactly a 32-bit float.
    let c = |x: f64| F::from(x).unwrap_or_else(F::zero);
    let (one, two) = (F::one(), c(2.0));
    let level = two / c(f64::from(DEPTH_CODES - 1));
    let extent = (s.farthest - s.nearest).max(level);
    let total = m[0].max(s.moments[0] * c(NOISE)).max(c(1e-6));
    // Moments over the pixel's range as −1 … 1: of (ζ − middle)·scale.
    let middle = (s.nearest + s.farthest) / two;
    let scale = two / extent;
    let [m1, m2, m3, m4] = [m[1] / total, m[2] / total, m[3] / total, m[4] / total];
    let x1 = ((m1 - middle) * scale).max(-one).min(one);
    let x2 = (m2 - middle * (two * m1 - middle)) * scale.powi(2);
    let x3 = (m3 - middle * (c(3.0) * m2 - middle * (c(3.0) * m1 - middle))) * scale.powi(3);
    let x4 = {
        let inner = c(6.0) * m2 - middle * (c(4.0) * m1 - middle);
        (m4 - middle * (c(4.0) * m3 - middle * inner)) * scale.powi(4)
    };
    let x = ((zeta - middle) * scale).max(-one).min(one);
    let bias = (c(BIAS) + c(BIAS_BY_SCALE) * scale.powi(4)).min(c(BIAS_MAX));
    let (low, high) = clamped(mboit4::share_bounds([x1, x2, x3, x4], bias, x));
    let sigma = (x2 - x1 * x1)
        .max(c(DEVIATION_FLOOR * DEVIATION_FLOOR))
        .sqrt();
    let wide = sigma.max(c(SKEWNESS_FLOOR));
    let third = x3 - x1 * (c(3.0) * x2 - two * x1 * x1);
    let half_clamp = |value: F| (value / two).max(-two).min(two);
    let (interval_low, interval_high) = interval_bounds([x1, x2, x3], x);
    [
        m[0].sqrt(),
        (x + one) / two,
        (x1 + one) / two,
        low,
        high,
        interval_low,
        interval_high,
        half_clamp((x - x1) / sigma),
        half_clamp(third / wide.powi(3)),
    ]
}

/// Both shares in 0 … 1; NaN, where the points of a bound coincide, becomes 0.
fn clamped<F: Float>((low, high): (F, F)) -> (F, F) {
    let clamp = |share: F| share.max(F::zero()).min(F::one());
    (clamp(low), clamp(high))
}

/// The least and the most of a distribution on −1 … 1 that can lie in front of `x`, from its first three moments.
///
/// The extreme distribution has three points: `x`, one end of the interval, and one more, `y` (Krein & Nudelman, "The
/// Markov Moment Problem and Extremal Problems", 1977, ch. III: the canonical representation of index 5/2 through `x`).
/// If the end is −1, the moments of `(t + 1) dμ` have the two points `x` and `y`, which gives `y`; else those of
/// `(1 − t) dμ`. Both shares are kept in 0 … 1; moments that no distribution has, as rounding makes them, give 0 at worst.
pub fn interval_bounds<F: Float>(moments: [F; 3], x: F) -> (F, F) {
    let (zero, one) = (F::zero(), F::one());
    let [m1, m2, m3] = moments;
    let point = |[n0, n1, n2]: [F; 3]| (n2 - x * n1) / (n1 - x * n0);
    let in_front = |share: F, y: F| if y < x { share } else { zero };
    let low_end = [one + m1, m1 + m2, m2 + m3];
    let y = point(low_end);
    let (low, at) = if y >= -one && y <= one {
        let [n0, n1, _] = low_end;
        let at = (n1 - y * n0) / ((x - y) * (one + x));
        let other = (n1 - x * n0) / ((y - x) * (one + y));
        (one - at - other + in_front(other, y), at)
    } else {
        let high_end = [one - m1, m1 - m2, m2 - m3];
        let [n0, n1, _] = high_end;
        let y = point(high_end);
        let at = (n1 - y * n0) / ((x - y) * (one - x));
        let other = (n1 - x * n0) / ((y - x) * (one - y));
        (in_front(other, y), at)
    };
    clamped((low, low + at))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels ascend as halves ascend, negating mirrors them, and every half is normal.
    #[test]
    fn half_codes_are_ordered_and_mirrored() {
        let value = |code| half::f16::from_bits(half_of_code(code));
        for code in 0..DEPTH_CODES {
            assert!(value(code).is_normal(), "{code}");
            assert_eq!(value(DEPTH_CODES - 1 - code), -value(code));
            assert!(code == 0 || value(code) > value(code - 1), "{code}");
        }
    }

    /// Rounding to the nearest level: half a level off at most.
    #[test]
    fn codes_round_trip() {
        let half_level = 1.0 / f64::from(DEPTH_CODES - 1);
        for i in 0..=1000 {
            let zeta = f64::from(i) / 500.0 - 1.0;
            let back = zeta_of_code(depth_code(zeta));
            assert!(
                (back - zeta).abs() <= half_level * 1.000_001,
                "{zeta} {back}"
            );
        }
        for code in 0..DEPTH_CODES {
            assert_eq!(depth_code(zeta_of_code(code)), code);
        }
    }

    /// `b/(1 + b)` is off by half a step, so `b` by what half a step more makes of it.
    #[test]
    fn end_codes_keep_the_opacity_of_the_extreme() {
        for code in [NEAR_END, FAR_END] {
            assert_eq!(code.bins * code.alphas, DEPTH_CODES);
            let bin = 2.0 / f64::from(code.bins);
            for i in 0..=1000 {
                let alpha = f64::from(i) / 1001.0;
                let exact = -(1.0 - alpha).ln();
                let level = code.level(0.3, exact);
                let error = (code.absorbance(level) - exact).abs();
                let step = 0.5 / f64::from(code.alphas - 1);
                let share = exact / (exact + 1.0) * MOST_LEVEL + step;
                let limit = if share < MOST_LEVEL {
                    share / (MOST_LEVEL - share) - exact + 1e-12
                } else {
                    ABSORBANCE_MAX
                };
                assert!(error <= limit, "{alpha}: {error} {limit}");
                assert!((code.zeta(level) - 0.3).abs() <= bin / 2.0 + 1e-12);
                // Farther wins, nearer in the mirrored level, whatever the opacities.
                assert!(code.level(0.3 + 2.0 * bin, 0.0) > level);
                assert!(code.mirrored(0.3 - 2.0 * bin, 0.0) > code.mirrored(0.3, exact));
                assert_eq!(
                    code.absorbance(code.mirrored(-0.7, exact)),
                    code.absorbance(level)
                );
            }
            assert_eq!(code.level(1.0, ABSORBANCE_MAX), DEPTH_CODES - 1);
            assert_eq!(code.mirrored(-1.0, ABSORBANCE_MAX), DEPTH_CODES - 1);
            assert_eq!(
                code.absorbance(code.level(0.0, ABSORBANCE_MAX)),
                ABSORBANCE_MAX
            );
        }
    }

    /// Distributions of a few points on −1 … 1: the share in front of any x lies within both bounds.
    #[test]
    fn bounds_hold() {
        let mut random = crate::random::Random::new(5, &[]);
        for _ in 0..2000 {
            let n = 3 + random.below(6);
            let points: Vec<(f64, f64)> = (0..n)
                .map(|_| {
                    (
                        f64::from(random.between(-1.0, 1.0)),
                        0.05 + f64::from(random.unit()),
                    )
                })
                .collect();
            let total: f64 = points.iter().map(|p| p.1).sum();
            let moment = |k: i32| points.iter().map(|p| p.1 * p.0.powi(k)).sum::<f64>() / total;
            let m = [moment(1), moment(2), moment(3), moment(4)];
            let x = f64::from(random.between(-0.96, 0.96));
            let share = points.iter().filter(|p| p.0 < x).map(|p| p.1).sum::<f64>() / total;
            let (low, high) = interval_bounds([m[0], m[1], m[2]], x);
            // 64-bit moments: nothing but rounding, where the points nearly coincide.
            assert!(
                low <= share + 1e-6 && share <= high + 1e-6,
                "{low} {share} {high}"
            );
            // The bias gives way by up to its square root times a few.
            let (low, high) = clamped(mboit4::share_bounds(m, BIAS, x));
            let slack = 4.0 * BIAS.sqrt();
            assert!(
                low <= share + slack && share <= high + slack,
                "{low} {share} {high}"
            );
        }
    }

    /// The 32-bit features follow the 64-bit ones. Mean powers err by a few roundings (2⁻²⁴) of values ≤ 1; moving them to the
    /// pixel's range multiplies by up to its inverse (here 10, as the range is at least a tenth of the frame's).
    #[test]
    fn both_precisions_agree() {
        let mut stream = crate::random::Random::new(9, &[]);
        let mut random = move || f64::from(stream.unit());
        for _ in 0..500 {
            let n = 2 + (random() * 20.0) as usize;
            let (centre, width) = (random() - 0.5, 0.1 + 0.4 * random());
            let points: Vec<(f64, f64)> = (0..n)
                .map(|_| {
                    (
                        0.02 + 3.0 * random(),
                        centre + width * (2.0 * random() - 1.0),
                    )
                })
                .collect();
            let wide = Statistics::of(points.iter().copied());
            let narrow = Statistics::of(points.iter().map(|&(b, z)| (b as f32, z as f32)));
            for &(b, z) in &points {
                let m = wide.without(&[(b, z)]);
                let (b32, z32) = (b as f32, z as f32);
                let (a, c) = (
                    features(&wide, &m, z),
                    features(&narrow, &narrow.without(&[(b32, z32)]), z32),
                );
                for k in 0..3 {
                    let roundings = 4.0 / f64::from(1 << 24);
                    let width = f64::from(narrow.farthest - narrow.nearest) / 2.0;
                    let tolerance = roundings / width * 8.0;
                    let noisy = m[0] < 0.1 * wide.moments[0];
                    assert!(
                        noisy || (a[k] - f64::from(c[k])).abs() < tolerance,
                        "{k}: {} {}",
                        a[k],
                        c[k]
                    );
                }
            }
        }
    }
}
