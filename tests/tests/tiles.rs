//! Methods over several tiles of pixels: what their CPU references, of a pixel alone, do not know.

use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{self, Fragment},
    methods::{
        one::{self, Around, Design, Kept, formula},
        quantiles::{Seen, Tiles, seen_behind_nearest},
        slabs::{self, Extent, Layout},
    },
    statistics::SumPrecision,
};
use peelnet_scene::Material;
use peelnet_tests::{HALF, draw, gpu, object, opaque, rectangle, scene, wall};

const BACKGROUND: [f32; 3] = [0.25, 0.5, 0.75];

/// Of an opaque wall in front of the last layer, and where it is.
const OPAQUE: [f32; 3] = [0.7, 0.6, 0.2];
const OPAQUE_AT: f32 = 3.0;

const SIZE: [u32; 2] = [24, 16];

/// Sums of five half floats, divided by what is left of them without the nearest fragment.
const TOLERANCE: f32 = 32.0 * HALF;

/// Where a value lies on the edge of two of the nearest fragment's steps, 32 bits may round it to the other one.
const OTHER_STEPS: usize = 4;

/// Frames that a still image is drawn in after the first.
const SETTLED: u32 = 12;

fn apart_by(found: &[f32; 4], want: [f32; 3]) -> f32 {
    let errors = found.iter().zip(want).map(|(a, b)| (a - b).abs());
    errors.fold(0.0, f32::max)
}

/// Five layers, two of which end in the middle of the frame, and an opaque wall that hides the last in the other half: tiles left and right of
/// the middle see other depths, and every pixel reads what is interpolated between tiles.
#[test]
fn pixels_read_what_is_seen_around_them() {
    let layer = |z, alpha, color| Fragment::new(z, alpha, color);
    let walls = [
        layer(1.0, 0.3, [0.9, 0.1, 0.2]),
        layer(1.5, 0.4, [0.2, 0.3, 0.9]),
        layer(4.0, 0.5, [0.2, 0.1, 0.7]),
    ];
    // In the left half of the frame.
    let halves = [
        layer(2.0, 0.6, [0.1, 0.8, 0.3]),
        layer(2.5, 0.35, [0.8, 0.7, 0.1]),
    ];
    let material = |f: &Fragment| Material::unlit(f.color, f.alpha);
    let whole = walls.iter().map(|f| wall(f.depth, material(f)));
    let half = halves.iter().map(|f| {
        let left = rectangle(
            [-2.0 * f.depth, 0.0],
            [-2.0 * f.depth, 2.0 * f.depth],
            f.depth,
        );
        object(&left, material(f))
    });
    let right = rectangle(
        [0.0, 2.0 * OPAQUE_AT],
        [-2.0 * OPAQUE_AT, 2.0 * OPAQUE_AT],
        OPAQUE_AT,
    );
    let hiding = object(&right, opaque(OPAQUE));
    let objects = whole.chain(half).chain([hiding]);
    let scene = scene("five layers", BACKGROUND, objects.collect());
    let is_left = |x: u32| x < SIZE[0] / 2;
    let behind = |x: u32| if is_left(x) { BACKGROUND } else { OPAQUE };
    let all = || walls.iter().chain(&halves).copied();
    let warp = DepthWarp::new(1.0, 4.0).with_spans(all().map(|f| [f.depth.into(); 2]));
    let fragments = |x: u32| -> Vec<Fragment> {
        let is_seen = |f: &Fragment| walls.contains(f) && f.depth < OPAQUE_AT;
        all().filter(|f| is_left(x) || is_seen(f)).collect()
    };
    let seen = |x: u32| {
        let points = fragment::points(&fragments(x));
        seen_behind_nearest(&slabs::points(&points, &warp))
    };
    let all_tiles = || [0, 1].into_iter().flat_map(|y| [0, 1, 2].map(|x| [x, y]));
    let tiles = |seen: &dyn Fn([u32; 2]) -> Seen| {
        Tiles::new(SIZE, &all_tiles().map(|tile| (tile, seen(tile))).collect())
    };
    let small = tiles(&|[x, _]| seen(8 * x + 4));
    assert_ne!(small.at([0, 0]), small.at([23, 0]));
    type Color<'a> = &'a dyn Fn(&[Fragment], [f32; 3], Around) -> [f32; 3];
    let of_sums = |design| {
        move |list: &[Fragment], behind, around| {
            one::composite(list, behind, &warp, design, around, formula)
        }
    };
    let of_slabs = |layout: Layout| {
        move |list: &[Fragment], behind, around: Around| {
            let design = slabs::Design {
                extent: Extent::Among(around.quantiles),
                ..layout.design()
            };
            slabs::composite(list, behind, &warp, design, slabs::middle)
        }
    };
    let [one, wide] = [Design::ONE, Design::WIDE].map(of_sums);
    let [small_slabs, medium, large] = Layout::ALL.map(of_slabs);
    let methods: [(&str, Color<'_>, Option<Design>); 7] = [
        ("one", &one, None),
        ("one-wide", &wide, None),
        ("one:range=last", &one, Some(Design::ONE)),
        ("one-wide:range=last", &wide, Some(Design::WIDE)),
        ("slabs:keep=small", &small_slabs, None),
        ("slabs:keep=medium", &medium, None),
        ("slabs", &large, None),
    ];
    for (method, color, last) in methods {
        let mut tiles_of_frame = small.clone();
        for design in last.iter().cycle().take(SETTLED as usize) {
            tiles_of_frame = tiles(&|tile| {
                let pixel = tile.map(|k| 8 * k + 4);
                let list = fragments(pixel[0]);
                let points = slabs::points(&fragment::points(&list), &warp);
                let colors = list.iter().map(|f| f.color);
                let known = Around::new(tiles_of_frame.at(pixel), pixel);
                Kept::gather(&points, colors, *design, known, SumPrecision::Half).last_seen()
            });
        }
        assert_eq!(tiles_of_frame == small, last.is_none());
        let image = draw(&gpu(), &scene, method, SIZE);
        let mut apart = Vec::new();
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let around = Around::new(tiles_of_frame.at([x, y]), [x, y]);
                let want = color(&fragments(x), behind(x), around);
                let found = image.pixels[(y * SIZE[0] + x) as usize];
                let error = apart_by(&found, want);
                if error.is_nan() || error > TOLERANCE {
                    apart.push((x, y, error));
                }
            }
        }
        assert!(apart.len() <= OTHER_STEPS, "{method}: {apart:?}");
    }
}
