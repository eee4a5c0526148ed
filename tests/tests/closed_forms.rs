//! Stacked walls whose every pixel holds known fragments × every method: the GPU against the CPU twin.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{Fragment, worked_example},
    methods::{
        blended, kbuffer, mboit4, mboit6, over, stochastic, wavelet, wboit, weighted_average,
        weighted_sum,
    },
    weights::Weight,
};
use peelnet_render::{MethodSpec, Renderer};
use peelnet_tests::{gpu, walls};

/// Relative rounding of a half float.
const HALF: f32 = 1.0 / 2048.0;

/// Bound for a method with 16-bit targets: every one of `n` additions and the stored T round once, values ≤ `peak`.
fn half_bound(n: usize, peak: f32) -> f32 {
    (n as f32 + 2.0) * HALF * peak
}

/// Bound for moments in 32 bits against 64: rounding of the moments (2⁻²⁴ each) is divided by the smallest pivot that the
/// bias of 5e−7 leaves (about 2e−7 for coinciding points), and the root of a polynomial answers with its square
/// root; as a colour error far below what the method itself errs by.
const MOMENTS: f32 = 2e-2;

/// What a pixel must show; `half` says which of a wall's two triangles covers it.
fn twin(spec: &MethodSpec, f: &[Fragment], c0: [f32; 3], pixel: [u32; 2], half: u32) -> [f32; 3] {
    // The walls are flat: their boxes span just the fragments' depths.
    let warp = || {
        let depths = f.iter().map(|f| f64::from(f.depth));
        let near = depths.clone().fold(f64::INFINITY, f64::min);
        DepthWarp::new(near, depths.fold(0.0, f64::max))
    };
    let size = spec.size();
    match spec.name() {
        // The walls neither intersect nor overlap in a cycle.
        "abuffer" | "linked-list" | "depth-peel" | "dual-peel" | "painter-object"
        | "painter-triangle" => over::composite(f, c0),
        "weighted-sum" => weighted_sum::composite(f, c0),
        "weighted-average" => weighted_average::composite(f, c0),
        "blended" => blended::composite(f, c0),
        "mboit4" => mboit4::composite(f, c0, &warp(), &mboit4::Settings::PAPER),
        "mboit6" => mboit6::composite(f, c0, &warp(), &mboit6::PAPER),
        "wavelet-3" => wavelet::composite(f, c0, &warp(), true),
        "kbuffer" => kbuffer::composite(f, c0, size as usize, None),
        "hybrid" => kbuffer::composite(f, c0, size as usize, Some(Weight::Eq9)),
        "stochastic" => {
            let mut f = f.to_vec();
            for (f, wall) in f.iter_mut().zip(0..) {
                f.triangle = 2 * wall + half;
            }
            stochastic::composite(&f, c0, size, pixel)
        }
        name => {
            let weight = Weight::ALL
                .into_iter()
                .find(|w| name == format!("wboit-{}", w.name()))
                .unwrap_or_else(|| panic!("method {name} has no twin in this test: add it"));
            wboit::composite(f, c0, weight)
        }
    }
}

/// The window depth that the test camera gives to depth z.
fn with_window_depth(mut f: Vec<Fragment>) -> Vec<Fragment> {
    let camera = peelnet_tests::camera();
    for f in &mut f {
        let clip = camera.clip_from_view(1.0) * glam::Vec4::new(0.0, 0.0, -f.depth, 1.0);
        f.window_depth = clip.z / clip.w;
    }
    f
}

fn cases() -> Vec<(&'static str, Vec<Fragment>)> {
    let rainbow = |n: usize, alpha: f32| {
        (0..n)
            .map(|i| {
                let t = i as f32 / n as f32;
                Fragment::new(1.0 + 3.0 * t, alpha, [t, 1.0 - t, (7.0 * t).fract()])
            })
            .collect()
    };
    vec![
        ("nothing", vec![]),
        ("one", vec![Fragment::new(3.0, 0.5, [0.2, 0.4, 0.8])]),
        ("worked example", worked_example().to_vec()),
        ("reversed", worked_example().into_iter().rev().collect()),
        ("alpha zero", vec![Fragment::new(2.0, 0.0, [1.0; 3])]),
        (
            "opaque in the middle",
            vec![
                Fragment::new(1.0, 0.25, [1.0, 0.0, 0.0]),
                Fragment::new(2.0, 1.0, [0.0, 1.0, 0.0]),
                Fragment::new(3.0, 0.5, [0.0, 0.0, 1.0]),
            ],
        ),
        ("nine", rainbow(9, 0.3)),
        ("forty", rainbow(40, 0.2)),
    ]
}

#[test]
fn every_method_agrees_with_its_twin() {
    let gpu = gpu();
    let c0 = [0.25, 0.5, 0.75];
    for (case, fragments) in cases() {
        let fragments = with_window_depth(fragments);
        let scene = walls(&fragments, c0);
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        for spec in MethodSpec::all() {
            let mut variants = vec![spec.clone()];
            if spec.entry().knobs().any(|(k, _)| k == "targets") {
                variants.push(format!("{spec}:targets=f32").parse().unwrap());
            }
            for spec in variants {
                let mut prepared = renderer.prepare(&spec, [5, 3], None).unwrap();
                let frame = renderer.draw(&mut prepared, &scene.views[0]).unwrap();
                let bound = if spec.entry().exact {
                    peelnet_core::tolerance::EXACT as f32
                } else if spec.name().starts_with("mboit") {
                    MOMENTS
                } else if spec.to_string().ends_with("f32") {
                    // Shaders may contract or reorder; divisions and pow are allowed 2.5 and 16 units: 1e-4 is 800 units.
                    1e-4
                } else {
                    // Weighted sums reach 3000 before they are divided by a sum of the same size: relative.
                    half_bound(fragments.len(), 3.0)
                };
                for (p, i) in frame.image.pixels.iter().zip(0..) {
                    // Walls are similar: all of a pixel's fragments lie in the same half.
                    let wants =
                        [0, 1].map(|half| twin(&spec, &fragments, c0, [i % 5, i / 5], half));
                    assert!(
                        wants
                            .iter()
                            .any(|want| (0..3).all(|k| (p[k] - want[k]).abs() <= bound)),
                        "{case}, {spec}: {p:?} instead of {wants:?} (bound {bound})"
                    );
                }
                if fragments.is_empty() {
                    assert_eq!(frame.image.pixels[7][..3], c0, "{spec} keeps C_0");
                }
                assert_eq!(frame.stats.lost, 0, "{case}, {spec}");
            }
        }
    }
}

/// Peeling's known flaw and its remedy: of coplanar walls dual peeling keeps one of two an end and says so, while the
/// S-buffer and single peeling keep all.
#[test]
fn coplanar_walls() {
    let gpu = gpu();
    let c0 = [1.0; 3];
    let fragments: Vec<_> = (0..3)
        .map(|i| {
            let mut color = [0.0; 3];
            color[i] = 1.0;
            Fragment {
                triangle: i as u32,
                ..Fragment::new(2.0, 0.5, color)
            }
        })
        .collect();
    let scene = walls(&fragments, c0);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let want = over::composite(&fragments, c0);
    for (name, lost) in [
        ("abuffer", 0),
        ("linked-list", 0),
        ("depth-peel", 0),
        ("dual-peel", 2),
        ("kbuffer-3", 0),
        ("hybrid-5", 0),
    ] {
        let spec: MethodSpec = name.parse().unwrap();
        let mut prepared = renderer.prepare(&spec, [4, 4], None).unwrap();
        let frame = renderer.draw(&mut prepared, &scene.views[0]).unwrap();
        if let Some(fragments) = frame.stats.fragments {
            assert_eq!(fragments, 48, "{name}");
        }
        assert_eq!(frame.stats.lost, lost * 16, "{name}");
        if lost == 0 {
            for (got, want) in frame.image.pixels[5].iter().zip(want) {
                assert!((got - want).abs() < 1e-6, "{name}");
            }
        }
    }
}

/// A capped run leaves out what it did not reach, and counts it.
#[test]
fn a_capped_peel_counts_what_it_left_out() {
    let gpu = gpu();
    let fragments: Vec<_> = (1..=9)
        .map(|i| Fragment::new(i as f32, 0.25, [0.5; 3]))
        .collect();
    let scene = walls(&fragments, [0.0; 3]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    for (name, left) in [("depth-peel:passes=4", 5), ("dual-peel:passes=3", 3)] {
        let spec: MethodSpec = name.parse().unwrap();
        let mut prepared = renderer.prepare(&spec, [2, 2], None).unwrap();
        let frame = renderer.draw(&mut prepared, &scene.views[0]).unwrap();
        assert_eq!(frame.stats.lost, left * 4, "{name}");
    }
}

/// A pool that is too small is made larger: every fragment is there, the second frame needs no second pass, and enough places
/// make the k-buffers exact.
#[test]
fn bounded_storage_loses_nothing() {
    let gpu = gpu();
    let c0 = [0.3, 0.6, 0.9];
    let fragments: Vec<_> = (0..40)
        .map(|i| {
            let t = (i * 17 % 40) as f32;
            Fragment::new(1.0 + t, 0.1, [t / 40.0, 0.5, 1.0 - t / 40.0])
        })
        .collect();
    let scene = walls(&fragments, c0);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let want = over::composite(&fragments, c0);
    for (name, passes) in [
        ("linked-list:nodes=1", [2, 1]),
        ("linked-list:nodes=500", [2, 1]),
        ("kbuffer-40", [2, 2]),
        ("hybrid-64", [2, 2]),
    ] {
        let spec: MethodSpec = name.parse().unwrap();
        let mut prepared = renderer.prepare(&spec, [5, 4], None).unwrap();
        for passes in passes {
            let frame = renderer.draw(&mut prepared, &scene.views[0]).unwrap();
            assert_eq!(frame.stats.geometry_passes, passes, "{name}");
            for p in &frame.image.pixels {
                for k in 0..3 {
                    let error = (p[k] - want[k]).abs();
                    assert!(
                        error <= peelnet_core::tolerance::EXACT as f32,
                        "{name}: {p:?}"
                    );
                }
            }
        }
    }
}

/// Sorting by object fails where one object reaches through another, sorting by triangle where triangles intersect; the
/// scene's order fails at once.
#[test]
fn painters_have_their_known_flaw() {
    let gpu = gpu();
    let front = Fragment::new(2.0, 0.5, [1.0, 0.0, 0.0]);
    let back = Fragment::new(3.0, 0.5, [0.0, 0.0, 1.0]);
    let scene = walls(&[front, back], [0.0; 3]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let draw = |renderer: &Renderer<'_>, scene: &peelnet_scene::Scene, name: &str| {
        let mut prepared = renderer
            .prepare(&name.parse().unwrap(), [4, 4], None)
            .unwrap();
        renderer
            .draw(&mut prepared, &scene.views[0])
            .unwrap()
            .image
            .pixels
    };
    // Nearest first is the wrong order for over-blending: the back wall lies on top.
    let unsorted = draw(&renderer, &scene, "painter-object:sort=off")[5];
    assert!((unsorted[0] - 0.25).abs() < 1e-3 && (unsorted[2] - 0.5).abs() < 1e-3);
    let sorted = draw(&renderer, &scene, "painter-object")[5];
    assert!((sorted[0] - 0.5).abs() < 1e-3 && (sorted[2] - 0.25).abs() < 1e-3);
    // One object with a red wall before and one far behind the blue one: its centre lies behind it.
    let mut joined = scene.clone();
    let far = walls(&[Fragment::new(5.0, 0.5, front.color)], [0.0; 3])
        .objects
        .remove(0);
    let near = &mut joined.objects[0];
    let offset = near.world_from_object.inverse() * far.world_from_object;
    let mut both = (*near.mesh).clone();
    let first = both.positions.len() as u32;
    for (p, n) in far.mesh.positions.iter().zip(&far.mesh.normals) {
        both.positions.push(offset.transform_point3(*p));
        both.normals.push(*n);
    }
    for t in &far.mesh.triangles {
        both.triangles.push(t.map(|i| i + first));
    }
    both.parts[0].triangles.end = both.triangles.len();
    near.mesh = both.into();
    let renderer = Renderer::new(&gpu, &joined).unwrap();
    let error = |name: &str| {
        let exact = draw(&renderer, &joined, "abuffer");
        let got = draw(&renderer, &joined, name);
        let pairs = exact.iter().zip(&got);
        pairs.map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max)
    };
    // Blue over red instead of red over blue over red: 0.375 instead of 0.625 of red.
    assert!((error("painter-object") - 0.25).abs() < 1e-3);
    assert!(error("painter-triangle") < 1e-3);
}

/// Opaque walls hide what is behind them, for every method.
#[test]
fn opaque_walls_hide() {
    let gpu = gpu();
    let mut opaque = peelnet_scene::Material::unlit([0.1, 0.6, 0.3], 1.0);
    opaque.blend = false;
    let front = [Fragment::new(1.0, 0.5, [1.0, 0.0, 0.0])];
    let mut scene = walls(&front, [0.0; 3]);
    scene.objects.push(peelnet_tests::wall(2.0, opaque));
    scene.objects.push(peelnet_tests::wall(
        3.0,
        peelnet_scene::Material::unlit([0.0, 0.0, 1.0], 0.9),
    ));
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let want = over::composite(&front, [0.1, 0.6, 0.3]);
    for spec in MethodSpec::all() {
        let mut prepared = renderer.prepare(&spec, [3, 3], None).unwrap();
        let frame = renderer.draw(&mut prepared, &scene.views[0]).unwrap();
        for k in 0..3 {
            let got = frame.image.pixels[4][k];
            assert!(
                (got - want[k]).abs() <= half_bound(1, 1.0),
                "{spec}: {got} {want:?}"
            );
        }
    }
}
