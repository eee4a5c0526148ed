//! The statistics of a pixel that the learned methods gather in their first pass.
//!
//! Pass 1 sums absorbance `b_i` and its moments over warped depth, `b_k = Σ b_i ζ_i^k`, and keeps the pixel's nearest and
//! farthest ζ with their opacities. What the networks read of them is said by the inputs of `peelnet_model`. The shader is
//! `learned/anchored.wgsl`, part of every exported text.
//!
//! A fragment's own share is taken out before it asks what lies in front of it, as in the write-up of wavelet transparency by Osorio
//! López (osor.io/OIT) and in Flywheel's shaders (`signal_corrected_transmittance`).

use crate::{absorbance::ABSORBANCE_MAX, methods::Point};

/// Number of levels that a depth in −1 … 1 is quantised to before the nearest and the farthest are kept: see [`half_of_code`].
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
/// near zero and resolve depths near the ends of the range to 4.9e−4 only. The negated half is the level counted from
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
pub struct ExtremeCode {
    pub bins: u32,
    /// Levels of opacity: even steps of `b/(1 + b)`, `b` absorbance, which err in transmittance `e^−b` by three quarters of a
    /// step at most, cost a division to read, and reach [`ABSORBANCE_MAX`]. The bins times the alphas are [`DEPTH_CODES`].
    pub alphas: u32,
}

/// Of the nearest fragment, whose exact level is kept beside it, so that its opacity gets most of the levels.
pub const NEAREST_CODE: ExtremeCode = ExtremeCode {
    bins: 240,
    alphas: 256,
};

/// Of the farthest fragment, which is recognised by this level alone.
pub const FARTHEST_CODE: ExtremeCode = ExtremeCode {
    bins: 1920,
    alphas: 32,
};

/// Makes [`ABSORBANCE_MAX`] the last level of opacity.
const MOST_LEVEL: f64 = (ABSORBANCE_MAX + 1.0) / ABSORBANCE_MAX;

impl ExtremeCode {
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

    /// Whether a fragment's level is the one kept. Two passes may round a depth on the edge of two bins to either, so a bin's difference counts
    /// as none; opacities are the same in both.
    pub const fn is_kept(self, own: u32, kept: u32) -> bool {
        own == kept || own.abs_diff(kept) == self.alphas
    }

    /// The absorbance that a level stands for, at most [`ABSORBANCE_MAX`].
    pub fn absorbance(self, level: u32) -> f64 {
        let fraction = f64::from(level % self.alphas) / f64::from(self.alphas - 1);
        fraction / (MOST_LEVEL - fraction)
    }

    /// The warped depth in the middle of a level's bin, not mirrored.
    pub fn zeta(self, level: u32) -> f64 {
        (f64::from(level / self.alphas) + 0.5) / f64::from(self.bins) * 2.0 - 1.0
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SumPrecision {
    #[default]
    Exact,
    /// As 16-bit targets do it: every term and every sum is rounded to a half.
    Half,
}

impl SumPrecision {
    pub(crate) fn add(self, sum: f64, term: f64) -> f64 {
        let half = |x: f64| f64::from(half::f16::from_f64(x));
        match self {
            Self::Exact => sum + term,
            Self::Half => half(sum + half(term)),
        }
    }
}

/// `b`, `b ζ`, `b ζ²` ….
pub(crate) fn moments_of(b: f64, zeta: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(b), move |power| Some(power * zeta))
}

/// The sums and extremes of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// `b_0 … b_4`.
    pub moments: [f64; 5],
    pub nearest: f64,
    pub farthest: f64,
}

impl Statistics {
    pub fn moments(fragments: &[Point], precision: SumPrecision) -> [f64; 5] {
        let mut moments = [0.0; 5];
        for &(b, zeta, _) in fragments {
            for (sum, moment) in moments.iter_mut().zip(moments_of(b, zeta)) {
                *sum = precision.add(*sum, moment);
            }
        }
        moments
    }

    /// The moments without some fragments, given as (absorbance, warped depth): `m_k = b_k − Σ b ζ^k`. `m_0` is never
    /// negative.
    pub fn without(&self, fragments: &[(f64, f64)]) -> [f64; 5] {
        let mut m = self.moments;
        for &(b, zeta) in fragments {
            for (sum, moment) in m.iter_mut().zip(moments_of(b, zeta)) {
                *sum -= moment;
            }
        }
        m[0] = m[0].max(0.0);
        m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half floats have eleven bits: 1 is lost beside 4096, and a term is rounded before it is added.
    #[test]
    fn halves_round_terms_and_sums() {
        let half = |sum, term| SumPrecision::Half.add(sum, term);
        assert_eq!(half(1.5, 0.25), 1.75);
        assert_eq!(half(4096.0, 1.0), 4096.0);
        assert_eq!(half(0.0, 1.0 + 1.0 / 4096.0), 1.0);
        assert_eq!(SumPrecision::Exact.add(4096.0, 1.0), 4097.0);
    }

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
            let error = (back - zeta).abs();
            assert!(error <= half_level * 1.000_001, "{zeta} {back}");
        }
        for code in 0..DEPTH_CODES {
            assert_eq!(depth_code(zeta_of_code(code)), code);
        }
    }

    /// `b/(1 + b)` is off by half a step, so `b` by what half a step more makes of it.
    #[test]
    fn extreme_codes_keep_the_opacity_of_the_extreme() {
        for code in [NEAREST_CODE, FARTHEST_CODE] {
            assert_eq!(code.bins * code.alphas, DEPTH_CODES);
            let bin = 2.0 / f64::from(code.bins);
            for i in 0..=1000 {
                let alpha = f64::from(i) / 1001.0;
                let exact = -(1.0 - alpha).ln();
                let level = code.level(0.3, exact);
                let error = (code.absorbance(level) - exact).abs();
                let step = 0.5 / f64::from(code.alphas - 1);
                let fraction = exact / (exact + 1.0) * MOST_LEVEL + step;
                let limit = if fraction < MOST_LEVEL {
                    fraction / (MOST_LEVEL - fraction) - exact + 1e-12
                } else {
                    ABSORBANCE_MAX
                };
                assert!(error <= limit, "{alpha}: {error} {limit}");
                assert!((code.zeta(level) - 0.3).abs() <= bin / 2.0 + 1e-12);
                // Farther wins, nearer in the mirrored level, whatever the opacities.
                assert!(code.level(0.3 + 2.0 * bin, 0.0) > level);
                assert!(code.mirrored(0.3 - 2.0 * bin, 0.0) > code.mirrored(0.3, exact));
                let mirrored = code.mirrored(-0.7, exact);
                assert_eq!(code.absorbance(mirrored), code.absorbance(level));
            }
            assert_eq!(code.level(1.0, ABSORBANCE_MAX), DEPTH_CODES - 1);
            assert_eq!(code.mirrored(-1.0, ABSORBANCE_MAX), DEPTH_CODES - 1);
            assert_eq!(code.absorbance(DEPTH_CODES - 1), ABSORBANCE_MAX);
        }
    }
}
