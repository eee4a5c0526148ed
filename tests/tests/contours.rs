//! Which neighbours show the same surfaces, and contour pairs, of scenes whose regions are known.

use glam::Vec3;
use peelnet_bench::{
    bench,
    compare::{EXACT, Plan},
    contours::Pairs,
};
use peelnet_render::Renderer;
use peelnet_render::gpu::Gpu;
use peelnet_scene::{Material, Object};
use peelnet_tests::{even, gpu, object, opaque, quad, scene, specs};
use std::sync::Arc;

const SIDE: u32 = 16;

/// Two triangles that cover these columns and rows, at the depth `z[0]` on the left and `z[1]` on the right; counter-clockwise as seen.
fn pane(z: [f32; 2], columns: [f32; 2], rows: [f32; 2]) -> [[Vec3; 3]; 2] {
    let half = SIDE as f32 / 2.0;
    let at = |k: usize, j: usize| {
        let (x, y) = (columns[k] / half - 1.0, 1.0 - rows[j] / half);
        z[k] * Vec3::new(x, y, -1.0)
    };
    quad([at(0, 1), at(1, 1), at(1, 0), at(0, 0)])
}

fn glass() -> Material {
    Material::unlit([0.5; 3], 0.5)
}

fn pairs(gpu: &Gpu, objects: Vec<Object>, samples: u32) -> u64 {
    let scene = scene("known", [0.0; 3], objects);
    let renderer = Renderer::new(gpu, &scene).unwrap();
    let mut surfaces = renderer.surfaces([SIDE; 2], samples).unwrap();
    let frame = renderer.image(&mut surfaces, &scene.views[0]);
    Pairs::from_surfaces(&frame.unwrap().image).count()
}

/// Pairs inside a rectangle of pixels.
fn inside(columns: u64, rows: u64) -> u64 {
    (columns - 1) * rows + columns * (rows - 1)
}

const ALL: u64 = SIDE as u64;
const FRAME: [f32; 2] = [0.0, SIDE as f32];

/// Columns 0–9 of one quad and 6–15 of another one, eight rows: three regions, and a background that has none. Four samples see the same.
#[test]
fn overlapping_quads_make_regions() {
    let gpu = gpu();
    let left = pane([2.0; 2], [0.0, 10.0], [4.0, 12.0]);
    let right = pane([3.0; 2], [6.0, 16.0], [4.0, 12.0]);
    let want = inside(6, 8) + inside(4, 8) + inside(6, 8);
    for samples in [1, 4] {
        let both = vec![object(&left, glass()), object(&right, glass())];
        assert_eq!(pairs(&gpu, both, samples), want, "{samples} samples");
    }
    // Of one object the two outer regions show the same surface; where they overlap it is there twice.
    let one = vec![object(&[left, right].concat(), glass())];
    assert_eq!(pairs(&gpu, one, 1), want);
    // Two objects that touch.
    let halves = [[0.0, 8.0], [8.0, 16.0]].map(|columns| pane([2.0; 2], columns, FRAME));
    let touching = halves.map(|half| object(&half, glass())).to_vec();
    assert_eq!(pairs(&gpu, touching, 1), 2 * inside(8, ALL));
}

/// Two quads that cross in the middle: the same surfaces on both sides, in another order. One behind the other there is no border.
#[test]
fn the_order_counts() {
    let gpu = gpu();
    let crossing = |near: f32, far: f32| {
        let one = pane([near, far], FRAME, FRAME);
        let other = pane([3.0; 2], FRAME, FRAME);
        let both = vec![object(&one, glass()), object(&other, glass())];
        pairs(&gpu, both, 1)
    };
    assert_eq!(crossing(1.5, 2.0), inside(ALL, ALL));
    let halves = crossing(1.5, 6.0);
    // They cross where 1/z, which is linear on the screen, is 1/3.
    let columns = ((1.0 / 1.5 - 1.0 / 3.0) / (1.0 / 1.5 - 1.0 / 6.0) * f64::from(SIDE)).round();
    let columns = columns as u64;
    assert_eq!(halves, inside(columns, ALL) + inside(ALL - columns, ALL));
}

/// Opacity and light do not count; holes, what is hidden and the side that is seen do.
#[test]
fn opacity_does_not_count_and_holes_do() {
    let gpu = gpu();
    let [near_left, right] = [[0.0, 8.0], [8.0, 16.0]].map(|c| pane([2.0; 2], c, FRAME));
    let turned = right.map(|[a, b, c]| [a, c, b]);
    let two = vec![object(&[near_left, turned].concat(), glass())];
    assert_eq!(pairs(&gpu, two, 1), 2 * inside(8, ALL));
    let whole = pane([2.0; 2], FRAME, FRAME);
    let left = pane([3.0; 2], [0.0, 8.0], FRAME);
    let mut shaded = object(&[near_left, right].concat(), glass());
    let mesh = Arc::make_mut(&mut shaded.mesh);
    mesh.colors = vec![[1.0, 0.0, 1.0, 0.1]; 6];
    mesh.colors.resize(12, [0.0; 4]);
    assert_eq!(pairs(&gpu, vec![shaded], 1), inside(ALL, ALL));
    // A wall of holes alone.
    let mut holes = glass();
    holes.maps.color = even([255, 255, 255, 10]);
    (holes.alpha_cutoff, holes.blend) = (Some(0.25), true);
    let mut wall = object(&left, holes);
    let mesh = Arc::make_mut(&mut wall.mesh);
    mesh.uvs = vec![[glam::Vec2::ZERO; 3]; 2];
    let through = vec![object(&whole, glass()), wall];
    assert_eq!(pairs(&gpu, through, 1), inside(ALL, ALL));
    // An opaque wall in front of the left half.
    let front = object(&pane([1.0; 2], [0.0, 8.0], FRAME), opaque([1.0; 3]));
    let hidden = vec![object(&whole, glass()), front];
    assert_eq!(pairs(&gpu, hidden, 1), inside(8, ALL));
}

/// A bench counts the border that runs down the whole frame between a wall of one colour before a black one and before a white one: blending
/// in the wrong order errs by another amount on both sides. Exact methods have no contour.
#[test]
fn benches_count_the_border_of_an_error() {
    let gpu = gpu();
    let near = object(&pane([2.0; 2], FRAME, FRAME), glass());
    let halves = [[0.0, 8.0], [8.0, 16.0]].map(|columns| pane([3.0; 2], columns, FRAME));
    let mut far = object(&halves.concat(), Material::unlit([1.0; 3], 0.5));
    let mesh = Arc::make_mut(&mut far.mesh);
    mesh.colors = vec![[0.0, 0.0, 0.0, 1.0]; 6];
    mesh.colors.resize(12, [1.0; 4]);
    let scene = scene("bordered", [0.0; 3], vec![near, far]);
    let methods = specs(["depth-peel", "weighted-average"]);
    let want = ALL as f64 / inside(ALL, ALL) as f64;
    let plan = Plan {
        frames: 0,
        ..Plan::new([SIDE; 2], &methods)
    };
    let rows = bench(&gpu, std::slice::from_ref(&scene), &plan).unwrap();
    let found = rows.iter().map(|r| (r.method.as_str(), r.contour_pairs));
    let (exact, want) = (Some(0.0), ("weighted-average", Some(want)));
    let want = [(EXACT, exact), ("depth-peel", exact), want];
    assert_eq!(found.collect::<Vec<_>>(), want);
}
