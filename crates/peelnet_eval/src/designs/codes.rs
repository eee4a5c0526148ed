//! Known layers by the surface that they belong to, for renderers that know a fragment's object and the side that it shows: instead of each
//! slab's nearest and farthest fragment, the nearest one of each code. A surface has two of eight codes. It is judged without a network, for
//! comparison with the slabs' own ends in as many bytes.

use super::views::Stacked;
use peelnet_core::{
    absorbance::absorbance,
    methods::{
        anchored::{FAINT, resolve},
        slabs::Range,
    },
    statistics::FAR_END,
};
use peelnet_scene::{Camera, Scene};

/// Its name in tables.
pub const CODES: &str = "four slabs (means), 2 of 8 codes of (object, side); no network";

const CHANNELS: usize = 8;

/// Pairs of channels.
const PAIRS: u32 = 28;

/// Where slabs end: as in the largest design that ships.
const ENDS: [f64; 4] = [0.12, 0.4, 0.75, 1.0];

/// The surface of each triangle of a scene as a camera sees it: twice its object's number, and one more of the back.
pub(super) fn surfaces(scene: &Scene, camera: &Camera) -> Vec<u32> {
    let mut all = Vec::with_capacity(scene.triangles());
    for (object, number) in scene.objects.iter().zip(0u32..) {
        let world = object.world_from_object;
        all.extend(object.mesh.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| world.transform_point3(object.mesh.positions[i as usize]));
            let is_back = (b - a).cross(c - a).dot(camera.position - a) < 0.0;
            2 * number + u32::from(is_back)
        }));
    }
    all
}

/// The two channels of a surface; all pairs are used before one is used again.
fn channels(surface: u32) -> [usize; 2] {
    let mut left = (surface.wrapping_mul(11) % PAIRS) as usize;
    for first in 0..CHANNELS {
        let others = CHANNELS - 1 - first;
        if left < others {
            return [first, first + 1 + left];
        }
        left -= others;
    }
    unreachable!("there are as many pairs")
}

fn half(x: f64) -> f64 {
    f64::from(half::f16::from_f64(x))
}

/// What a pixel keeps, and its fragments.
struct Coded {
    range: Range,
    /// Absorbance and its product with the depth in the slab.
    sums: [[f64; 2]; ENDS.len()],
    nearest: [Option<u32>; CHANNELS],
}

/// Where a fragment lies.
struct Place {
    slab: usize,
    inside: f64,
    level: u32,
}

fn in_slab(t: f64) -> (usize, f64) {
    let slab = ENDS[..ENDS.len() - 1]
        .iter()
        .filter(|end| t >= **end)
        .count();
    let begin = slab.checked_sub(1).map_or(0.0, |k| ENDS[k]);
    (slab, 2.0 * (t - begin) / (ENDS[slab] - begin) - 1.0)
}

impl Coded {
    fn place(&self, b: f64, zeta: f64) -> Place {
        let t = self.range.place(zeta);
        let (slab, inside) = in_slab(t);
        Place {
            slab,
            inside,
            level: FAR_END.mirrored(2.0 * t - 1.0, b),
        }
    }

    /// The weight of a fragment: half of what may be in front of it counts.
    fn weight(&self, b: f64, zeta: f64, surface: u32, counts: bool) -> f64 {
        let own = self.place(b, zeta);
        let bin = |level: u32| FAR_END.bins - 1 - level / FAR_END.alphas;
        let mut known: Vec<u32> = self.nearest.iter().flatten().copied().collect();
        known.sort_unstable();
        known.dedup();
        let recorded = counts
            && channels(surface)
                .iter()
                .any(|&k| self.nearest[k] == Some(own.level));
        let nearest = known.iter().map(|&level| bin(level)).min();
        if recorded && nearest == Some(bin(own.level)) {
            return 1.0;
        }
        let front: f64 = self.sums[..own.slab].iter().map(|s| s[0]).sum();
        let [absorbance, first] = self.sums[own.slab];
        let (mut rest, mut moment) = (absorbance - b, first - b * own.inside);
        let (mut before, mut most, mut in_front) = (0.0, 0.0f64, 0usize);
        for &level in known
            .iter()
            .filter(|&&level| !(recorded && level == own.level))
        {
            let t = (f64::from(bin(level)) + 0.5) / f64::from(FAR_END.bins);
            let (slab, inside) = in_slab(t);
            if slab != own.slab {
                continue;
            }
            let b = FAR_END.absorbance(level);
            rest -= b;
            moment -= b * inside;
            most = most.max(b);
            in_front += 1;
            before += match bin(level).cmp(&bin(own.level)) {
                std::cmp::Ordering::Less => b,
                std::cmp::Ordering::Equal => 0.5 * b,
                std::cmp::Ordering::Greater => 0.0,
            };
        }
        let noise = (absorbance / 1024.0).max(1e-6);
        let step = 0.6 / f64::from(FAR_END.alphas - 1);
        let tolerance = step * (1.0 + most).powi(2) * (in_front as f64).sqrt() + noise;
        let others = (absorbance - b).max(0.0);
        if rest < tolerance {
            // All is known: what quantised opacities miss is shared out.
            let known = (others - rest).max(1e-9);
            let share = if in_front == 0 {
                0.0
            } else {
                (before * others / known).min(others)
            };
            return (-(front + share)).exp();
        }
        let mean = (moment / rest).clamp(-1.0, 1.0).mul_add(0.5, 0.5);
        let x = own.inside.mul_add(0.5, 0.5);
        let bounds = if x < mean {
            [0.0, (1.0 - mean) / (1.0 - x).max(1e-6)]
        } else {
            [(x - mean) / x.max(1e-6), 1.0]
        };
        let share = 0.5 * (bounds[0] + bounds[1]);
        (-(front + before.min(others) + rest * share)).exp()
    }
}

/// The colour of a pixel over black, with its statistics rounded to halves.
pub fn composite(stack: &Stacked<'_>) -> [f32; 3] {
    let warp = stack.warp();
    let points: Vec<(f64, f64, u32, bool)> = stack
        .fragments
        .iter()
        .map(|f| {
            (
                absorbance(f.alpha),
                warp.apply(f.depth.into()),
                f.triangle,
                f.alpha >= FAINT,
            )
        })
        .collect();
    let mut coded = Coded {
        range: Range::of(points.iter().map(|p| p.1)),
        sums: [[0.0; 2]; ENDS.len()],
        nearest: [None; CHANNELS],
    };
    for &(b, zeta, surface, counts) in &points {
        let place = coded.place(b, zeta);
        let sums = &mut coded.sums[place.slab];
        sums[0] = half(sums[0] + half(b));
        sums[1] = half(sums[1] + half(b * place.inside));
        for k in channels(surface).into_iter().filter(|_| counts) {
            coded.nearest[k] = coded.nearest[k].max(Some(place.level));
        }
    }
    let mut sums = [0.0f64; 4];
    for (f, &(b, zeta, surface, counts)) in stack.fragments.iter().zip(&points) {
        let w = coded.weight(b, zeta, surface, counts);
        for (sum, c) in sums.iter_mut().zip(f.premultiplied()) {
            *sum += f64::from(c) * w;
        }
        sums[3] += f64::from(f.alpha) * w;
    }
    let total: f64 = points.iter().map(|p| p.0).sum();
    resolve(sums, (-total).exp(), [0.0; 3]).map(|c| c as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::designs::View;
    use peelnet_core::{absorbance::DepthWarp, fragment::Fragment, methods::over, random::Random};
    use std::collections::BTreeSet;

    #[test]
    fn every_pair_of_channels_is_used() {
        let all: BTreeSet<[usize; 2]> = (0..PAIRS).map(channels).collect();
        assert_eq!(all.len(), PAIRS as usize);
        assert!(all.iter().all(|[a, b]| a < b && *b < CHANNELS));
    }

    /// Four surfaces whose channels differ are all known: exact but for 16-bit sums and for what 32 levels of opacity round, which is
    /// shared out where nothing else is in the slab.
    #[test]
    fn surfaces_of_their_own_are_known() {
        const LEVELS: f64 = 0.02;
        let surfaces: Vec<u32> = {
            let mut taken = BTreeSet::new();
            let own = |s: &u32| channels(*s).iter().all(|k| taken.insert(*k));
            (0..PAIRS).filter(own).take(4).collect()
        };
        assert_eq!(surfaces.len(), 4);
        let mut random = Random::new(3, &[]);
        let warp = DepthWarp::new(1.0, 8.0);
        for _ in 0..200 {
            let list: Vec<Fragment> = (0..4)
                .map(|k| Fragment {
                    triangle: surfaces[k],
                    ..Fragment::new(
                        2f32.powf(0.9 * k as f32 + 0.1 * random.unit()),
                        random.between(0.05, 0.9),
                        random.color(),
                    )
                })
                .collect();
            let exact = over::composite_f64(&list, [0.0; 3]);
            let view = View::new("s", warp, 1, [(0, list.clone())]);
            let found = view.measure(composite);
            assert!(
                found.mse_linear < LEVELS * LEVELS,
                "{list:?}: {exact:?}, {found:?}"
            );
        }
    }
}
