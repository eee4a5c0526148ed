//! Where in depth a pixel's layers are, known without looking at the pixel itself: quantiles of depth, of what is seen in the pixels around it.
//!
//! They come from a pass over one pixel of 64 that knows depth and opacity alone ([`Tiles`]), and change smoothly from pixel to pixel.

use super::Point;
use crate::statistics::NEAREST_CODE;
use std::collections::BTreeMap;

/// Pixels from one that is looked at to the next, both ways.
pub const TILE: u32 = 8;

/// Bins of the frame's depth that tell where in a pixel absorbance lies.
pub const TILE_BINS: usize = 16;

/// What is seen before each of the depths that are kept, as a share of all that is seen behind the nearest fragments.
pub const SHARES: [f64; 4] = [0.06, 0.35, 0.65, 0.94];

/// What is seen where nothing is known, of one pixel: evenly spread.
const PRIOR: f64 = 0.02;

/// The shortest stretch between two quantiles, of the frame's depth.
const SHORTEST: f64 = 1e-4;

/// Levels of 8 bits, less one.
pub(super) const TOP: f64 = 255.0;

/// Levels of 8 bits that an absorbance of 1 is.
pub const BIN_LEVELS: f64 = 64.0;

/// What 8-bit targets hold of so many bins of a pixel's depth, 0 … 255. A fragment is shared between the two bins whose middles it lies
/// between, so that little changes as it moves from one to the other, and in whole levels, so that no order of adding changes a sum.
pub fn bins_of(fragments: &[Point], bins: usize) -> Vec<f64> {
    let mut all = vec![0.0; bins];
    for &(b, zeta, _) in fragments {
        let place = depth_of(zeta) * bins as f64 - 0.5;
        let place = place.clamp(0.0, bins as f64 - 1.0);
        // At least one: a bin with any fragment is not empty.
        let level = (BIN_LEVELS * b + 0.5).floor().max(1.0);
        for (sum, k) in all.iter_mut().zip(0u8..) {
            let share = (1.0 - (place - f64::from(k)).abs()).max(0.0);
            *sum = (*sum + (level * share + 0.5).floor()).min(TOP);
        }
    }
    all
}

/// The levels of the nearest and the farthest of a pixel's depths, rounded away from each other, of 0 … 255.
pub fn ends_of(zetas: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [TOP, 0.0f64];
    zetas.into_iter().fold(none, |[low, high], zeta| {
        let level = TOP * depth_of(zeta);
        [low.min(level.floor()), high.max(level.ceil())]
    })
}

/// A warped depth as 0 … 1 of the frame's.
pub fn depth_of(zeta: f64) -> f64 {
    0.5 * zeta + 0.5
}

/// Depths, 0 … 1 of the frame's, in front of which [`SHARES`] lie of what is seen behind the nearest fragments around a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiles(pub [f64; 4]);

impl Quantiles {
    /// Of a frame of which only its nearest and farthest depth are known.
    pub const EVEN: Self = Self(SHARES);

    /// Of a pixel of which only the nearest and the farthest depth are known, in levels as of [`ends_of`].
    pub fn between([low, high]: [f64; 2]) -> Self {
        let [low, high] = [low, high.max(low + 1.0)].map(|level| level / TOP);
        Self(SHARES.map(|share| low + share * (high - low)))
    }

    /// Where a depth lies among them, 0 … 1.
    pub fn place(&self, depth: f64) -> f64 {
        let knots = |inner: [f64; 4]| [0.0, inner[0], inner[1], inner[2], inner[3], 1.0];
        let (depths, shares) = (knots(self.0), knots(SHARES));
        let stretches = depths.windows(2).zip(shares.windows(2));
        let passed = stretches.map(|(d, s)| {
            let part = (depth - d[0]) / (d[1] - d[0]).max(SHORTEST);
            (s[1] - s[0]) * part.clamp(0.0, 1.0)
        });
        passed.sum()
    }

    /// On the scale halfway between depth and place, on which the nearest fragment's depth is kept.
    pub(super) fn halfway(&self) -> Self {
        Self(std::array::from_fn(|k| 0.5 * (self.0[k] + SHARES[k])))
    }

    pub(super) fn of_seen(seen: [f64; TILE_BINS]) -> Self {
        let all: f64 = seen.iter().sum();
        let at = |share: f64| {
            let mut passed = 0.0;
            for (k, bin) in seen.iter().enumerate() {
                if passed + bin >= share * all {
                    let part = (share * all - passed) / bin.max(1e-9);
                    return (k as f64 + part.clamp(0.0, 1.0)) / TILE_BINS as f64;
                }
                passed += bin;
            }
            1.0
        };
        Self(SHARES.map(at))
    }

    /// As they are kept, in 8 bits.
    fn steps(&self) -> [u8; 4] {
        self.0.map(|q| (q * TOP + 0.5) as u8)
    }
}

/// What is seen of a pixel behind its nearest fragment, by bins of depth.
pub type Seen = [f32; TILE_BINS];

/// What is seen of a pixel behind its nearest fragment.
pub fn seen_behind_nearest(fragments: &[Point]) -> Seen {
    let levels = fragments
        .iter()
        .map(|&(b, zeta, _)| NEAREST_CODE.mirrored(zeta, b));
    let Some(nearest) = levels.max() else {
        return [0.0; TILE_BINS];
    };
    let nearest = (
        NEAREST_CODE.absorbance(nearest),
        -NEAREST_CODE.zeta(nearest),
        true,
    );
    let (bins, taken) = (
        bins_of(fragments, TILE_BINS),
        bins_of(&[nearest], TILE_BINS),
    );
    let mut front = 0.0f64;
    std::array::from_fn(|k| {
        let (all, rest) = (bins[k] / BIN_LEVELS, (bins[k] - taken[k]).max(0.0));
        let seen = (-front).exp() - (-front - all).exp();
        front += all;
        (seen * rest / bins[k].max(1.0)) as f32
    })
}

/// The quantiles of a frame, by tiles of [`TILE`] × [`TILE`] pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiles {
    /// The last column and the last row.
    last: [u32; 2],
    /// Of tiles that have one beside them in which anything is seen, and of all others.
    quantiles: BTreeMap<[u32; 2], [u8; 4]>,
    elsewhere: [u8; 4],
}

impl Tiles {
    /// Of what is seen in a pixel of some tiles of a frame ([`seen_behind_nearest`]): each tile's quantiles are those of the nine around it.
    pub fn new(frame: [u32; 2], seen: &BTreeMap<[u32; 2], Seen>) -> Self {
        let last = frame.map(|n| n.div_ceil(TILE).max(1) - 1);
        let nine = |tile: [u32; 2]| {
            (0..9).map(move |k| {
                let beside =
                    |axis: usize, by: u32| (tile[axis] + by).saturating_sub(1).min(last[axis]);
                [beside(0, k % 3), beside(1, k / 3)]
            })
        };
        let around = |tile: [u32; 2]| {
            let mut sum = [PRIOR / TILE_BINS as f64; TILE_BINS];
            for one in nine(tile).filter_map(|beside| seen.get(&beside)) {
                sum.iter_mut()
                    .zip(one)
                    .for_each(|(sum, &bin)| *sum += f64::from(bin));
            }
            Quantiles::of_seen(sum)
        };
        let mut quantiles = BTreeMap::new();
        for tile in seen.keys().flat_map(|&tile| nine(tile)) {
            quantiles
                .entry(tile)
                .or_insert_with(|| around(tile).steps());
        }
        let elsewhere = Quantiles::of_seen([1.0; TILE_BINS]).steps();
        Self {
            last,
            quantiles,
            elsewhere,
        }
    }

    /// Of a pixel, linear between the middles of tiles.
    pub fn at(&self, pixel: [u32; 2]) -> Quantiles {
        let place = pixel.map(|k| (f64::from(k) + 0.5) / f64::from(TILE) - 0.5);
        let mut all = [0.0; 4];
        for beside in 0..4u32 {
            let mut weight = 1.0;
            let tile = [0, 1].map(|axis| {
                let (low, far) = (place[axis].floor(), f64::from(beside >> axis & 1));
                weight *= 1.0 - (place[axis] - low - far).abs();
                (low + far).clamp(0.0, f64::from(self.last[axis])) as u32
            });
            let of = self.quantiles.get(&tile).unwrap_or(&self.elsewhere);
            all.iter_mut()
                .zip(of)
                .for_each(|(sum, &q)| *sum += weight * (f64::from(q) / TOP));
        }
        Quantiles(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fragment of an absorbance at a depth, 0 … 1.
    fn at(absorbance: f64, depth: f64) -> Point {
        (absorbance, 2.0 * depth - 1.0, true)
    }

    /// Behind a nearest fragment of absorbance 1 lies one of 2: what is seen of it is `e^−1 (1 − e^−2)`, in its own two bins.
    #[test]
    fn what_is_seen_behind_the_nearest_is_in_its_bins() {
        let seen = seen_behind_nearest(&[at(2.0, 0.7), at(1.0, 0.1)]);
        let want = (-1.0f32).exp() * -(-2.0f32).exp_m1();
        // Levels of 1/64, and what a step of the nearest fragment's opacity leaves of it.
        assert!((seen.iter().sum::<f32>() - want).abs() < 0.02, "{seen:?}");
        // A step of the nearest fragment's opacity is left in its own bin.
        assert!((seen[10] + seen[11]) / want > 0.95, "{seen:?}");
        let alone = seen_behind_nearest(&[at(1.0, 0.4)]);
        // Its depth is known to half of 1/240, a thirtieth of a bin, which moves that much of it to the next.
        assert!(alone.iter().sum::<f32>() < 0.04, "{alone:?}");
    }

    /// Where all tiles see the same, so do all pixels; beside a tile that sees nothing the quantiles are those of what is seen.
    #[test]
    fn tiles_see_what_is_around_them() {
        let seen = seen_behind_nearest(&[at(1.0, 0.1), at(1.0, 0.3), at(1.0, 0.5)]);
        let frame = |columns, seen: &[Seen]| {
            let places = (0..).map(|k| [k % columns, k / columns]);
            let rows = seen.len() as u32 / columns;
            let tiles = places.zip(seen.iter().copied()).collect();
            Tiles::new([columns * TILE, rows * TILE], &tiles)
        };
        let tiles = frame(3, &[seen; 6]);
        let is_same = |Quantiles(a): Quantiles, Quantiles(b): Quantiles| {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(is_same(tiles.at([0, 0]), tiles.at([23, 15])));
        let Quantiles(q) = tiles.at([12, 8]);
        assert!(
            q[0] > 0.2 && q[3] < 0.6 && q[0] < q[1] && q[1] < q[2],
            "{q:?}"
        );
        let nothing = [0.0; TILE_BINS];
        let one = frame(3, &[nothing, seen, nothing]);
        assert!(is_same(one.at([0, 3]), one.at([12, 3])));
        let apart = frame(4, &[seen, nothing, nothing, nothing]);
        let Quantiles(even) = apart.at([31, 0]);
        for (found, share) in even.into_iter().zip(SHARES) {
            assert!((found - share).abs() < 0.5 / 255.0 + 1e-9, "{even:?}");
        }
    }
}
