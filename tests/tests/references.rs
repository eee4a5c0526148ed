//! The GPU draws what the CPU references compute: every method, on lists of fragments from three sources.
//!
//! Closed forms and random lists are drawn side by side in one frame and compared with the reference that each method declares; stress cases are
//! those of `peelnet stress`, judged by the properties that methods guarantee, and a known failure must keep failing. One representative of
//! every method runs in `cargo xtask test`, every point of every method's curve in `cargo xtask test --all`.

use glam::Vec3;
use peelnet_bench::stress::{CASES, Outcome, Property, Row, Subject, stress};
use peelnet_core::{
    fragment::{Fragment, worked_example},
    mlp::Layer,
    random::Random,
};
use peelnet_render::{
    LearnedWeight, METHODS, MethodSpec, Renderer,
    methods::{Pixel, Precision},
};
use peelnet_scene::{Material, Scene};
use peelnet_tests::{
    gpu, half_sums, network_of, object, prepare, quad, representatives, scene, window_depth,
};
use std::{
    collections::BTreeMap,
    env,
    fs::File,
    io::{self, Seek as _, Write as _},
    path::Path,
};

/// Bound for moments in 32 bits against 64. Of four, where layers are apart, they err by some roundings; of more, points are cosines and
/// roots of cubics, good to 1e-5 each, and what lies at them is divided by pivots down to 1e-3.
const MOMENTS: f32 = 2e-4;

/// The same for random lists. Of few layers more than four moments are nearly singular, pivots are the bias itself, 5e-6 to 1e-4, and roundings of
/// 6e-8 show as up to 1e-3 (seen on llvmpipe): twice that.
const MOMENTS_OF_RANDOM_LISTS: f32 = 2e-3;

/// Bound for sums in 32 bits. Shaders may contract or reorder; divisions and pow are allowed 2.5 and 16 units: 1e-4 is 800 units.
const FULL: f32 = 1e-4;

/// The largest difference between a pixel of `n` layers and the reference, where moments may err by `moments`; `None` where the error of 16-bit statistics has no simple
/// bound, because roots of them are taken.
fn bound(spec: &MethodSpec, n: usize, moments: f32) -> Option<f32> {
    let guarantees = spec.guarantees();
    match (guarantees.root, guarantees.statistics, guarantees.sums) {
        _ if guarantees.exact => Some(peelnet_core::tolerance::EXACT as f32),
        (Some(_), Precision::Half, _) => None,
        (Some(_), Precision::Full, Precision::Full) => Some(moments),
        (Some(_), Precision::Full, Precision::Half) => Some(moments + half_sums(n, 1.0)),
        (None, _, Precision::Full) => Some(FULL),
        // Weighted sums reach 3000 before they are divided by a sum of the same size: relative.
        (None, _, Precision::Half) => Some(half_sums(n, 3.0)),
    }
}

/// Every method with every point of its curve, in 32 bits where it has the choice, and the thesis's reference, which no benchmark draws
/// unasked.
fn all_specs() -> Vec<MethodSpec> {
    let mut all = MethodSpec::curve();
    for spec in MethodSpec::curve() {
        if spec.method().has_targets() && spec.targets().is_none() {
            all.push(spec.with("targets", "f32").unwrap());
        }
    }
    all.push("dual-peel:passes=4,colors=f16".parse().unwrap());
    all
}

/// Lists whose colours are known by hand, or that break formulas.
fn closed_forms() -> Vec<Vec<Fragment>> {
    let rainbow = |n: usize, alpha: f32| -> Vec<Fragment> {
        let layer = |i: usize| {
            let t = i as f32 / n as f32;
            Fragment::new(1.0 + 3.0 * t, alpha, [t, 1.0 - t, (7.0 * t).fract()])
        };
        (0..n).map(layer).collect()
    };
    vec![
        vec![],
        vec![Fragment::new(3.0, 0.5, [0.2, 0.4, 0.8])],
        worked_example().to_vec(),
        worked_example().into_iter().rev().collect(),
        vec![Fragment::new(2.0, 0.0, [1.0; 3])],
        // Opaque in the middle.
        vec![
            Fragment::new(1.0, 0.25, [1.0, 0.0, 0.0]),
            Fragment::new(2.0, 1.0, [0.0, 1.0, 0.0]),
            Fragment::new(3.0, 0.5, [0.0, 0.0, 1.0]),
        ],
        rainbow(9, 0.3),
        rainbow(40, 0.2),
    ]
}

/// How much farther than any other a fragment of a random list lies at least: of nearly coincident ones, 32-bit moments lose their bias. Hard
/// cases have them.
const APART: f32 = 1.1;

/// Lists of one to fourteen fragments anywhere in the depths, of all opacities, and such as have one on either side of what counts as opaque.
fn random_lists() -> Vec<Vec<Fragment>> {
    let mut random = Random::new(23, &[]);
    let mut list = |first: Option<Fragment>, n: usize, alpha: [f32; 2]| -> Vec<Fragment> {
        let mut list: Vec<Fragment> = first.into_iter().collect();
        while list.len() < n {
            let depth = random.log_between(1.0, 50.0);
            let f = Fragment::new(depth, random.between(alpha[0], alpha[1]), random.color());
            let is_apart = |o: &Fragment| (f.depth / o.depth).max(o.depth / f.depth) > APART;
            if list.iter().all(is_apart) {
                list.push(f);
            }
        }
        list
    };
    let mut all: Vec<_> = (0..30)
        .map(|i| list(None, 1 + i % 6, [0.05, 0.95]))
        .collect();
    all.extend((0..6).map(|_| list(None, 4, [0.01, 0.2])));
    all.extend((0..8).map(|i| list(None, 7 + i, [0.02, 0.5])));
    for alpha in [0.985, 0.995, 1.0] {
        for depth in [2.0, 8.0] {
            let opaque = Fragment::new(depth, alpha, [0.9, 0.1, 0.5]);
            all.push(list(Some(opaque), 4, [0.3, 0.6]));
        }
    }
    all
}

/// Pixels that a list covers: three blocks of voxels wide, so that all that a method mixes with the pixels of the middle block is the same list.
const REGION: [u32; 2] = [24, 8];

/// Pixels of a region that are compared, in the middle block and the lower of the two triangles of its quads.
const COMPARED: [[u32; 2]; 4] = [[9, 6], [10, 6], [13, 7], [15, 6]];

/// One frame with a region for every list.
struct Frame {
    scene: Scene,
    size: [u32; 2],
    lists: Vec<Vec<Fragment>>,
}

impl Frame {
    fn new(mut lists: Vec<Vec<Fragment>>) -> Self {
        let size = [REGION[0] * lists.len() as u32, REGION[1]];
        let [width, height] = size.map(|n| n as f32);
        let mut objects = Vec::new();
        for (list, i) in lists.iter_mut().zip(0..) {
            let [left, right] = [i, i + 1].map(|k| 2.0 * (REGION[0] * k) as f32 / width - 1.0);
            for f in list {
                (f.triangle, f.window_depth) = (2 * objects.len() as u32, window_depth(f.depth));
                // The frame is 90° high: half its height at depth z is z.
                let v = |x: f32, y: f32| Vec3::new(x * width / height, y, -1.0) * f.depth;
                let corners = [v(left, -1.0), v(right, -1.0), v(right, 1.0), v(left, 1.0)];
                let material = Material::unlit(f.color, f.alpha);
                objects.push(object(&quad(corners), material));
            }
        }
        Self {
            scene: scene("lists", [0.25, 0.5, 0.75], objects),
            size,
            lists,
        }
    }

    /// What is wrong with a method's frame, a line each; empty where nothing is.
    fn problems(&self, renderer: &Renderer, spec: &MethodSpec, moments: f32) -> Vec<String> {
        let view = &self.scene.views[0];
        let model = network_of(spec).map(|(_, model)| model);
        let mut prepared = prepare(renderer, spec, self.size);
        let frame = renderer.image(&mut prepared, view).unwrap();
        let mut problems = Vec::new();
        // A peel that is capped counts what it leaves out.
        if (spec.guarantees().exact || !spec.method().is_exact()) && frame.stats.lost > 0 {
            problems.push(format!("{spec}: {} fragments are lost", frame.stats.lost));
        }
        for (fragments, region) in self.lists.iter().zip(0..) {
            let bound = match bound(spec, fragments.len(), moments) {
                // Nothing is drawn, nothing is rounded.
                _ if fragments.is_empty() => 0.0,
                Some(bound) => bound,
                None => continue,
            };
            for [x, y] in COMPARED {
                let position = [x + region * REGION[0], y];
                let want = spec.reference(&Pixel {
                    fragments,
                    background: self.scene.background,
                    warp: renderer.depth_warp(view),
                    position,
                    model: model.as_ref(),
                });
                let Some(want) = want else { continue };
                let p = frame.image.pixels[(position[1] * self.size[0] + position[0]) as usize];
                // Written so that a NaN is a problem.
                if !(0..3).all(|k| (p[k] - want[k]).abs() <= bound) {
                    problems.push(format!(
                        "{spec}, list {region} of {}: {p:?} instead of {want:?}, bound {bound:e}",
                        fragments.len()
                    ));
                }
            }
        }
        problems
    }
}

fn compare(lists: Vec<Vec<Fragment>>, moments: f32, specs: &[MethodSpec]) {
    let frame = Frame::new(lists);
    let renderer = Renderer::new(&gpu(), &frame.scene).unwrap();
    let problems = |spec| frame.problems(&renderer, spec, moments);
    let problems: Vec<String> = specs.iter().flat_map(problems).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn closed_forms_of_representatives() {
    compare(closed_forms(), MOMENTS, &representatives());
}

#[test]
fn random_lists_of_representatives() {
    compare(random_lists(), MOMENTS_OF_RANDOM_LISTS, &representatives());
}

#[test]
#[ignore = "long: cargo xtask test --all"]
fn closed_forms_of_all_methods() {
    compare(closed_forms(), MOMENTS, &all_specs());
}

#[test]
#[ignore = "long: cargo xtask test --all"]
fn random_lists_of_all_methods() {
    compare(random_lists(), MOMENTS_OF_RANDOM_LISTS, &all_specs());
}

/// Every method has a reference, and a bound on the difference in at least one precision: nothing above is skipped in silence.
#[test]
fn every_method_has_a_reference() {
    let specs = all_specs();
    for method in METHODS.iter().filter(|m| m.cpu_only.is_none()) {
        let own = || specs.iter().filter(|s| s.name() == method.name);
        let is_bounded = own().any(|s| bound(s, 4, MOMENTS).is_some());
        assert!(is_bounded, "{}", method.name);
        // A list has no boxes: `ranges` tests what depends on them.
        let has_boxes = |s: &MethodSpec| s.to_string().contains("range=boxes");
        // `tiles` tests what depends on the pixels around.
        let has_range = || method.parameters.iter().any(|p| p.name == "range");
        // `splats` does, of what always depends on them.
        let always_looks = method.name == "splat";
        let looks_around =
            |s: &MethodSpec| always_looks || has_range() && !s.to_string().contains("range=frame");
        let of_pixels = own().filter(|s| !s.is_scaled() && !has_boxes(s) && !looks_around(s));
        for spec in of_pixels {
            let model = network_of(spec).map(|(_, model)| model);
            let color = spec.reference(&Pixel {
                fragments: &worked_example(),
                background: [0.0; 3],
                warp: peelnet_core::absorbance::DepthWarp::new(1.0, 8.0),
                position: [0, 0],
                model: model.as_ref(),
            });
            let finite = color.is_some_and(|c| c.iter().all(|x| x.is_finite()));
            assert!(finite, "{spec}");
        }
    }
}

fn stress_case(name: &str, methods: Vec<MethodSpec>) {
    let id = name.replace('_', "-");
    let case = CASES.iter().find(|c| c.id == id).unwrap();
    let subject = |method: &MethodSpec| Subject::new(method.clone(), network_of(method));
    let subjects: Vec<Subject> = methods.iter().map(subject).collect();
    let rows = stress(&gpu(), case, &subjects, true, None, &mut |_| Ok(())).unwrap();
    if env::var_os("PEELNET_UPDATE").is_some() {
        return update_errors(case.id, &rows);
    }
    // Of a method that the list of errors lacks.
    let has_no_limit = |r: &&Row| r.property == Property::Image && r.limit == 255.0;
    let unbounded: Vec<_> = rows.iter().filter(has_no_limit).collect();
    assert!(unbounded.is_empty(), "{unbounded:#?}");
    let failed: Vec<_> = rows.iter().filter(|r| r.result == Outcome::Fail).collect();
    let (count, all) = (failed.len(), rows.len());
    assert!(count == 0, "{count} of {all} rows fail:\n{failed:#?}");
    for s in subjects.iter().filter(|s| case.applies_to(&s.method)) {
        let method = s.method.to_string();
        assert!(rows.iter().any(|r| r.method == method), "{method}");
    }
}

/// Puts what images erred by into the list that limits it. Methods that are not drawn keep theirs.
fn update_errors(case: &str, rows: &[Row]) {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/peelnet_bench/src/stress/errors.txt");
    // Cases run side by side.
    let options = File::options().read(true).write(true).open(path);
    let mut file = options.unwrap();
    file.lock().unwrap();
    let text = io::read_to_string(&file).unwrap();
    let parsed = text.lines().map(|line| {
        let mut words = line.split(' ');
        let case = words.next().unwrap();
        let errors = words.filter_map(|word| word.rsplit_once('='));
        (case, errors.map(|(m, e)| (m, e.to_owned())).collect())
    });
    let mut all: BTreeMap<&str, BTreeMap<&str, String>> = parsed.collect();
    for row in rows.iter().filter(|r| r.property == Property::Image) {
        let error = format!("{:.2}", row.value.unwrap());
        all.entry(case).or_default().insert(&row.method, error);
    }
    let mut text = String::new();
    for (case, errors) in &all {
        text += case;
        errors
            .iter()
            .for_each(|(method, error)| text += &format!(" {method}={error}"));
        text.push('\n');
    }
    file.rewind().unwrap();
    file.set_len(0).unwrap();
    file.write_all(text.as_bytes()).unwrap();
}

/// Networks whose answers are turned about, or made of random numbers, are not let pass as those that ship.
#[test]
fn scrambled_networks_fail() {
    const DRAWN: [&str; 5] = ["apart", "emissive", "intersecting", "passing", "wide-range"];
    for method in METHODS.iter().filter(|m| m.learned) {
        let spec = MethodSpec::representative(method);
        let (network, model) = network_of(&spec).unwrap();
        let [mut negated, mut scrambled] = [model.clone(), model];
        let weights = |layer: &mut Layer, of: &mut dyn FnMut(f32) -> f32| {
            let all = layer.weights.iter_mut().chain(&mut layer.bias);
            all.for_each(|w| *w = of(*w));
        };
        weights(negated.mlp.layers.last_mut().unwrap(), &mut |w| -w);
        let mut random = Random::new(9, &[]);
        for layer in &mut scrambled.mlp.layers {
            weights(layer, &mut |_| random.between(-2.0, 2.0));
        }
        for (what, model) in [("negated", negated), ("random", scrambled)] {
            let wgsl = peelnet_export::wgsl(&model).unwrap();
            let learned = LearnedWeight { wgsl, ..network };
            let subject = Subject::new(spec.clone(), Some((learned, model)));
            let cases = CASES.iter().filter(|c| DRAWN.contains(&c.id));
            let rows = cases.flat_map(|case| {
                stress(
                    &gpu(),
                    case,
                    std::slice::from_ref(&subject),
                    false,
                    None,
                    &mut |_| Ok(()),
                )
                .unwrap()
            });
            let failed = rows.filter(|r| r.result == Outcome::Fail).count();
            // Any weight of the thesis's is a weighted blending, which errs hardly more.
            let least = if spec.name() == "deep-thesis" { 1 } else { 3 };
            assert!(failed >= least, "{spec} {what}: {failed} failures");
        }
    }
}

/// A test for every case, so that they run side by side: with representatives, and with all methods in every precision. `slow` ones are long
/// with representatives, too.
macro_rules! cases {
    (quick: $($quick:ident),*; slow: $($slow:ident),*) => {
        mod representatives_in { $(
            #[test]
            fn $quick() { super::stress_case(stringify!($quick), super::representatives()); }
        )* }
        mod all_methods_in { $(
            #[test]
            #[ignore = "long: cargo xtask test --all"]
            fn $quick() { super::stress_case(stringify!($quick), super::Subject::all_methods()); }
        )* $(
            #[test]
            #[ignore = "long: cargo xtask test --all"]
            fn $slow() { super::stress_case(stringify!($slow), super::Subject::all_methods()); }
        )* }

        #[test]
        fn every_case_has_its_test() {
            let tested = [$(stringify!($quick),)* $(stringify!($slow)),*];
            let tested = tested.map(|name| name.replace('_', "-"));
            assert_eq!(CASES.len(), tested.len());
            assert!(CASES.iter().all(|c| tested.iter().any(|id| id == c.id)));
        }
    };
}

cases! {
    quick:
        alpha_zero, alpha_tiny, alpha_one, alpha_near_one, near_overflow, far, wide_range, coplanar, thin_slab, isolated,
        two_layers, intersecting, grazing, emissive, opaque_mix, lines, empty, half_float, hostile_inputs, passing, moving_camera,
        deep_2000, apart;
    slow:
        high_alpha, deep, deep_20000, deep_100000
}
