//! Every method × stacked walls, whose every pixel holds known fragments: the GPU against the CPU twin that the method declares.

use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{Fragment, worked_example},
    methods::over,
};
use peelnet_model::Model;
use peelnet_render::{
    Frame, METHODS, MethodOptions, MethodSpec, Renderer,
    methods::{Pixel, Precision},
};
use peelnet_tests::{gpu, network_of, walls};

/// Relative rounding of a half float.
const HALF: f32 = 1.0 / 2048.0;

/// Bound for a method with 16-bit targets: every one of `n` additions and the stored T round once, values ≤ `peak`.
fn half_bound(n: usize, peak: f32) -> f32 {
    (n as f32 + 2.0) * HALF * peak
}

/// Bound for moments in 32 bits against 64. Of four, where layers are apart, they err by some roundings; of more, points are cosines and
/// roots of cubics, good to 1e-5 each, and what lies at them is divided by pivots down to 1e-3. `constants.rs` has cases on the scale of
/// the bias, where a tenth of it shows.
const MOMENTS: f32 = 2e-4;

/// The largest difference between a frame of `n` layers and the twin; `None` where the error of 16-bit statistics has no simple
/// bound, because roots of them are taken.
fn bound(spec: &MethodSpec, n: usize) -> Option<f32> {
    let promises = spec.promises();
    match (promises.root, promises.statistics, promises.sums) {
        _ if promises.exact => Some(peelnet_core::tolerance::EXACT as f32),
        (Some(_), Precision::Half, _) => None,
        (Some(_), Precision::Full, Precision::Full) => Some(MOMENTS),
        (Some(_), Precision::Full, Precision::Half) => Some(MOMENTS + half_bound(n, 1.0)),
        // Shaders may contract or reorder; divisions and pow are allowed 2.5 and 16 units: 1e-4 is 800 units.
        (None, _, Precision::Full) => Some(1e-4),
        // Weighted sums reach 3000 before they are divided by a sum of the same size: relative.
        (None, _, Precision::Half) => Some(half_bound(n, 3.0)),
    }
}

/// What a pixel must show; `half` says which of a wall's two triangles covers it.
fn twin(
    spec: &MethodSpec,
    model: Option<&Model>,
    stack: &Stack,
    position: [u32; 2],
    half: u32,
) -> Option<[f32; 3]> {
    let mut fragments = stack.fragments.clone();
    for (f, wall) in fragments.iter_mut().zip(0..) {
        f.triangle = 2 * wall + half;
    }
    // The walls are flat: their boxes span just the fragments' depths.
    let depths = || fragments.iter().map(|f| f64::from(f.depth));
    let near = depths().fold(f64::INFINITY, f64::min);
    spec.twin(&Pixel {
        fragments: &fragments,
        background: stack.background,
        warp: DepthWarp::new(near, depths().fold(0.0, f64::max)),
        position,
        model,
    })
}

/// Walls one behind the other.
struct Stack {
    name: &'static str,
    fragments: Vec<Fragment>,
    background: [f32; 3],
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

/// The thesis's reference, which no benchmark draws unasked.
const THESIS_REFERENCE: &str = "dual-peel:passes=4,colors=f16";

/// Every method with every point of its curve, and in 32 bits where it has the choice.
fn specs() -> Vec<MethodSpec> {
    let mut all = MethodSpec::compared();
    all.push(THESIS_REFERENCE.parse().unwrap());
    for spec in MethodSpec::compared() {
        if spec.method().has_targets() && spec.targets().is_none() {
            all.push(spec.with("targets", "f32").unwrap());
        }
    }
    all
}

#[test]
fn every_method_agrees_with_its_twin() {
    let gpu = gpu();
    let networks: Vec<_> = METHODS
        .iter()
        .map(|m| network_of(&MethodSpec::representative(m)))
        .collect();
    for (name, fragments) in cases() {
        let stack = Stack {
            name,
            fragments: with_window_depth(fragments),
            background: [0.25, 0.5, 0.75],
        };
        let scene = walls(&stack.fragments, stack.background);
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        let drawn = METHODS.iter().zip(&networks);
        for (method, network) in drawn.filter(|(m, _)| m.cpu_only.is_none()) {
            for spec in specs().iter().filter(|s| s.name() == method.name) {
                let learned = network.as_ref().map(|(text, _)| text);
                let mut prepared = renderer
                    .method(spec, MethodOptions::sized(SIZE).with(learned))
                    .unwrap();
                let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
                compare(
                    spec,
                    network.as_ref().map(|(_, model)| model),
                    &stack,
                    &frame,
                );
            }
        }
    }
}

const SIZE: [u32; 2] = [5, 3];

fn compare(spec: &MethodSpec, model: Option<&Model>, stack: &Stack, frame: &Frame) {
    let Stack {
        name,
        fragments,
        background,
    } = stack;
    if fragments.is_empty() {
        assert_eq!(frame.image.pixels[7][..3], *background, "{spec} keeps C_0");
    }
    // A peel that is capped counts what it leaves out.
    if spec.promises().exact || !spec.method().is_exact() {
        assert_eq!(frame.stats.lost, 0, "{name}, {spec}");
    }
    let Some(bound) = bound(spec, fragments.len()) else {
        return;
    };
    for (p, i) in frame.image.pixels.iter().zip(0..) {
        let position = [i % SIZE[0], i / SIZE[0]];
        // Walls are similar: all of a pixel's fragments lie in the same half.
        let wants = [0, 1].map(|half| twin(spec, model, stack, position, half));
        let [Some(first), Some(second)] = wants else {
            return;
        };
        let near = |want: [f32; 3]| (0..3).all(|k| (p[k] - want[k]).abs() <= bound);
        assert!(
            near(first) || near(second),
            "{name}, {spec}: {p:?} instead of {wants:?} (bound {bound})"
        );
    }
}

/// Every method has a twin, with its default parameters and in 32 bits, and a bound on the difference in at least one precision.
#[test]
fn every_method_has_a_twin() {
    let stack = Stack {
        name: "worked example",
        fragments: worked_example().to_vec(),
        background: [0.0; 3],
    };
    for method in METHODS {
        let default = MethodSpec::representative(method);
        let network = network_of(&default);
        let model = network.as_ref().map(|(_, model)| model);
        let all = specs();
        let own = || all.iter().filter(|s| s.name() == method.name);
        assert!(own().any(|s| bound(s, 4).is_some()), "{}", method.name);
        // A list has no boxes: `ranges.rs` tests those that need some.
        let of_boxes = |s: &MethodSpec| s.to_string().contains("range=boxes");
        for spec in own()
            .chain([&default])
            .filter(|s| !s.is_scaled() && !of_boxes(s))
        {
            let color = twin(spec, model, &stack, [0, 0], 0);
            assert!(
                color.is_some_and(|c| c.iter().all(|x| x.is_finite())),
                "{spec}"
            );
        }
    }
}

/// Of coincident walls every method that is exact there keeps all, in the order of their triangles: coincident in front, behind and
/// alone, of colours whose maximum by channel is none of them.
#[test]
fn coplanar_walls() {
    let gpu = gpu();
    let c0 = [1.0; 3];
    let three = |depth: f32| {
        (0..3).map(move |i| {
            let mut color = [0.0; 3];
            color[i] = 1.0;
            Fragment::new(depth, 0.5, color)
        })
    };
    let one = |depth: f32| std::iter::once(Fragment::new(depth, 0.25, [0.4, 0.2, 0.1]));
    let stacks: [Vec<Fragment>; 4] = [
        three(2.0).collect(),
        three(2.0).chain(one(3.0)).chain(three(4.0)).collect(),
        one(1.0).chain(three(2.0)).chain(one(3.0)).collect(),
        three(2.0).chain(three(4.0)).chain(three(3.0)).collect(),
    ];
    for mut fragments in stacks {
        for (f, i) in fragments.iter_mut().zip(0..) {
            f.triangle = i;
        }
        let scene = walls(&fragments, c0);
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        let want = over::composite(&over::sorted(&fragments), c0);
        for name in [
            "abuffer",
            "linked-list",
            "depth-peel",
            "dual-peel",
            "kbuffer-9",
            "hybrid-12",
        ] {
            let spec: MethodSpec = name.parse().unwrap();
            let mut prepared = renderer
                .method(&spec, MethodOptions::sized([4, 4]))
                .unwrap();
            let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
            if let Some(found) = frame.stats.fragments {
                assert_eq!(found, 16 * fragments.len() as u64, "{name}");
            }
            assert_eq!(frame.stats.lost, 0, "{name}");
            for (got, want) in frame.image.pixels[5].iter().zip(want) {
                let error = f64::from((got - want).abs());
                let bound = peelnet_core::tolerance::composite(fragments.len(), 1.0);
                assert!(error <= bound, "{name}: {got} for {want}");
            }
        }
    }
}

/// An opaque silhouette inside smoke: all layers have one colour, so every normalised method, whatever its weights, shows
/// `c (1 − (1−α)^k) + S (1−α)^k` behind k layers, and nothing of what lies behind the silhouette.
#[test]
fn a_silhouette_in_smoke_is_exact() {
    const LAYERS: i32 = 30;
    const ALPHA: f32 = 0.06;
    const SILHOUETTE: [f32; 3] = [0.1, 0.02, 0.3];
    let (gpu, smoke) = (gpu(), [0.7, 0.75, 0.8]);
    for inside in [0, 7, 18, 30] {
        let mut fragments: Vec<_> = (0..LAYERS)
            .map(|i| Fragment::new(2.0 + 0.2 * i as f32, ALPHA, smoke))
            .collect();
        fragments.push(Fragment::new(1.9 + 0.2 * inside as f32, 1.0, SILHOUETTE));
        let mut scene = walls(&fragments, [1.0, 0.5, 0.0]);
        let silhouette = scene.objects.last_mut().unwrap();
        silhouette.materials[0].blend = false;
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        let t = (1.0 - ALPHA).powi(inside);
        let drawn = METHODS.iter().filter(|m| m.cpu_only.is_none());
        for method in drawn {
            let spec = MethodSpec::representative(method);
            // Random samples hit their mean only in the mean.
            if !spec.promises().normalised || spec.promises().noisy {
                continue;
            }
            let network = network_of(&spec);
            let learned = network.as_ref().map(|(text, _)| text);
            let options = MethodOptions::sized([4, 4]).with(learned);
            let mut prepared = renderer.method(&spec, options).unwrap();
            let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
            // Of one colour, half floats round sums of absorbance and of colour only: no root is magnified.
            let layers = LAYERS as usize;
            let bound = bound(&spec, layers).unwrap_or(half_bound(layers, 1.0));
            for k in 0..3 {
                let want = smoke[k] * (1.0 - t) + SILHOUETTE[k] * t;
                let got = frame.image.pixels[5][k];
                assert!(
                    (got - want).abs() <= bound,
                    "{spec}, {inside}: {got} for {want}"
                );
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
        let mut prepared = renderer
            .method(&spec, MethodOptions::sized([2, 2]))
            .unwrap();
        let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
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
        let mut prepared = renderer
            .method(&spec, MethodOptions::sized([5, 4]))
            .unwrap();
        for passes in passes {
            let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
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
    let draw = |renderer: &Renderer, scene: &peelnet_scene::Scene, name: &str| {
        let mut prepared = renderer
            .method(&name.parse().unwrap(), MethodOptions::sized([4, 4]))
            .unwrap();
        renderer
            .image(&mut prepared, &scene.views[0])
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
        let mut prepared = renderer
            .method(&spec, MethodOptions::sized([3, 3]))
            .unwrap();
        let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
        for k in 0..3 {
            let got = frame.image.pixels[4][k];
            assert!(
                (got - want[k]).abs() <= half_bound(1, 1.0),
                "{spec}: {got} {want:?}"
            );
        }
    }
}

/// The biases that go with the precision of the moments, as the paper and `peelnet_core` state them.
#[test]
fn biases_go_with_the_precision() {
    let points = [(0.5, 0.3), (2.0, 0.6), (2.01, 0.4), (7.0, 0.5)];
    let warp = DepthWarp::new(0.5, 10.0);
    let estimate = |name: &str| {
        let spec: MethodSpec = name.parse().unwrap();
        spec.transmittances(&points, &warp, None).unwrap()
    };
    for (method, targets, bias) in [
        ("mboit4", "f32", 5e-7),
        ("mboit4", "f16", 6e-5),
        ("mboit6", "f32", 5e-6),
        ("mboit6", "f16", 6e-4),
        ("mboit8", "f32", 5e-5),
        ("mboit8", "f16", 2.5e-3),
        ("mboit-trig-2", "f32", 1e-4),
        ("mboit-trig-2", "f16", 1e-3),
    ] {
        let with = |bias: f64| {
            estimate(&format!(
                "{method}:targets={targets},bias={bias},overestimation=0.25"
            ))
        };
        let default = estimate(&format!("{method}:targets={targets}"));
        assert_eq!(default, with(bias), "{method} in {targets}");
        assert_ne!(default, with(1.1 * bias), "{method} in {targets}");
    }
}
