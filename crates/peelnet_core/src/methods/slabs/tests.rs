use super::*;
use crate::methods::quantiles::{Tiles, seen_behind_nearest};
use crate::{absorbance::absorbance, fragment::points as points_of, methods::over, random::Random};
use std::collections::BTreeSet;

const C0: [f32; 3] = [0.3, 0.1, 0.7];

/// A pixel's fragments at these places in the range of the view's depths.
fn at(places: &[f64], most: f32, random: &mut Random) -> Vec<Fragment> {
    let layers = places.iter().map(|t| {
        let depth = (0.5 * 100f64.powf(*t)) as f32;
        Fragment::new(depth, random.between(0.02, most), random.color())
    });
    over::sorted(&layers.collect::<Vec<_>>())
}

fn warp() -> DepthWarp {
    DepthWarp::new(0.5, 50.0)
}

fn worst(f: &[Fragment], design: Design, guess: f64) -> f32 {
    let exact = over::composite(f, C0);
    let got = composite(f, C0, &warp(), design, |_| guess);
    let errors = (0..3).map(|k| (got[k] - exact[k]).abs());
    errors.fold(0.0, f32::max)
}

/// Two layers in each slab: all are known, whatever is guessed.
#[test]
fn two_layers_of_each_slab_are_known() {
    let mut random = Random::new(3, &[]);
    for seed in 0..600 {
        let design = Design {
            extent: Extent::Ends,
            ..Layout::ALL[seed % 3].design()
        };
        let mut places = Vec::new();
        for slab in 0..design.slabs.len() {
            let [begin, end] = [design.begin(slab), design.slabs[slab].end];
            let depth = |share: f64| begin + (end - begin) * share;
            places.push(depth(0.02 + 0.4 * f64::from(random.unit())));
            places.push(depth(0.55 + 0.4 * f64::from(random.unit())));
        }
        places[0] = 0.0;
        places[2 * design.slabs.len() - 1] = 1.0;
        let f = at(&places, 0.98, &mut random);
        let worst = worst(&f, design, (seed / 3 % 3) as f64 / 2.0);
        assert!(worst < 1e-5, "{seed}: {worst}");
    }
}

/// What the shaders have is found by what is kept, whatever is cut into slabs.
#[test]
fn layouts_are_found() {
    for layout in Layout::ALL {
        let mut design = layout.design();
        design.extent = Extent::Ends;
        assert_eq!(design.layout(), Some(layout));
        design.apart = true;
        assert_eq!(design.layout(), None);
    }
    assert_eq!(Layout::ALL.map(|l| l.design().bytes()), [29, 33, 41]);
}

/// Two passes of a renderer may round a depth otherwise. What was recorded is recognised all the same, but at a border between two slabs.
#[test]
fn depths_that_are_rounded_otherwise_are_known_still() {
    const MOVED: f64 = 1e-5;
    let mut random = Random::new(13, &[]);
    let (mut known, mut in_other_bins) = (0, 0);
    for seed in 0..900 {
        let design = Layout::ALL[seed % 3].design();
        let places: Vec<_> = (0..4).map(|_| f64::from(random.unit())).collect();
        let list = at(&places, 0.98, &mut random);
        let list = points_of(&list);
        let points = points(&list, &warp());
        let slabs = Slabs::gather(&points, design, SumPrecision::Exact);
        for &(b, zeta, counts) in &points {
            let was = slabs.known(b, zeta, counts);
            let [own, one, other] = [zeta, zeta - MOVED, zeta + MOVED].map(|z| slabs.place(b, z));
            let in_one_slab = [one, other].iter().all(|p| p.slab == own.slab);
            if was.unknown.is_some() || !in_one_slab {
                continue;
            }
            known += 1;
            in_other_bins += usize::from(one.bin != own.bin || other.bin != own.bin);
            for moved in [zeta - MOVED, zeta + MOVED] {
                assert_eq!(slabs.known(b, moved, counts), was, "{zeta} of {list:?}");
            }
        }
    }
    let is_enough = known > 2000 && in_other_bins > 50;
    assert!(is_enough, "{known}, {in_other_bins}");
}

/// The truth lies between the bounds, but for what 32 levels of opacity round away of the slab's two ends. Half a level is
/// (1 + b)²/2·31 of absorbance; the mean depth is off by as much again, from both ends.
#[test]
fn bounds_hold() {
    const MOST: f32 = 0.6;
    let level = (1.0 + absorbance(MOST)).powi(2) / f64::from(FARTHEST_CODE.alphas - 1);
    let limit = 4.0 * 0.5 * level;
    let design = Design {
        extent: Extent::Bins(1),
        ..Design::LARGE
    };
    let mut random = Random::new(7, &[]);
    let (mut guessed, mut width, mut unbounded) = (0, 0.0, 0.0);
    for _ in 0..300 {
        // In 2,000 places, which lie in bins of their own.
        let count = random.below(8) + 12;
        let cells: BTreeSet<_> = (0..count).map(|_| random.below(2000)).collect();
        let places: Vec<_> = cells.iter().map(|&c| c as f64 / 1999.0).collect();
        let f = at(&places, MOST, &mut random);
        let list = points_of(&f);
        let mut front = 0.0f64;
        let all = known_fragments(&list, &warp(), design, SumPrecision::Exact);
        for (f, fragment) in f.iter().zip(all) {
            let [least, most] = [0.0, 1.0].map(|guess| -fragment.weight(|_| guess).ln());
            let holds = least - limit <= front && front <= most + limit;
            assert!(holds, "{front}, not {least} … {most}: {fragment:?}");
            guessed += usize::from(fragment.unknown.is_some());
            unbounded += fragment.unknown.map_or(0.0, |between| between.absorbance);
            width += most - least;
            front += absorbance(f.alpha);
        }
    }
    assert!(guessed > 1000, "only {guessed} fragments are guessed");
    assert!(width < 0.75 * unbounded, "{width} of {unbounded}");
}

/// Bins without fragments take nothing of a pixel's scale; of the others, the share of the root of what is seen of them.
#[test]
fn bins_share_the_scale_by_what_is_seen_of_them() {
    let mut bins = [0.0; 8];
    (bins[2], bins[5]) = (-0.75f64.ln(), 40.0);
    let scale = Scale::from_bins(&bins, [0.0, 255.0]);
    // Three quarters are seen behind the first, and nothing behind both.
    let [of_first, of_second] = [0.25f64.sqrt(), 0.75f64.sqrt()];
    let first = of_first / (of_first + of_second);
    for (bin, expected) in [
        (0.0, 0.0),
        (2.0, 0.0),
        (2.5, first / 2.0),
        (3.0, first),
        (5.0, first),
        (5.5, (1.0 + first) / 2.0),
        (6.0, 1.0),
        (8.0, 1.0),
    ] {
        let off = scale.place(bin / 4.0 - 1.0) - expected;
        assert!(off.abs() < 1e-12, "{bin} is off by {off}");
    }
    assert_eq!(
        Scale::from_bins(&[0.0; 8], [0.0, 255.0]),
        Scale::Among(Quantiles::EVEN)
    );
}

/// Where all fragments lie in one bin, its part between them is the scale, as if there were no bins.
#[test]
fn ends_cut_bins() {
    let mut bins = [0.0; 8];
    bins[3] = 1.0;
    let [low, high] = [100.0, 120.0];
    let scale = Scale::from_bins(&bins, [low, high]);
    for share in [0.0, 0.25, 0.5, 1.0] {
        let zeta = 2.0 * (low + share * (high - low)) / TOP - 1.0;
        let off = scale.place(zeta) - share;
        assert!(off.abs() < 1e-12, "{share} is off by {off}");
    }
    assert_eq!([scale.place(-1.0), scale.place(1.0)], [0.0, 1.0]);
}

/// A layer apart changes little where quantiles of what is seen around the pixel say where the others are.
#[test]
fn a_layer_apart_leaves_the_others_their_slabs() {
    let mut random = Random::new(5, &[]);
    for _ in 0..200 {
        let places: Vec<_> = (0..12)
            .map(|_| f64::from(random.between(0.8, 1.0)))
            .collect();
        let mut f = at(&places, 0.4, &mut random);
        f.push(Fragment::new(0.5, 0.15, [1.0; 3]));
        let f = over::sorted(&f);
        let seen = seen_behind_nearest(&points(&points_of(&f), &warp()));
        let tiles = Tiles::new([1, 1], &[([0, 0], seen)].into());
        let among = Extent::Among(tiles.at([0, 0]));
        let [among, ends] = [among, Extent::Ends].map(|extent| {
            let design = Design {
                extent,
                ..Design::LARGE
            };
            worst(&f, design, 0.5)
        });
        assert!(among < 0.03, "{among}, and {ends} by the ends");
    }
}
