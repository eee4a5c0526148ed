//! `slabs`: known layers without ordered access. The pixel's own range of depth is cut into four slabs, and each slab has its own
//! sums, its own nearest and its own farthest fragment.
//!
//! What lies in other slabs is wholly in front of a fragment or wholly behind it, so that its absorbance is a plain sum. In the fragment's
//! own slab the nearest and the farthest layer are known, and up to eight layers of a pixel are. What lies between them is
//! bounded by its mean depth (Markov's inequality), and only where between the bounds the truth lies is guessed: see [`Between`].
//!
//! Three geometry passes: the range, the sums and records, the colours. Records are levels of depth and opacity under MAX blending
//! ([`SLAB_END`]). The shader twin is `methods/slabs/`.

use super::anchored::{FAINT, resolve, resolve_separate_ends};
use crate::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    statistics::{EndCode, FAR_END, SumPrecision},
};

/// Slabs of a pixel.
pub const SLABS: usize = 4;

/// Where slabs begin and end in the pixel's range. The outer ones are narrower: a pixel's own ends lie in them.
pub const BORDERS: [f64; SLABS + 1] = [0.0, 0.2, 0.5, 0.8, 1.0];

/// Levels of the range of depths, less one: 8 bits for either end.
pub const RANGE_TOP: f64 = 255.0;

/// How a slab's nearest and farthest fragment are kept, by their place in the slab.
pub const SLAB_END: EndCode = FAR_END;

/// What is kept of the slabs, from the nearest one on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Design {
    /// How many keep the mean depth of their absorbance.
    pub means: usize,
    /// How many keep their farthest fragment.
    pub farthest: usize,
    /// Whether the colours of known fragments have a sum of their own.
    pub apart: bool,
}

impl Design {
    /// 32 bytes a pixel, colours included.
    pub const SMALL: Self = Self {
        means: 2,
        farthest: 1,
        apart: false,
    };
    /// 40 bytes a pixel.
    pub const MEDIUM: Self = Self {
        means: 4,
        farthest: 3,
        apart: false,
    };
    /// 48 bytes a pixel.
    pub const LARGE: Self = Self {
        apart: true,
        ..Self::MEDIUM
    };
}

/// Where in its pixel a fragment lies.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    absorbance: f64,
    slab: usize,
    /// In the slab, −1 … 1.
    inside: f64,
}

impl Place {
    fn near(&self) -> u32 {
        SLAB_END.mirrored(self.inside, self.absorbance)
    }

    fn far(&self) -> u32 {
        SLAB_END.level(self.inside, self.absorbance)
    }

    fn bin(&self) -> u32 {
        self.far() / SLAB_END.alphas
    }
}

/// The range of a pixel's fragments in levels of depth: rounded away from each other, and never empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Of a pixel whose fragments have these warped depths.
    pub fn of(zetas: impl IntoIterator<Item = f64>) -> Self {
        let none = (RANGE_TOP, 0.0f64);
        let (low, high) = zetas.into_iter().fold(none, |(low, high), zeta| {
            let level = level(zeta);
            (low.min(level.floor()), high.max(level.ceil()))
        });
        Self { low, high }
    }

    /// Where in the range a warped depth lies, 0 … 1.
    pub fn place(&self, zeta: f64) -> f64 {
        let extent = (self.high - self.low).max(1.0);
        ((level(zeta) - self.low) / extent).clamp(0.0, 1.0)
    }
}

fn level(zeta: f64) -> f64 {
    RANGE_TOP * (zeta * 0.5 + 0.5)
}

/// What is kept of one slab.
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
pub struct Between {
    /// Absorbance `r` of it.
    pub absorbance: f64,
    /// Depth of the fragment.
    pub place: f64,
    /// Mean depth of the absorbance; a half where it is not kept.
    pub mean: f64,
    /// The least and the most of the absorbance that can lie in front of the fragment, as a share of it.
    pub bounds: [f64; 2],
    /// Half of what the two are apart, in slabs.
    pub extent: f64,
    /// Absorbance of the fragment.
    pub own: f64,
    /// Absorbance of the nearer end; 0 where it is not known.
    pub nearest: f64,
}

/// What the last pass knows of a fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Absorbance that is known to lie in front.
    pub front: f64,
    /// What else may; nothing in front of a slab's nearest and behind its farthest fragment.
    pub between: Option<Between>,
}

impl Seen {
    /// The weight, given where between the bounds the share lies that is in front, 0 … 1.
    pub fn weight(&self, guess: impl FnOnce(&Between) -> f64) -> f64 {
        let between = self.between.map_or(0.0, |between| {
            let [low, high] = between.bounds;
            between.absorbance * (low + (high - low) * guess(&between))
        });
        (-(self.front + between)).exp()
    }
}

/// The slabs of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slabs {
    design: Design,
    range: Range,
    slabs: [Slab; SLABS],
}

impl Slabs {
    /// Of a pixel's fragments, given as (absorbance, warped depth, whether it is visible enough to be a slab's nearest or farthest).
    pub fn of(fragments: &[(f64, f64, bool)], design: Design, precision: SumPrecision) -> Self {
        let mut all = Self {
            design,
            range: Range::of(fragments.iter().map(|f| f.1)),
            slabs: Default::default(),
        };
        for &(b, zeta, counts) in fragments {
            let place = all.place(b, zeta);
            let slab = &mut all.slabs[place.slab];
            slab.absorbance = precision.add(slab.absorbance, b);
            slab.first = precision.add(slab.first, b * place.inside);
            if counts {
                slab.nearest = slab.nearest.max(place.near());
                slab.farthest = slab.farthest.max(place.far());
            }
        }
        all
    }

    fn place(&self, absorbance: f64, zeta: f64) -> Place {
        let t = self.range.place(zeta);
        let slab = BORDERS[1..SLABS].iter().filter(|&&b| t >= b).count();
        let [begin, end] = [BORDERS[slab], BORDERS[slab + 1]];
        Place {
            absorbance,
            slab,
            inside: 2.0 * (t - begin) / (end - begin) - 1.0,
        }
    }

    /// What is known of one of its fragments.
    pub fn seen(&self, absorbance: f64, zeta: f64, counts: bool) -> Seen {
        let place = self.place(absorbance, zeta);
        let slab = &self.slabs[place.slab];
        let before: f64 = self.slabs[..place.slab].iter().map(|s| s.absorbance).sum();
        let others = (slab.absorbance - absorbance).max(0.0);
        let keeps_far = place.slab < self.design.farthest;
        let known = if counts && place.near() == slab.nearest {
            Some(0.0)
        } else if counts && keeps_far && place.far() == slab.farthest {
            Some(others)
        } else {
            None
        };
        if let Some(inside) = known {
            return Seen {
                front: before + inside,
                between: None,
            };
        }
        let between = self.between(&place, slab, others);
        Seen {
            front: before + between.nearest,
            between: Some(between),
        }
    }

    fn between(&self, place: &Place, slab: &Slab, others: f64) -> Between {
        let noise = (slab.absorbance / 1024.0).max(1e-6);
        let alphas = SLAB_END.alphas;
        // Of the nearest: counted from the far end.
        let near_bin = SLAB_END.bins - 1 - slab.nearest / alphas;
        let near_level = near_bin * alphas + slab.nearest % alphas;
        let mut nearest = SLAB_END.absorbance(slab.nearest);
        let step = 0.6 / f64::from(alphas - 1);
        // All others, as far as the level's rounding and the sum's can tell.
        if nearest > others - (step * (1.0 + nearest).powi(2) + noise) {
            nearest = others;
        }
        if near_bin > place.bin() {
            nearest = 0.0;
        }
        let (mut farthest, mut end) = (0.0, 1.0);
        if place.slab < self.design.farthest && slab.farthest != near_level {
            if slab.farthest / alphas >= place.bin() {
                farthest = SLAB_END.absorbance(slab.farthest);
            }
            end = SLAB_END.zeta(slab.farthest);
        }
        let mut begin = SLAB_END.zeta(near_level);
        let u = place.inside;
        let rest = slab.absorbance - place.absorbance - nearest - farthest;
        let first = slab.first - place.absorbance * u - nearest * begin - farthest * end;
        if begin > u {
            begin = -1.0;
        }
        if end < u {
            end = 1.0;
        }
        let extent = (end - begin).max(2.0 / f64::from(SLAB_END.bins));
        let x = ((u - begin) / extent).clamp(0.0, 1.0);
        let (mut mean, mut bounds) = (0.5, [0.0, 1.0]);
        if place.slab < self.design.means {
            let depth = (first / rest.max(noise)).clamp(begin, end);
            mean = ((depth - begin) / extent).clamp(0.0, 1.0);
            bounds = if x < mean {
                [0.0, (1.0 - mean) / (1.0 - x).max(1e-6)]
            } else {
                [(x - mean) / x.max(1e-6), 1.0]
            };
        }
        Between {
            absorbance: rest.max(0.0),
            place: x,
            mean,
            bounds,
            extent: extent / 2.0,
            own: place.absorbance,
            nearest,
        }
    }
}

/// What is known of each of a pixel's fragments, given as (linear depth, α), in the order given.
pub fn seen(
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    design: Design,
    precision: SumPrecision,
) -> Vec<Seen> {
    let points = points(fragments, warp);
    let slabs = Slabs::of(&points, design, precision);
    let of = |&(b, zeta, counts): &(f64, f64, bool)| slabs.seen(b, zeta, counts);
    points.iter().map(of).collect()
}

fn points(fragments: &[(f32, f32)], warp: &DepthWarp) -> Vec<(f64, f64, bool)> {
    let point = |&(depth, alpha): &(f32, f32)| {
        let zeta = warp.apply(depth.into());
        (absorbance(alpha), zeta, alpha >= FAINT)
    };
    fragments.iter().map(point).collect()
}

/// The guess without a network: the middle of the bounds.
pub const fn middle(_: &Between) -> f64 {
    0.5
}

/// Composites a pixel; `guess` says where between its bounds the share lies that is in front of a fragment.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    warp: &DepthWarp,
    design: Design,
    guess: impl Fn(&Between) -> f64,
) -> [f32; 3] {
    let list: Vec<(f32, f32)> = fragments.iter().map(|f| (f.depth, f.alpha)).collect();
    let total: f64 = list.iter().map(|&(_, alpha)| absorbance(alpha)).sum();
    if total == 0.0 {
        return background;
    }
    // Premultiplied colour and alpha of what is guessed, and of what is known.
    let mut sums = [[0.0f64; 4]; 2];
    for (f, seen) in fragments
        .iter()
        .zip(seen(&list, warp, design, SumPrecision::Exact))
    {
        let w = seen.weight(&guess);
        let sum = &mut sums[usize::from(design.apart && seen.between.is_none())];
        for (sum, c) in sum.iter_mut().zip(f.premultiplied()) {
            *sum += f64::from(c) * w;
        }
        sum[3] += f64::from(f.alpha) * w;
    }
    let (t, background) = ((-total).exp(), background.map(f64::from));
    if design.apart {
        resolve_separate_ends(sums[0], sums[1], t, background)
    } else {
        resolve(sums[0], t, background)
    }
    .map(|c| c as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        methods::{mboit4, moments, over},
        random::Random,
    };

    const C0: [f32; 3] = [0.3, 0.1, 0.7];

    /// A pixel's fragments at these places in the range of the view's depths.
    fn at(places: &[f64], most: f32, random: &mut Random) -> Vec<Fragment> {
        let mut fragments: Vec<_> = places
            .iter()
            .map(|t| {
                let depth = (0.5 * 100f64.powf(*t)) as f32;
                Fragment::new(depth, random.between(0.02, most), random.color())
            })
            .collect();
        crate::fragment::sort_front_to_back(&mut fragments);
        fragments
    }

    fn warp() -> DepthWarp {
        DepthWarp::new(0.5, 50.0)
    }

    fn worst(f: &[Fragment], design: Design, guess: f64) -> f32 {
        let exact = over::composite(f, C0);
        let got = composite(f, C0, &warp(), design, |_| guess);
        (0..3)
            .map(|k| (got[k] - exact[k]).abs())
            .fold(0.0, f32::max)
    }

    /// Two layers in each slab: all are known, whatever is guessed. In the last one the farther is what the nearer leaves; an opacity of
    /// 32 levels says so, as long as it is told from a third layer.
    #[test]
    fn eight_layers_are_known() {
        let mut random = Random::new(3, &[]);
        for seed in 0..200 {
            let mut places = Vec::new();
            for slab in 0..SLABS {
                let [begin, end] = [BORDERS[slab], BORDERS[slab + 1]];
                let depth = |share: f64| begin + (end - begin) * share;
                places.push(depth(0.02 + 0.4 * f64::from(random.unit())));
                places.push(depth(0.55 + 0.4 * f64::from(random.unit())));
            }
            places[0] = 0.0;
            places[7] = 1.0;
            let f = at(&places, 0.98, &mut random);
            for design in [Design::LARGE, Design::MEDIUM] {
                let worst = worst(&f, design, f64::from(seed % 3) / 2.0);
                assert!(worst < 1e-5, "{seed}: {worst}");
            }
        }
    }

    /// 1e−6: about ten roundings of values up to 1. Layers of one bin share a record, so the places are spread evenly.
    #[test]
    fn few_layers_are_exact_whatever_is_guessed() {
        let mut random = Random::new(5, &[]);
        for seed in 0..600 {
            let n = 1 + seed % 3;
            let places: Vec<_> = (0..n)
                .map(|i| (0.1 + 0.8 * f64::from(random.unit()) + f64::from(i)) / f64::from(n))
                .collect();
            let f = at(&places, 0.98, &mut random);
            let designs = [Design::LARGE, Design::MEDIUM, Design::SMALL];
            // Sums apart hold one more layer.
            for design in designs.into_iter().filter(|d| n < 3 || d.apart) {
                let worst = worst(&f, design, f64::from(seed % 4) / 3.0);
                assert!(worst < 1e-6, "{design:?} {f:?}: {worst}");
            }
        }
    }

    /// The truth lies between the bounds, but for what 32 levels of opacity round away of the slab's two ends. Half a level is
    /// (1 + b)²/2·31 of absorbance; the mean depth is off by as much again, from both ends.
    #[test]
    fn bounds_hold() {
        const MOST: f32 = 0.6;
        let level = (1.0 + absorbance(MOST)).powi(2) / f64::from(SLAB_END.alphas - 1);
        let limit = 4.0 * 0.5 * level;
        let mut random = Random::new(7, &[]);
        let (mut guessed, mut width, mut unbounded) = (0, 0.0, 0.0);
        for _ in 0..300 {
            // In 2,000 places, which lie in bins of their own.
            let mut cells: Vec<_> = (0..random.below(8) + 12)
                .map(|_| random.below(2000))
                .collect();
            cells.sort_unstable();
            cells.dedup();
            let places: Vec<_> = cells.iter().map(|&c| c as f64 / 1999.0).collect();
            let f = at(&places, MOST, &mut random);
            let list: Vec<_> = f.iter().map(|f| (f.depth, f.alpha)).collect();
            let mut front = 0.0f64;
            let all = seen(&list, &warp(), Design::LARGE, SumPrecision::Exact);
            for (f, seen) in f.iter().zip(all) {
                let [least, most] = [0.0, 1.0].map(|guess| -seen.weight(|_| guess).ln());
                let holds = least - limit <= front && front <= most + limit;
                assert!(holds, "{front}, not {least} … {most}: {seen:?}");
                guessed += usize::from(seen.between.is_some());
                unbounded += seen.between.map_or(0.0, |between| between.absorbance);
                width += most - least;
                front += absorbance(f.alpha);
            }
        }
        assert!(guessed > 1000, "only {guessed} fragments are guessed");
        assert!(width < 0.75 * unbounded, "{width} of {unbounded}");
    }

    /// Without a network the largest design errs a tenth of four moments' squared error on random pixels, and each smaller one more.
    #[test]
    fn known_layers_beat_moments() {
        let mut random = Random::new(11, &[]);
        let mut squares = [0.0f64; 4];
        for _ in 0..400 {
            let n = 4 + random.below(12);
            let places: Vec<_> = (0..n).map(|_| f64::from(random.unit())).collect();
            let f = at(&places, 0.98, &mut random);
            let exact = over::composite(&f, C0);
            let designs = [Design::LARGE, Design::MEDIUM, Design::SMALL];
            let mut found = designs
                .map(|d| composite(&f, C0, &warp(), d, middle))
                .to_vec();
            let empty = mboit4::Moments::default();
            let settings = moments::Settings::PAPER;
            found.push(moments::composite(&f, C0, &warp(), empty, &settings));
            for (sum, found) in squares.iter_mut().zip(found) {
                *sum += (0..3)
                    .map(|k| f64::from(found[k] - exact[k]).powi(2))
                    .sum::<f64>();
            }
        }
        let [large, medium, small, moments] = squares;
        assert!(large < medium && medium < small, "{squares:?}");
        assert!(large < 0.1 * moments, "{squares:?}");
    }
}
