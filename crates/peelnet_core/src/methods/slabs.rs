//! `slabs`: known layers without ordered access. Depth is cut into three or four slabs where the pixel's layers are, and each slab has its own
//! sums, its own nearest and its own farthest fragment.
//!
//! What lies in other slabs is wholly in front of a fragment or wholly behind it, so that its absorbance is a plain sum. In the fragment's
//! own slab the nearest and the farthest layer are known, and up to eight layers of a pixel are. What lies between them is
//! bounded by its mean depth (Markov's inequality), and only where between the bounds the truth lies is guessed: see [`Interior`].
//!
//! Slabs are cut where the layers are: among the [`Quantiles`] of what is seen around the pixel. Other scales serve comparison ([`Extent`]).
//!
//! Two geometry passes: the sums and records, the colours. Records are levels of depth and opacity under MAX blending
//! ([`ExtremeCode`]). The shader is `learned/slabs.wgsl`, with the file of a [`Layout`], such as `slabs_small.wgsl`.

use super::{
    Point,
    anchored::composite_weighted,
    known::KnownFragment,
    point,
    quantiles::{BIN_LEVELS, Quantiles, TOP, bins_of, depth_of, ends_of},
};
use crate::{
    absorbance::DepthWarp,
    fragment::Fragment,
    statistics::{ExtremeCode, FARTHEST_CODE, SumPrecision, half_of_code},
};
use half::f16;
use serde::{Deserialize, Serialize};

/// Slabs of a pixel, at most.
pub const MAX_SLABS: usize = 8;

/// Bins of the frame's depth, at most.
pub const MAX_BINS: usize = 16;

/// A slab: where it ends, and what is kept of it beside its absorbance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// On the pixel's scale, 0 … 1. It begins where the slab before ends.
    pub end: f64,
    /// The mean depth of its absorbance.
    pub mean: bool,
    pub nearest: bool,
    pub farthest: bool,
}

/// The scale of depth that is cut into slabs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// A depth's place among quantiles, which are known without looking at the pixel.
    Among(Quantiles),
    /// From the pixel's nearest fragment to its farthest, in 8 bits for either end: a geometry pass more.
    Ends,
    /// The absorbances of so many bins of the frame's depth and the pixel's two ends, in 8 bits each ([`Scale::from_bins`]): a geometry pass more.
    Bins(usize),
}

/// What is kept of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// The slabs, nearest first; at most [`MAX_SLABS`], of which the last ends at 1.
    pub slabs: &'static [Kept],
    /// How nearest and farthest fragments are kept, by their place in the slab.
    pub records: ExtremeCode,
    pub extent: Extent,
    /// Whether the colours of known fragments have a sum of their own.
    pub apart: bool,
}

/// A slab that keeps its mean depth and its nearest fragment.
const fn until(end: f64, farthest: bool) -> Kept {
    Kept {
        end,
        mean: true,
        nearest: true,
        farthest,
    }
}

/// What the shaders and the exported texts hold of a pixel. All sums and records fit the targets of one pass of plain WebGPU, which is why
/// there are three: ten, twelve and sixteen values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    Small,
    Medium,
    Large,
}

impl Layout {
    pub const ALL: [Self; 3] = [Self::Small, Self::Medium, Self::Large];

    /// Its name in methods, recipes and shaders.
    pub const fn name(self) -> &'static str {
        ["small", "medium", "large"][self as usize]
    }

    pub const fn design(self) -> Design {
        [Design::SMALL, Design::MEDIUM, Design::LARGE][self as usize]
    }
}

impl Design {
    /// 28 bytes a pixel, colours included: three targets.
    pub const SMALL: Self = Self {
        slabs: &[until(0.49, true), until(0.77, false), until(1.0, false)],
        records: FARTHEST_CODE,
        extent: Extent::Among(Quantiles::EVEN),
        apart: false,
    };
    /// 32 bytes a pixel, three targets.
    pub const MEDIUM: Self = Self {
        slabs: &[until(0.4, true), until(0.75, true), until(1.0, true)],
        ..Self::SMALL
    };
    /// 40 bytes a pixel, four targets: as much as one pass of plain WebGPU writes.
    pub const LARGE: Self = Self {
        slabs: &[
            until(0.3, true),
            until(0.6, true),
            until(0.82, true),
            until(1.0, true),
        ],
        ..Self::SMALL
    };

    /// The layout that holds it, over whatever is cut into slabs. Other designs have no shaders.
    pub fn layout(&self) -> Option<Layout> {
        Layout::ALL.into_iter().find(|layout| {
            let has = layout.design();
            (has.slabs, has.records, has.apart) == (self.slabs, self.records, self.apart)
        })
    }

    /// Bytes a pixel of all targets, colours included.
    pub fn bytes(&self) -> u32 {
        let kept = |k: &Kept| [true, k.mean, k.nearest, k.farthest];
        let channels: u32 = self.slabs.iter().flat_map(kept).map(u32::from).sum();
        let scale = match self.extent {
            // Its share of the tiles' bytes.
            Extent::Among(_) => 1,
            Extent::Ends => 2,
            Extent::Bins(bins) => bins as u32 + 2,
        };
        scale + 2 * channels + 8 * (1 + u32::from(self.apart))
    }

    fn begin(&self, slab: usize) -> f64 {
        slab.checked_sub(1).map_or(0.0, |k| self.slabs[k].end)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    absorbance: f64,
    slab: usize,
    /// In the slab, −1 … 1.
    inside: f64,
    /// Its level as the slab's nearest, counted from the far end, and as its farthest.
    near: u32,
    far: u32,
    bin: u32,
}

/// A pixel's scale of depth, 0 … 1, that is cut into slabs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one a pixel, on the stack")]
pub enum Scale {
    Among(Quantiles),
    /// Linear from each of so many knots to the next: depths, 0 … 1 of the frame's, and where on the scale they lie.
    Knots([[f64; 2]; MAX_BINS + 1], usize),
}

impl Scale {
    /// Of the absorbances of bins of the frame's depth, nearest first, and the levels of the pixel's two ends. Between them each bin takes as much
    /// of the scale as its length times the root of what is seen of it; an empty one takes nothing. Where all are empty, the scale is the frame's.
    pub fn from_bins(absorbances: &[f64], [low, high]: [f64; 2]) -> Self {
        let bins = absorbances.len().min(MAX_BINS);
        let [from, to] = [low, high.max(low + 1.0)].map(|level| level / TOP);
        let (mut front, mut passed) = (0.0f64, 0.0);
        let mut knots = [[0.0; 2]; MAX_BINS + 1];
        let edge = |k: usize| (k as f64 / bins as f64).clamp(from, to);
        for (k, &b) in absorbances.iter().take(bins).enumerate() {
            knots[k] = [edge(k), passed];
            if b > 0.0 {
                let seen = (-front).exp() - (-front - b).exp();
                passed += seen.sqrt() * (edge(k + 1) - edge(k));
            }
            front += b;
        }
        if passed <= 0.0 {
            return Self::Among(Quantiles::EVEN);
        }
        knots[bins] = [to, passed];
        knots.iter_mut().for_each(|knot| knot[1] /= passed);
        Self::Knots(knots, bins)
    }

    /// Where on the scale a warped depth lies.
    pub fn place(&self, zeta: f64) -> f64 {
        let depth = depth_of(zeta);
        match self {
            Self::Among(quantiles) => quantiles.place(depth),
            Self::Knots(knots, last) => {
                let above = knots[..=*last].iter().position(|knot| knot[0] >= depth);
                let k = above.unwrap_or(*last).max(1);
                let ([z0, s0], [z1, s1]) = (knots[k - 1], knots[k]);
                // The pixel's ends may leave bins no length.
                let length = (z1 - z0).max(f64::MIN_POSITIVE);
                s0 + (s1 - s0) * ((depth - z0) / length).clamp(0.0, 1.0)
            }
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Slab {
    /// `A` and `B`: absorbance, and absorbance times place in the slab.
    absorbance: f64,
    first: f64,
    /// Levels of the nearest and of the farthest fragment; 0 where there is none.
    nearest: u32,
    farthest: u32,
}

/// What lies in a fragment's slab besides the fragment and the slab's known ends, and what the fragment can know of it. Depths are 0 at
/// the nearer and 1 at the farther of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Absorbance `r` of it.
    pub absorbance: f64,
    pub place: f64,
    /// Mean depth of the absorbance; a half where it is not kept.
    pub mean: f64,
    /// The least and the most of the absorbance that can lie in front of the fragment, as a share of it.
    pub bounds: [f64; 2],
    /// Half of what the two are apart, in slabs.
    pub extent: f64,
    pub own: f64,
    /// Absorbance of the ends that lies in front: the nearer end's, and half of an end's in the fragment's own bin.
    pub nearest: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slabs {
    design: Design,
    scale: Scale,
    slabs: [Slab; MAX_SLABS],
}

impl Slabs {
    pub fn gather(fragments: &[Point], design: Design, precision: SumPrecision) -> Self {
        let mut all = Self {
            design,
            scale: match design.extent {
                Extent::Bins(bins) => {
                    let levels = bins_of(fragments, bins).into_iter();
                    let absorbances: Vec<f64> = levels.map(|l| l / BIN_LEVELS).collect();
                    Scale::from_bins(&absorbances, ends_of(fragments.iter().map(|f| f.1)))
                }
                Extent::Ends => {
                    Scale::Among(Quantiles::between(ends_of(fragments.iter().map(|f| f.1))))
                }
                Extent::Among(quantiles) => Scale::Among(quantiles),
            },
            slabs: Default::default(),
        };
        for &(b, zeta, counts) in fragments {
            let place = all.place(b, zeta);
            let slab = &mut all.slabs[place.slab];
            slab.absorbance = precision.add(slab.absorbance, b);
            slab.first = precision.add(slab.first, b * place.inside);
            if counts {
                slab.nearest = slab.nearest.max(place.near);
                slab.farthest = slab.farthest.max(place.far);
            }
        }
        all
    }

    /// What targets hold of each slab: its absorbance, absorbance times depth in the slab, and the halves that stand for its nearest and its
    /// farthest fragment. Where a design keeps less, so do its targets.
    pub fn stored(&self) -> impl Iterator<Item = [f64; 4]> + '_ {
        let half = |level| f64::from(f16::from_bits(half_of_code(level)));
        let slabs = self.slabs.iter().take(self.design.slabs.len());
        slabs.map(move |s| [s.absorbance, s.first, half(s.nearest), half(s.farthest)])
    }

    fn place(&self, absorbance: f64, zeta: f64) -> Place {
        let (t, records) = (self.scale.place(zeta), &self.design.records);
        let inner = self.design.slabs.iter().take(self.design.slabs.len() - 1);
        let slab = inner.filter(|kept| t >= kept.end).count();
        let [begin, end] = [self.design.begin(slab), self.design.slabs[slab].end];
        let inside = 2.0 * (t - begin) / (end - begin) - 1.0;
        let far = records.level(inside, absorbance);
        Place {
            absorbance,
            slab,
            inside,
            near: records.mirrored(inside, absorbance),
            far,
            bin: far / records.alphas,
        }
    }

    pub fn known(&self, absorbance: f64, zeta: f64, counts: bool) -> KnownFragment<Interior> {
        let place = self.place(absorbance, zeta);
        let slab = &self.slabs[place.slab];
        let before: f64 = self.slabs[..place.slab].iter().map(|s| s.absorbance).sum();
        let others = (slab.absorbance - absorbance).max(0.0);
        let kept = &self.design.slabs[place.slab];
        let records = self.design.records;
        if counts && kept.nearest && records.is_kept(place.near, slab.nearest) {
            return KnownFragment::known(before);
        }
        if counts && kept.farthest && records.is_kept(place.far, slab.farthest) {
            return KnownFragment::known(before + others);
        }
        let between = self.between(&place, slab, others);
        KnownFragment {
            front: before + between.nearest,
            absorbance: between.absorbance,
            bounds: between.bounds,
            unknown: Some(between),
        }
    }

    fn between(&self, place: &Place, slab: &Slab, others: f64) -> Interior {
        let (kept, records) = (&self.design.slabs[place.slab], &self.design.records);
        let noise = (slab.absorbance / 1024.0).max(1e-6);
        let alphas = records.alphas;
        // Of the nearest: counted from the far end.
        let near_bin = records.bins - 1 - slab.nearest / alphas;
        let near_level = near_bin * alphas + slab.nearest % alphas;
        let (mut nearest, mut begin) = (0.0, -1.0);
        if kept.nearest {
            nearest = records.absorbance(slab.nearest);
            let step = 0.6 / f64::from(alphas - 1);
            // All others, as far as the level's rounding and the sum's can tell.
            if nearest > others - (step * (1.0 + nearest).powi(2) + noise) {
                nearest = others;
            }
            if near_bin > place.bin {
                nearest = 0.0;
            }
            begin = records.zeta(near_level);
        }
        let (mut farthest, mut end) = (0.0, 1.0);
        if kept.farthest && !(kept.nearest && slab.farthest == near_level) {
            if slab.farthest / alphas >= place.bin {
                farthest = records.absorbance(slab.farthest);
            }
            end = records.zeta(slab.farthest);
        }
        let u = place.inside;
        let rest = slab.absorbance - place.absorbance - nearest - farthest;
        let first = slab.first - place.absorbance * u - nearest * begin - farthest * end;
        // In one bin nobody knows which of two is in front: half of the other is.
        let mut in_front = nearest;
        if kept.nearest && near_bin == place.bin {
            in_front *= 0.5;
        }
        if kept.farthest && slab.farthest / alphas == place.bin {
            in_front += 0.5 * farthest;
        }
        if begin > u {
            begin = -1.0;
        }
        if end < u {
            end = 1.0;
        }
        let extent = (end - begin).max(2.0 / f64::from(records.bins));
        let x = ((u - begin) / extent).clamp(0.0, 1.0);
        let (mut mean, mut bounds) = (0.5, [0.0, 1.0]);
        if kept.mean {
            let depth = (first / rest.max(noise)).clamp(begin, end);
            mean = ((depth - begin) / extent).clamp(0.0, 1.0);
            bounds = if x < mean {
                [0.0, (1.0 - mean) / (1.0 - x).max(1e-6)]
            } else {
                [(x - mean) / x.max(1e-6), 1.0]
            };
        }
        Interior {
            absorbance: rest.max(0.0),
            place: x,
            mean,
            bounds,
            extent: extent / 2.0,
            own: place.absorbance,
            nearest: in_front,
        }
    }
}

/// Fragments that are given as (linear depth, α), by their depths without gaps.
pub fn points(fragments: &[(f32, f32)], warp: &DepthWarp) -> Vec<Point> {
    let to_point = |&(depth, alpha): &(f32, f32)| point(alpha, warp.cut(depth.into()));
    fragments.iter().map(to_point).collect()
}

/// What is known of each of a pixel's fragments, given as (linear depth, α), in the order given.
pub fn known_fragments(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    design: Design,
    precision: SumPrecision,
) -> Vec<KnownFragment<Interior>> {
    let points = points(fragments, warp);
    let slabs = Slabs::gather(&points, design, precision);
    let known = |&(b, zeta, counts): &Point| slabs.known(b, zeta, counts);
    points.iter().map(known).collect()
}

/// The guess without a network: the middle of the bounds.
pub const fn middle(_: &Interior) -> f64 {
    0.5
}

/// Composites a pixel; `guess` says where between its bounds the share lies that is in front of a fragment.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    design: Design,
    guess: impl Fn(&Interior) -> f64,
) -> [f32; 3] {
    let zeta = |depth: f32| warp.cut(depth.into());
    let exact = SumPrecision::Exact;
    composite_on(fragments, background, zeta, design, exact, guess)
}

/// As [`composite`], with linear depths put on a scale of one's own, −1 … 1, and the sums of the statistics kept in a precision.
pub fn composite_on(
    fragments: &[Fragment],
    background: [f32; 3],
    zeta: impl Fn(f32) -> f64,
    design: Design,
    precision: SumPrecision,
    guess: impl Fn(&Interior) -> f64,
) -> [f32; 3] {
    let all = fragments.iter();
    let points: Vec<Point> = all.map(|f| point(f.alpha, zeta(f.depth))).collect();
    let slabs = Slabs::gather(&points, design, precision);
    let weights = points.iter().map(|&(b, zeta, counts)| {
        let known = slabs.known(b, zeta, counts);
        (known.weight(&guess), known.unknown.is_none())
    });
    composite_weighted(fragments, background, design.apart, weights)
}

#[cfg(test)]
mod tests;
