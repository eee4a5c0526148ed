//! `one`: a pixel in one geometry pass. Of its nearest fragment the colour is kept, of all others sums by where they lie among what is seen
//! around the pixel.
//!
//! [`Quantiles`] of depth say where that is. A fragment is shared between the sums by bumps over its place among them ([`Design::shares`]):
//! `Σ b φ_k c` and `Σ b φ_k` of absorbance `b`. The shares of a fragment sum to 1, so that the pixel's coverage is exact.
//!
//! The resolve takes the nearest fragment out of the sums and composites it first. How much of each sum is seen behind it is a formula of the
//! sums, `e^−A` ([`Ahead::absorbance`]), or twice a network's answer times `A`.
//!
//! Four or eight half-float targets: red, green and blue add, alpha keeps the most. In the first four alphas lies the nearest fragment: a level
//! of depth, counted from the far end, in the high part, and a value in the low part, so that all four are of the same fragment.
//! The shaders are `learned/one.wgsl` and the file of a design.

use super::{
    Point,
    quantiles::{Quantiles, Seen, TILE_BINS, depth_of},
    slabs::points,
};
use crate::{
    absorbance::DepthWarp,
    fragment::{self, Fragment},
    statistics::SumPrecision,
};

/// Levels of depth, and of a value in each, of the nearest fragment.
pub const DEPTHS: u32 = 480;
pub const VALUES: u32 = 128;

/// `b / (1 + b)` of the most absorbance, as of colours without bound.
const MOST: f64 = 16.0 / 17.0;

/// What is known of a pixel besides its fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    pub quantiles: Quantiles,
    /// 0 … 1, for the whole frame alike: moves the steps of the nearest fragment's values, so that they are not seen as bands.
    pub noise: f64,
}

impl Around {
    /// Of a pixel at a place of the frame: neighbours' noises lie far apart (Roberts 2018, the sequence R2).
    pub fn new(quantiles: Quantiles, [x, y]: [u32; 2]) -> Self {
        let steps = x
            .wrapping_mul(12_664_746)
            .wrapping_add(y.wrapping_mul(9_560_334));
        Self {
            quantiles,
            noise: f64::from(steps & 0xff_ffff) / f64::from(1 << 24),
        }
    }

    pub const NONE: Self = Self {
        quantiles: Quantiles::EVEN,
        noise: 0.5,
    };
}

/// The sums of a pixel: the middles of their bumps among the quantiles, and the bumps' widths. At most [`MAX_SUMS`], a multiple of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    pub middles: &'static [f64],
    pub widths: &'static [f64],
    /// Where each sum ends if what is evenly spread over all places was put into them one after the other: the mean of all shares so far.
    pub ends: &'static [f64],
}

pub const MAX_SUMS: usize = 6;

impl Design {
    /// Four targets, 32 bytes a pixel. The bumps were learned with the resolve, from the training scenes.
    pub const ONE: Self = Self {
        middles: &[0.224, 0.485, 1.028],
        widths: &[0.158, 0.168, 0.191],
        ends: &[0.345, 0.738, 1.0],
    };
    /// Eight targets, 64 bytes.
    pub const WIDE: Self = Self {
        middles: &[0.199, 0.315, 0.495, 0.635, 0.784, 0.948],
        widths: &[0.069, 0.074, 0.072, 0.058, 0.068, 0.093],
        ends: &[0.25, 0.408, 0.576, 0.702, 0.848, 1.0],
    };

    /// How a fragment at a place among the quantiles is shared between the sums.
    pub fn shares(&self, place: f64) -> [f64; MAX_SUMS] {
        let mut all = [0.0; MAX_SUMS];
        let bumps = self.middles.iter().zip(self.widths);
        for (share, (middle, width)) in all.iter_mut().zip(bumps) {
            *share = (-0.5 * ((place - middle) / width).powi(2)).exp();
        }
        let sum: f64 = all.iter().sum();
        all.map(|share| share / sum)
    }
}

/// A value without bound in 0 … 1, in even steps of a root: faint ones get more of them.
fn to_unit(value: f64) -> f64 {
    (value.max(0.0) / (1.0 + value.max(0.0)) / MOST)
        .min(1.0)
        .sqrt()
}

fn from_unit(unit: f64) -> f64 {
    let share = unit * unit * MOST;
    share / (1.0 - share)
}

/// The step of the nearest fragment's values at one of them.
pub fn step(value: f64) -> f64 {
    2.0 * to_unit(value) * MOST * (1.0 + value).powi(2) / f64::from(VALUES - 1)
}

/// The nearest fragment, as its targets hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    pub absorbance: f64,
    pub color: [f64; 3],
    /// Among the quantiles.
    pub place: f64,
}

/// What targets hold of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    design: Design,
    around: Around,
    /// `Σ b φ_k c` and `Σ b φ_k`.
    sums: [[f64; 4]; MAX_SUMS],
    /// Levels of the nearest fragment's red, green, blue and absorbance; 0 where there is none.
    levels: [u32; 4],
}

/// One of a pixel's sums without its nearest fragment, and what is known of how much lies in front of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// By the formula: all of the sums before it, and of its own what an even mixture has in front, `ln(B / (1 − e^−B))`.
    pub absorbance: f64,
    /// Absorbance of all sums.
    pub total: f64,
    /// Shares of the total: of the sums before, the sum, and those before and behind it.
    pub before: f64,
    pub own: f64,
    pub previous: f64,
    pub next: f64,
    /// Opacity of the nearest fragment, and its place.
    pub alpha: f64,
    pub place: f64,
    /// 0 for the first, 1 for the last sum.
    pub number: f64,
}

impl Ahead {
    /// How much of the sum is seen, from 0 … 1: a half is the formula.
    pub fn seen(&self, answer: f64) -> f64 {
        (-2.0 * self.absorbance * answer).exp()
    }
}

/// A pixel without its nearest fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    pub nearest: Nearest,
    /// Opacity of the nearest, no more than the pixel's coverage.
    pub alpha: f64,
    /// Coverage that is left for the sums.
    pub left: f64,
    pub coverage: f64,
    /// `Σ b φ_k c` and `Σ b φ_k` without it, and what is known of each.
    pub sums: [[f64; 4]; MAX_SUMS],
    pub ahead: [Ahead; MAX_SUMS],
}

impl Kept {
    /// Of fragments in any order, with their colours.
    pub fn gather(
        fragments: &[Point],
        colors: impl IntoIterator<Item = [f32; 3]>,
        design: Design,
        around: Around,
        precision: SumPrecision,
    ) -> Self {
        let mut kept = Self {
            design,
            around,
            sums: Default::default(),
            levels: [0; 4],
        };
        for (&(b, zeta, _), color) in fragments.iter().zip(colors) {
            let depth = depth_of(zeta);
            let shares = design.shares(around.quantiles.place(depth));
            let [red, green, blue] = color.map(f64::from);
            for (sum, share) in kept.sums.iter_mut().zip(shares) {
                for (sum, c) in sum.iter_mut().zip([red, green, blue, 1.0]) {
                    *sum = precision.add(*sum, b * share * c);
                }
            }
            let level = kept.depth_level(depth);
            for (most, value) in kept.levels.iter_mut().zip([red, green, blue, b]) {
                let top = f64::from(VALUES - 1);
                let step = (to_unit(value) * top + around.noise).floor().min(top);
                *most = (*most).max(level * VALUES + step as u32);
            }
        }
        kept
    }

    /// Counted from the far end.
    fn depth_level(&self, depth: f64) -> u32 {
        let on_scale = 0.5 * (depth + self.around.quantiles.place(depth));
        let level = (on_scale * f64::from(DEPTHS)).floor();
        DEPTHS - 1 - level.clamp(0.0, f64::from(DEPTHS - 1)) as u32
    }

    fn nearest(&self) -> Nearest {
        let top = f64::from(VALUES - 1);
        let value = |level: u32| {
            let step = f64::from(level % VALUES) + 0.5 - self.around.noise;
            from_unit((step / top).clamp(0.0, 1.0))
        };
        let bin = DEPTHS - 1 - self.levels[3] / VALUES;
        let on_scale = (f64::from(bin) + 0.5) / f64::from(DEPTHS);
        let [red, green, blue, absorbance] = self.levels.map(value);
        Nearest {
            absorbance,
            color: [red, green, blue],
            place: self.around.quantiles.halfway().place(on_scale),
        }
    }

    /// What is seen behind the nearest fragment of a finished pixel, by bins of depth, from which the next frame's quantiles can be made: by the
    /// formula, each sum taken as even between where it ends and where the one before does. Repeated on a still image, this is the
    /// deconvolution of Richardson (1972) and Lucy (1974) with bumps that follow what they find.
    pub fn last_seen(&self) -> Seen {
        let rest = self.rest();
        let sums = rest.sums.iter().zip(&rest.ahead);
        let parts = sums.map(|(sum, ahead)| sum[3] * ahead.seen(formula(ahead)));
        let parts: Vec<f64> = parts.take(self.design.ends.len()).collect();
        let scale = rest.left / parts.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let until = |depth: f64| {
            let (place, mut begin, mut all) = (self.around.quantiles.place(depth), 0.0, 0.0);
            for (part, &end) in parts.iter().zip(self.design.ends) {
                all += part * ((place - begin) / (end - begin)).clamp(0.0, 1.0);
                begin = end;
            }
            all * scale
        };
        let mut before = 0.0;
        std::array::from_fn(|k| {
            let all = until((k + 1) as f64 / TILE_BINS as f64);
            (all - std::mem::replace(&mut before, all)) as f32
        })
    }

    /// The nearest fragment, and the sums without it.
    pub fn rest(&self) -> Rest {
        let mut nearest = self.nearest();
        let all: f64 = self.sums.iter().map(|sum| sum[3]).sum();
        // All there is, as far as roundings can tell: its colour is the mean.
        if all - nearest.absorbance <= step(nearest.absorbance) + all / 1024.0 {
            let mean = |c: usize| self.sums.iter().map(|sum| sum[c]).sum::<f64>() / all.max(1e-6);
            nearest.absorbance = all;
            nearest.color = [0, 1, 2].map(mean);
        }
        let coverage = -(-all).exp_m1();
        let shares = self.design.shares(nearest.place);
        let mut sums = self.sums;
        for (sum, share) in sums.iter_mut().zip(shares) {
            let taken = nearest.absorbance * share;
            let [red, green, blue] = nearest.color;
            for (sum, c) in sum.iter_mut().zip([red, green, blue, 1.0]) {
                *sum = (*sum - taken * c).max(0.0);
            }
        }
        let total: f64 = sums.iter().map(|sum| sum[3]).sum();
        let alpha = (-(-nearest.absorbance).exp_m1()).min(coverage);
        let count = self.design.middles.len();
        let (mut ahead, mut before) = ([Ahead::default(); MAX_SUMS], 0.0);
        let of_total = |b: f64| b / total.max(1e-6);
        for k in 0..count {
            let own = sums[k][3];
            let neighbour = |k: Option<&[f64; 4]>| of_total(k.map_or(0.0, |sum| sum[3]));
            ahead[k] = Ahead {
                absorbance: before + inside(own),
                total,
                before: of_total(before),
                own: of_total(own),
                previous: neighbour(k.checked_sub(1).map(|k| &sums[k])),
                next: neighbour(sums[..count].get(k + 1)),
                alpha,
                place: nearest.place,
                number: k as f64 / (count - 1) as f64,
            };
            before += own;
        }
        Rest {
            nearest,
            alpha,
            left: coverage - alpha,
            coverage,
            sums,
            ahead,
        }
    }
}

/// What an even mixture of some absorbance has in front of itself: `ln(b / (1 − e^−b))`.
fn inside(b: f64) -> f64 {
    if b < 0.02 {
        return b * (0.5 - b / 24.0);
    }
    (b / -(-b).exp_m1()).ln()
}

impl Rest {
    /// The colour of a pixel over black; `answer` says how much of each sum is seen ([`Ahead::seen`]).
    pub fn color(&self, answer: impl Fn(&Ahead) -> f64) -> [f64; 3] {
        let mut seen = [0.0; 4];
        for (sum, ahead) in self.sums.iter().zip(&self.ahead) {
            if sum[3] > 0.0 {
                let part = ahead.seen(answer(ahead));
                seen.iter_mut().zip(sum).for_each(|(s, x)| *s += part * x);
            }
        }
        std::array::from_fn(|c| {
            let rest = if seen[3] > 0.0 {
                seen[c] / seen[3]
            } else {
                self.nearest.color[c]
            };
            self.alpha * self.nearest.color[c] + self.left * rest
        })
    }
}

/// The transmittance in front of each fragment that a pixel's colour stands for, given as (linear depth, α): of the nearest 1, of others what
/// all sums together show of it.
pub fn transmittances(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    design: Design,
    around: Around,
    precision: SumPrecision,
    answer: impl Fn(&Ahead) -> f64,
) -> Vec<f64> {
    let points = points(fragments, warp);
    let grey = std::iter::repeat([0.0; 3]);
    let rest = Kept::gather(&points, grey, design, around, precision).rest();
    let ahead = rest.ahead.iter();
    let parts: Vec<f64> = ahead.map(|ahead| ahead.seen(answer(ahead))).collect();
    let sums = rest.sums.iter().zip(&parts);
    let all: f64 = sums.map(|(sum, part)| sum[3] * part).sum();
    let nearest = points.iter().map(|f| f.1).fold(f64::MAX, f64::min);
    let of = |&(b, zeta, _): &Point| {
        if zeta == nearest || all <= 0.0 {
            return 1.0;
        }
        let shares = design.shares(around.quantiles.place(depth_of(zeta)));
        let seen = shares.iter().zip(&parts).map(|(share, part)| share * part);
        // `b / α` of it is 1 where it is faint.
        let weight = b / -(-b).exp_m1().min(-f64::MIN_POSITIVE);
        (rest.left * seen.sum::<f64>() / all * weight).clamp(0.0, 1.0)
    };
    points.iter().map(of).collect()
}

/// The answer without a network.
pub const fn formula(_: &Ahead) -> f64 {
    0.5
}

/// Composites a pixel.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    design: Design,
    around: Around,
    answer: impl Fn(&Ahead) -> f64,
) -> [f32; 3] {
    let points = points(&fragment::points(fragments), warp);
    let colors = fragments.iter().map(|f| f.color);
    let rest = Kept::gather(&points, colors, design, around, SumPrecision::Exact).rest();
    let color = rest.color(answer);
    std::array::from_fn(|c| (color[c] + (1.0 - rest.coverage) * f64::from(background[c])) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fragment::worked_example, methods::over};

    const DESIGNS: [Design; 2] = [Design::ONE, Design::WIDE];

    fn warp() -> DepthWarp {
        DepthWarp::new(1.0, 8.0)
    }

    /// A fragment of an absorbance at a depth, 0 … 1.
    fn at(absorbance: f64, depth: f64) -> Point {
        (absorbance, 2.0 * depth - 1.0, true)
    }

    fn of(fragments: &[Fragment], design: Design) -> [f32; 3] {
        composite(fragments, [0.2; 3], &warp(), design, Around::NONE, formula)
    }

    /// Whatever the noise, the mean is the fragment's own colour.
    #[test]
    fn one_layer_is_exact() {
        let (background, warp) = ([0.2, 0.7, 0.4], warp());
        for (alpha, color) in [
            (0.004, [0.9, 0.1, 0.0]),
            (0.5, [3.0, 0.0, 0.2]),
            (1.0, [1.0; 3]),
        ] {
            let f = [Fragment::new(3.0, alpha, color)];
            let want = over::composite(&f, background);
            for noise in [0.0, 0.3, 0.99] {
                let around = Around {
                    noise,
                    ..Around::NONE
                };
                let found = composite(&f, background, &warp, Design::ONE, around, formula);
                let apart = found.iter().zip(want).map(|(a, b)| (a - b).abs());
                // Opacity 1 counts as an absorbance of 16; the rest are roundings of 32 bits.
                assert!(
                    apart.fold(0.0, f32::max) < 1e-6,
                    "{alpha} {noise}: {found:?}"
                );
            }
        }
    }

    /// Two layers far apart: the nearest one's colour is off by a step of its record at most, and so is what it leaves to the other.
    #[test]
    fn two_layers_are_exact_but_for_a_step() {
        let f = [
            Fragment::new(1.5, 0.4, [0.9, 0.2, 0.1]),
            Fragment::new(6.0, 0.7, [0.1, 0.3, 0.8]),
        ];
        let want = over::composite(&f, [0.2; 3]);
        for design in DESIGNS {
            for (found, want) in of(&f, design).into_iter().zip(want) {
                // Half a step at 0.9 is 0.019 of colour; no more of it is seen than the opacity.
                assert!(
                    (found - want).abs() < 0.4 * 0.019 + 1e-4,
                    "{found} for {want}"
                );
            }
        }
    }

    #[test]
    fn places_rise_from_0_to_1_and_shares_add_up() {
        for quantiles in [Quantiles::EVEN, Quantiles([0.0, 0.2, 0.2, 0.9])] {
            let places = (0..=100).map(|k| quantiles.place(f64::from(k) / 100.0));
            let places: Vec<f64> = places.collect();
            assert!(
                places[0] == 0.0 && (places[100] - 1.0).abs() < 1e-12,
                "{quantiles:?}"
            );
            assert!(places.windows(2).all(|w| w[1] >= w[0]), "{quantiles:?}");
            for design in DESIGNS {
                for &place in &places {
                    let sum: f64 = design.shares(place).iter().sum();
                    assert!((sum - 1.0).abs() < 1e-12);
                }
            }
        }
        assert!((Quantiles::EVEN.place(0.5) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn sums_end_where_their_shares_of_even_places_do() {
        const PLACES: u32 = 10_000;
        for design in DESIGNS {
            let mut all = [0.0; MAX_SUMS];
            for k in 0..PLACES {
                let shares = design.shares((f64::from(k) + 0.5) / f64::from(PLACES));
                all.iter_mut()
                    .zip(shares)
                    .for_each(|(sum, share)| *sum += share / f64::from(PLACES));
            }
            let mut end = 0.0;
            for (found, sum) in design.ends.iter().zip(all) {
                end += sum;
                // They are given to three digits, each from the one before.
                assert!(
                    (found - end).abs() < 0.5e-3 * design.ends.len() as f64,
                    "{found} for {end}"
                );
            }
        }
    }

    /// Faint fragments at even places among any quantiles: what is seen of them leads to the same quantiles again. Behind other quantiles it moves
    /// those towards the ones that the fragments have.
    #[test]
    fn what_was_seen_last_keeps_quantiles_that_are_right_and_mends_others() {
        let right = Quantiles([0.25, 0.4375, 0.5625, 0.625]);
        let even = (0..400).map(|k| {
            let place = (f64::from(k) + 0.5) / 400.0;
            // The depth of a place, by bisection.
            let halves = (1..40).fold(0.0, |depth, k| {
                let next = depth + 0.5f64.powi(k);
                if right.place(next) <= place {
                    next
                } else {
                    depth
                }
            });
            at(1e-4, halves)
        });
        // The nearest fragment is none of them, and nothing is seen of it.
        let fragments: Vec<Point> = even.chain([at(1e-4, 0.0)]).collect();
        let next = |quantiles, design| {
            let around = Around {
                quantiles,
                noise: 0.5,
            };
            let grey = std::iter::repeat([0.5; 3]);
            let kept = Kept::gather(&fragments, grey, design, around, SumPrecision::Exact);
            Quantiles::of_seen(kept.last_seen().map(f64::from))
        };
        let apart = |Quantiles(a): Quantiles| {
            let differences = a.iter().zip(right.0).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f64::max)
        };
        const BIN: f64 = 1.0 / TILE_BINS as f64;
        // Quantiles at the ends of bins, inside of which everything is even: what is left are steps of 1/255 and of the fragments.
        const STEPS: f64 = 1.0 / 255.0 + 1.0 / 400.0;
        for design in DESIGNS {
            assert!(
                apart(next(right, design)) < STEPS,
                "{:?}",
                next(right, design)
            );
            let mut found = Quantiles::EVEN;
            for _ in 0..12 {
                found = next(found, design);
            }
            // The outer ones lie inside of the first and the last sum, which say little of where.
            let inner = [1, 2].map(|k| (found.0[k] - right.0[k]).abs());
            assert!(inner[0].max(inner[1]) < BIN / 2.0, "{design:?}: {found:?}");
            assert!(
                apart(found) < apart(Quantiles::EVEN) / 2.0,
                "{design:?}: {found:?}"
            );
        }
    }

    /// What is seen of all fragments is the pixel's coverage.
    #[test]
    fn transmittances_add_up() {
        let fragments = worked_example();
        let places = fragments.map(|f| (f.depth, f.alpha));
        for design in DESIGNS {
            let t = transmittances(
                &places,
                &warp(),
                design,
                Around::NONE,
                SumPrecision::Exact,
                formula,
            );
            assert_eq!(t[0], 1.0);
            let seen = fragments
                .iter()
                .zip(&t)
                .map(|(f, t)| f64::from(f.alpha) * t);
            let behind = fragments.iter().map(|f| 1.0 - f64::from(f.alpha));
            let coverage = 1.0 - behind.product::<f64>();
            // The record's opacity is off by half a step.
            assert!((seen.sum::<f64>() - coverage).abs() < 0.03, "{t:?}");
        }
    }
}
