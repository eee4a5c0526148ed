//! The learned methods: the exported text against its CPU twin, closed forms, scale, hard cases. All with the shipped
//! networks.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    methods::{
        anchored::{self, Place, Seen},
        over,
    },
    random::Random,
    statistics::{FAR_END, NEAR_END},
};
use peelnet_gpu::{Gpu, bind::Bind, wgpu};
use peelnet_model::{Model, Recipe};
use peelnet_render::{Image, LearnedWeight, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Material, Scene, Texture, suite};
use peelnet_tests::{gpu, shipped, walls};

const ANCHORED: [Recipe; 3] = [Recipe::Small, Recipe::Medium, Recipe::Large];

fn learned(model: &Model) -> LearnedWeight {
    LearnedWeight {
        recipe: model.meta.recipe,
        wgsl: peelnet_export::wgsl(model, &Default::default()).unwrap(),
    }
}

/// Both precisions of a learned method's targets.
fn specs(recipe: Recipe) -> [MethodSpec; 2] {
    ["f16", "f32"].map(|targets| {
        format!("{}:targets={targets}", recipe.method_name())
            .parse()
            .unwrap()
    })
}

fn draw(gpu: &Gpu, scene: &Scene, spec: &MethodSpec, model: &Model, size: [u32; 2]) -> Image {
    let renderer = Renderer::new(gpu, scene).unwrap();
    let mut prepared = renderer
        .method(spec, MethodOptions::sized(size).with(Some(&learned(model))))
        .unwrap();
    renderer
        .image(&mut prepared, &scene.views[0])
        .unwrap()
        .image
}

fn draw_exact(gpu: &Gpu, scene: &Scene) -> Image {
    let renderer = Renderer::new(gpu, scene).unwrap();
    let mut prepared = renderer
        .method(
            &"abuffer".parse().unwrap(),
            MethodOptions::sized([256, 192]),
        )
        .unwrap();
    renderer
        .image(&mut prepared, &scene.views[0])
        .unwrap()
        .image
}

/// Relative rounding of a half float.
const HALF: f64 = 1.0 / 2048.0;

// ---------------------------------------------------------------------------------------------------------------------
// The exported text, function by function.

/// A pixel's fragments as (linear depth, α), in no order.
type Points = Vec<(f32, f32)>;

/// The warp of the pixels below: ζ = ln depth.
fn warp() -> DepthWarp {
    DepthWarp {
        log_near: -1.0,
        scale: 1.0,
    }
}

/// Whether depth and opacity lie within their levels. On the edge between two they may be rounded to either, in 32 bits
/// otherwise than in 64: such values are moved, so that the same fragments are the ends on both sides.
fn within_levels(depth: f32, alpha: f32) -> bool {
    let t = warp().apply(depth.into()) * 0.5 + 0.5;
    let b = absorbance(alpha);
    let opacity = b / (b + 1.0) * 1.0625;
    let levels = [
        t * 61_439.0 + 0.5,
        t * f64::from(NEAR_END.bins),
        t * f64::from(FAR_END.bins),
        opacity * f64::from(NEAR_END.alphas - 1) + 0.5,
        opacity * f64::from(FAR_END.alphas - 1) + 0.5,
    ];
    // A level is 16 roundings of ζ wide at least: a twentieth of it is out of reach of one.
    levels.into_iter().all(|x| (x - x.round()).abs() > 0.05)
}

/// The hard cases as lists: invisible, faint, opaque and nearly opaque, deep, coplanar, thin, pairs, at the range's ends.
fn hard_pixels() -> Vec<Points> {
    let even = |n: usize, alpha: f32| -> Points {
        (0..n)
            .map(|i| ((i as f32 / n as f32 * 1.9 - 0.95).exp(), alpha))
            .collect()
    };
    let at = |layers: &[(f32, f32)]| layers.to_vec();
    let mut all = vec![
        even(3, 0.0),
        at(&[(0.5, 0.0), (0.8, 0.5), (1.9, 0.0)]),
        even(10, 1e-3),
        even(4, 1e-5),
        even(256, 0.005),
        even(6, 1.0),
        at(&[(0.7, 1.0), (1.5, 0.5)]),
        at(&[(0.7, 0.1), (1.5, 1.0)]),
        at(&[(0.6, 0.99), (0.9, 0.999), (1.4, 1.0 - 1.0 / 1_048_576.0)]),
        even(200, 0.9),
        even(300, 0.02),
        even(1024, 0.01),
        (0..256)
            .map(|i| (0.4 + i as f32 * 1e-3, 0.001 + i as f32 / 256.0))
            .collect(),
        (0..8).map(|i| (1.1 + i as f32 * 1e-5, 0.4)).collect(),
        at(&[(1.2, 0.3), (1.2, 0.6), (2.0, 0.3), (2.0, 0.6)]),
    ];
    for n in [2, 3, 16] {
        all.push(vec![(1.3, 0.1); n]);
    }
    for i in 1..=8 {
        all.push(at(&[(1.0, 0.5), ((0.1 * i as f32).exp(), 0.5)]));
    }
    for (depth, alpha) in all.iter_mut().flatten() {
        while !within_levels(*depth, *alpha) {
            *depth *= 1.000_01;
            *alpha *= 0.999_9;
        }
    }
    all
}

/// Pixels of every kind: few and many layers, narrow and wide, faint, opaque, and the hard cases.
fn pixels() -> Vec<Points> {
    let mut random = Random::new(31, &[]);
    let mut point = |from: f32, width: f32, kind: usize| loop {
        let depth = (from + width * random.unit()).min(1.0).exp();
        let alpha = match kind {
            0 => random.between(0.01, 0.2),
            1 => random.between(0.7, 1.0),
            2 => [0.001, 0.3, 1.0][random.below(3)],
            _ => random.between(0.02, 0.98),
        };
        if within_levels(depth, alpha) {
            return (depth, alpha);
        }
    };
    let mut choice = Random::new(32, &[]);
    (0..600)
        .map(|i| {
            let n = [1, 2, 3, 4, 5, 8, 13, 40][i % 8];
            let (from, width) = (choice.between(-1.0, 0.8), choice.between(0.01, 1.9));
            let kind = choice.below(4);
            (0..n).map(|_| point(from, width, kind)).collect()
        })
        .chain(hard_pixels())
        .collect()
}

/// What the exported functions say of a fragment.
#[derive(Clone, Copy)]
struct Answer {
    moments: [f32; 5],
    end: f32,
    in_front: f32,
    features: [f32; 5],
    weight: f32,
}

/// Runs the exported functions over pixels, with targets that add and take maxima as blending does.
fn on_the_gpu(gpu: &Gpu, model: &Model, pixels: &[Points], half: bool) -> Vec<Vec<Answer>> {
    let rounded = if half {
        "vec4f(unpack2x16float(pack2x16float(x.xy)), unpack2x16float(pack2x16float(x.zw)))"
    } else {
        "x"
    };
    let root = format!(
        "import package::learned::weight::{{peelnet_statistics, peelnet_place, peelnet_features, peelnet_fragment}};
        @group(0) @binding(0) var<storage, read> fragments: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
        fn stored(x: vec4f) -> vec4f {{ return {rounded}; }}
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&fragments) {{ return; }}
            let own = fragments[id.x];
            var moments = vec4f(0.0);
            var extent = vec4f(vec3f(-65504.0), 0.0);
            for (var i = u32(own.z); i < u32(own.w); i++) {{
                let s = peelnet_statistics(fragments[i].y, fragments[i].x);
                moments = stored(moments + stored(s.moments));
                let e = stored(s.extent);
                extent = stored(vec4f(max(extent.xyz, e.xyz), extent.w + e.w));
            }}
            let place = peelnet_place(own.y, own.x, moments, extent);
            let f = peelnet_features(place, moments, extent);
            let w = peelnet_fragment(own.y, own.x, moments, extent);
            answers[4u * id.x] = moments;
            answers[4u * id.x + 1u] = vec4f(extent.w, place.end, place.in_front, w.x);
            answers[4u * id.x + 2u] = vec4f(f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low);
            answers[4u * id.x + 3u] = vec4f(f.share_high, 0.0, 0.0, 0.0);
        }}"
    );
    let text = learned(model).wgsl;
    let sources = [("driver", root.as_str()), ("learned::weight", &text)];
    let wgsl = peelnet_shaders::link("driver", &[], &sources).unwrap();
    let mut fragments: Vec<[f32; 4]> = Vec::new();
    for pixel in pixels {
        let first = fragments.len();
        let end = (first + pixel.len()) as f32;
        fragments.extend(pixel.iter().map(|&(z, a)| {
            let zeta = warp().apply(z.into()) as f32;
            [zeta, a, first as f32, end]
        }));
    }
    let input = gpu.upload("fragments", &fragments, wgpu::BufferUsages::STORAGE);
    let bytes = fragments.len() as u64 * 64;
    let output = gpu.storage("answers", bytes).unwrap();
    let bound = gpu.bind(
        "driver",
        wgpu::ShaderStages::COMPUTE,
        &[Bind::Read(&input), Bind::Write(&output)],
    );
    gpu.dispatch(
        "driver",
        &wgsl,
        &bound,
        (fragments.len() as u32).div_ceil(64),
    );
    let rows: Vec<[f32; 16]> = gpu.read(&output, 0..bytes).unwrap();
    let mut rows = rows.into_iter().map(|a| Answer {
        moments: [a[0], a[1], a[2], a[3], a[4]],
        end: a[5],
        in_front: a[6],
        weight: a[7],
        features: [a[8], a[9], a[10], a[11], a[12]],
    });
    pixels
        .iter()
        .map(|p| rows.by_ref().take(p.len()).collect())
        .collect()
}

/// The exported text's statistics, places, features and weights are those of `peelnet_core`, in both precisions of the
/// targets.
///
/// Sums: every one of n additions, and every term, rounds once. Everything else is compared given the GPU's own sums. The
/// features then err by the roundings of differences of those sums, up to a dozen operations deep: by as much as moving the
/// sums by sixteen roundings (2⁻²⁰) in sixteen random directions moves the 64-bit features, times four for what random
/// directions do not show, and ten roundings of the value itself. The bounds' points are roots of a quadratic, whose worst
/// direction random ones may miss: one share, or weight, in 250 may lie outside. Where the moments determine the answer badly, that is wide, and as wide as it is for any renderer.
#[test]
fn the_exported_text_is_the_twin_of_the_core() {
    let gpu = gpu();
    let pixels = pixels();
    let mut random = Random::new(33, &[]);
    for recipe in ANCHORED {
        let model = shipped(recipe);
        let share = |x: &[f64; 9]| model.forward_raw_f64(&x[..model.meta.inputs.len()])[0];
        for half in [false, true] {
            let answers = on_the_gpu(&gpu, &model, &pixels, half);
            let rounding = if half { HALF } else { 1.0 / f64::from(1 << 24) };
            // 32-bit logarithms of opacities near 1 err by more than a rounding.
            let term = rounding + 4.0 / f64::from(1 << 22);
            // Of the five features and the weight.
            let (mut compared, mut outside) = ([0; 6], [0; 6]);
            for (pixel, answers) in pixels.iter().zip(&answers) {
                let n = pixel.len() as f64;
                for (k, &sum) in answers[0].moments.iter().enumerate() {
                    let terms = pixel
                        .iter()
                        .map(|&(z, a)| absorbance(a) * warp().apply(z.into()).powi(k as i32));
                    let (exact, size) = terms.fold((0.0, 0.0), |(s, a), t| (s + t, a + t.abs()));
                    // WGSL's logarithm errs by 2⁻²¹ near 1, where opacities are small; subnormal halves step by 2⁻²⁴.
                    let bound = size * (n + 1.0) * term + n * (0.5f64.powi(21) + 0.5f64.powi(24));
                    assert!(
                        (f64::from(sum) - exact).abs() <= bound,
                        "{recipe}, half {half}, b_{k} of {pixel:?}: {sum} for {exact}"
                    );
                }
                let moments = answers[0].moments.map(f64::from);
                let base = anchored::seen_given(pixel, &warp(), moments);
                let moved: Vec<Vec<Seen>> = (0..16)
                    .map(|_| {
                        let mut by = |exponent: i32| {
                            1.0 + f64::from(random.between(-1.0, 1.0)) * 2f64.powi(exponent)
                        };
                        // And the fragment's own opacity by the logarithm's 2⁻²¹.
                        let near = moments.map(|m| m * by(-20) + by(-20) - 1.0);
                        // The depths are given in 32 bits.
                        let pixel: Points = pixel
                            .iter()
                            .map(|&(z, a)| ((f64::from(z) * by(-22)) as f32, a))
                            .collect();
                        anchored::seen_given(&pixel, &warp(), near)
                    })
                    .collect();
                for (i, (got, want)) in answers.iter().zip(&base).enumerate() {
                    let end = match want.place {
                        Place::Between => 0.0,
                        Place::Nearest => 1.0,
                        Place::Farthest => 2.0,
                    };
                    assert_eq!(got.end, end, "{recipe}, half {half}, {i} of {pixel:?}");
                    let in_front = match want.place {
                        Place::Between => want.front,
                        Place::Nearest => 0.0,
                        Place::Farthest => want.others,
                    };
                    let ten = |x: f64| 10.0 * (1.0 + x.abs()) / f64::from(1 << 24);
                    // A level's b/(1 + b) is rounded; b grows with (1 + b)² of that.
                    let bound =
                        ten(in_front) * (1.0 + in_front).powi(2) + moments[0] / f64::from(1 << 22);
                    assert!(
                        (f64::from(got.in_front) - in_front).abs() <= bound,
                        "{recipe}, half {half}, {i} of {pixel:?}: {} for {in_front}",
                        got.in_front
                    );
                    // Nobody asks for the features of an end.
                    let between = want.place == Place::Between;
                    for k in (0..5).filter(|_| between) {
                        // A root near 0 is compared by its square.
                        let plain = |x: f64| if k == 0 { x * x } else { x };
                        let x = plain(want.features[k]);
                        let spread = moved
                            .iter()
                            .map(|m| (plain(m[i].features[k]) - x).abs())
                            .fold(0.0, f64::max);
                        let bound = 4.0 * spread + ten(x);
                        compared[k] += 1;
                        if (plain(got.features[k].into()) - x).abs() > bound {
                            outside[k] += 1;
                        }
                    }
                    let w = want.weight(share);
                    let spread = moved
                        .iter()
                        .map(|m| (m[i].weight(share) - w).abs())
                        .fold(0.0, f64::max);
                    let bound = 4.0 * spread + 20.0 * ten(in_front);
                    compared[5] += 1;
                    if (f64::from(got.weight) - w).abs() > bound {
                        outside[5] += 1;
                    }
                }
            }
            let limits = compared.map(|n: u32| n / 250);
            assert_eq!(outside[..3], [0; 3], "{recipe}, half {half}");
            assert!(
                outside.iter().zip(limits).all(|(&n, limit)| n <= limit),
                "{recipe}, half {half}: {outside:?} of {compared:?}"
            );
            assert!(compared[0] > 4000, "most fragments lie between");
        }
    }
}

/// Whatever finite depths and opacities come in, denormals and the largest numbers too, every weight is one: 0 … 1. With 32-bit and
/// 16-bit sums.
#[test]
fn weights_of_hostile_fragments_are_weights() {
    let gpu = gpu();
    let mut random = Random::new(77, &[]);
    let depths = [
        0.0,
        1e-45,
        1e-38,
        1e-30,
        0.5,
        1.0,
        1.000_000_1,
        2.0,
        1e30,
        f32::MAX,
    ];
    let alphas = [
        0.0,
        1e-45,
        1e-30,
        1e-7,
        0.004,
        0.5,
        0.99,
        1.0 - f32::EPSILON / 2.0,
        1.0,
    ];
    let mut fragment = |hostile: bool| {
        if hostile {
            (
                depths[random.below(depths.len())],
                alphas[random.below(alphas.len())],
            )
        } else {
            (random.log_between(1e-30, 1e30), random.unit())
        }
    };
    let pixels: Vec<Points> = (0..2000usize)
        .map(|i| {
            (0..[1, 2, 3, 5, 9, 40][i % 6])
                .map(|_| fragment(i % 2 == 0))
                .collect()
        })
        .collect();
    for recipe in ANCHORED {
        let model = shipped(recipe);
        for half in [false, true] {
            let answers = on_the_gpu(&gpu, &model, &pixels, half);
            for (pixel, answers) in pixels.iter().zip(&answers) {
                for a in answers {
                    let finite = a.moments.iter().chain(&a.features).all(|x| x.is_finite());
                    assert!(
                        finite && a.in_front.is_finite(),
                        "{recipe}, half {half}: {pixel:?}"
                    );
                    assert!(
                        (0.0..=1.0).contains(&a.weight),
                        "{recipe}, half {half}: {} of {pixel:?}",
                        a.weight
                    );
                }
            }
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Whole frames.

/// Walls of these (depth, α), coloured by a rule.
fn stack(layers: impl IntoIterator<Item = (f32, f32)>) -> Vec<Fragment> {
    layers
        .into_iter()
        .enumerate()
        .map(|(i, (depth, alpha))| {
            let t = i as f32 * 0.37;
            Fragment::new(
                depth,
                alpha,
                [t.fract(), (2.3 * t).fract(), 1.0 - t.fract()],
            )
        })
        .collect()
}

/// One and two layers are exact whatever the network says, and with separate ends three: in both precisions.
///
/// Sums round once for every addition, as do the stored weights; the coverage `1 − e^−b_0` errs by the rounding of `b_0 ≤ 16`.
#[test]
fn few_layers_are_exact() {
    let gpu = gpu();
    let c0 = [0.2, 0.6, 0.4];
    let cases = [
        stack([(3.0, 0.5)]),
        stack([(3.0, 0.999)]),
        stack([(3.0, 1.0)]),
        stack([(0.05, 0.4), (900.0, 0.8)]),
        stack([(1.0, 0.97), (1.1, 0.3)]),
        stack([(1.0, 0.3), (4.0, 0.6), (9.0, 0.8)]),
        stack([(0.1, 0.9), (0.2, 0.05), (5000.0, 0.99)]),
    ];
    for recipe in ANCHORED {
        let model = shipped(recipe);
        for fragments in &cases {
            if fragments.len() > 2 && recipe == Recipe::Small {
                continue;
            }
            let exact = over::composite(fragments, c0);
            for spec in specs(recipe) {
                let image = draw(&gpu, &walls(fragments, c0), &spec, &model, [3, 2]);
                let rounding = if spec.to_string().ends_with("f16") {
                    HALF
                } else {
                    1.0 / f64::from(1 << 20)
                };
                // Three sums of n terms, each with a weight e^−b whose b ≤ 4 rounded.
                let bound = (3 * fragments.len() + 4) as f64 * rounding;
                for p in &image.pixels {
                    for k in 0..3 {
                        assert!(
                            f64::from((p[k] - exact[k]).abs()) <= bound,
                            "{spec} of {fragments:?}: {p:?} for {exact:?}"
                        );
                    }
                }
            }
        }
    }
}

/// The nearest and the farthest fragment are recognised whatever the order of drawing: a fault there costs a factor of five
/// and no NaN. Forty layers whose first and last have colours of their own: with an opaque first only it is seen, and with
/// faint others the last one's share is what it should be.
#[test]
fn the_ends_are_recognised() {
    let gpu = gpu();
    let c0 = [0.0; 3];
    for recipe in ANCHORED {
        let model = shipped(recipe);
        for reversed in [false, true] {
            // Red in front, white behind, forty green ones between them, from the far end of the range to the near one.
            let mut fragments: Vec<Fragment> = (0..40)
                .map(|i| Fragment::new(2.0 + i as f32, 0.04, [0.0, 1.0, 0.0]))
                .collect();
            fragments.insert(20, Fragment::new(1.0, 0.5, [1.0, 0.0, 0.0]));
            fragments.push(Fragment::new(60.0, 0.6, [0.0, 0.0, 1.0]));
            if reversed {
                fragments.reverse();
            }
            let exact = over::composite(&fragments, c0);
            for spec in specs(recipe) {
                let image = draw(&gpu, &walls(&fragments, c0), &spec, &model, [2, 2]);
                let p = image.pixels[0];
                // Forty roundings of halves where the ends are normalised with the rest; without the anchors red and blue
                // are off by a third.
                for k in [0, 2] {
                    let bound = 0.02f32.max(44.0 * HALF as f32) * exact[k].max(0.25);
                    assert!(
                        (p[k] - exact[k]).abs() <= bound,
                        "{spec}: {p:?} for {exact:?}"
                    );
                }
            }
        }
    }
}

/// A scene that is a thousand times as large, or as small, looks the same: within one step of an 8-bit display.
///
/// But for a pixel in ten thousand, by sixteen steps at most: a thousand is no power of two, so that depths are rounded
/// otherwise, a sum in 16 bits falls on the other side of a rounding, and where little is left of it without the fragment's
/// own share and the ends that is a large part. docs/learned-weights.md tells what was measured and tried.
#[test]
fn scale_changes_nothing_visible() {
    let gpu = gpu();
    let (mut total, mut visible, mut worst) = (0, 0, 0.0f32);
    for file in ["boxes-held", "foliage-held", "panes-held"] {
        let base = suite::load(file).unwrap();
        for recipe in ANCHORED {
            let model = shipped(recipe);
            for spec in specs(recipe) {
                let reference = draw(&gpu, &base, &spec, &model, [256, 192]);
                let exact = draw_exact(&gpu, &base);
                for factor in [1e-3f32, 1e3] {
                    let scene = base.scaled(factor);
                    let image = draw(&gpu, &scene, &spec, &model, [256, 192]);
                    let difference = |a: &[f32; 4], b: &[f32; 4]| {
                        let display =
                            |x: f32| peelnet_core::srgb::encode(x.clamp(0.0, 1.0)) * 255.0;
                        (0..3).fold(0.0, |d: f32, k| {
                            d.max((display(a[k]) - display(b[k])).abs())
                        })
                    };
                    // At a silhouette the scaled triangle may miss a pixel's centre: the exact image tells.
                    let same: Vec<bool> = exact
                        .pixels
                        .iter()
                        .zip(&draw_exact(&gpu, &scene).pixels)
                        .map(|(a, b)| (0..4).all(|k| (a[k] - b[k]).abs() < 1e-4))
                        .collect();
                    assert!(same.iter().filter(|s| **s).count() > same.len() * 9 / 10);
                    let pairs = reference.pixels.iter().zip(&image.pixels);
                    for ((a, b), same) in pairs.zip(&same) {
                        let d = difference(a, b);
                        if *same && d > 1.0 {
                            visible += 1;
                            worst = worst.max(d);
                            println!("{file}, {spec}, times {factor}: {a:?} {b:?}");
                        }
                        total += 1;
                    }
                }
            }
        }
    }
    println!("{visible} of {total} pixels differ by more than 1/255, by {worst}/255 at most");
    assert!(visible * 10_000 <= total, "{visible} of {total}");
    assert!(worst <= 16.0, "{worst}/255");
}

/// Every shipped scene and the hardest stacks: no pixel that is not finite, negative, or brighter than the brightest colour in
/// it, in both precisions.
#[test]
fn every_pixel_is_finite() {
    let gpu = gpu();
    let mut random = Random::new(8, &[]);
    let stacks = [
        stack((0..200).map(|i| (1.0 + 0.1 * i as f32, 0.9))),
        stack((0..256).map(|i| (0.01 + 0.001 * i as f32, 0.001 + 0.999 * i as f32 / 255.0))),
        stack((0..16).map(|_| (2.0, 0.1))),
        stack((0..30).map(|i| (2.0 + i as f32 * 1e-6, 1.0))),
        stack((0..64).map(|i| (0.02 * 1.2f32.powi(i), 1.0))),
        stack((0..100).map(|i| (1.0 + i as f32, 0.002))),
        stack((0..50).map(|_| {
            (
                10f32.powf(random.between(-1.5, 4.0)),
                [0.02, 0.98][random.below(2)],
            )
        })),
        stack([(2.0, 0.0), (3.0, 0.0)]),
    ];
    let mut scenes: Vec<Scene> = stacks.iter().map(|f| walls(f, [0.1, 0.2, 0.3])).collect();
    scenes.extend(suite::load_all().unwrap());
    for scene in &scenes {
        for recipe in ANCHORED {
            let model = shipped(recipe);
            for spec in specs(recipe) {
                let image = draw(&gpu, scene, &spec, &model, [48, 36]);
                for p in &image.pixels {
                    // All colours of the suite and the stacks are at most 1 but where lit; light adds.
                    let limit = if scene.lights.is_empty() {
                        1.0 + 1e-2
                    } else {
                        10.0
                    };
                    assert!(
                        p.iter().all(|x| x.is_finite() && (0.0..=limit).contains(x)),
                        "{}, {spec}: {p:?}",
                        scene.name
                    );
                }
            }
        }
    }
}

/// The sizes that the issue of a shipped network states.
#[test]
fn shipped_networks_are_as_small_as_they_say() {
    for (recipe, most) in [
        (Recipe::Small, 80),
        (Recipe::Medium, 150),
        (Recipe::Large, 300),
    ] {
        let parameters = shipped(recipe).mlp.parameters();
        assert!(parameters <= most, "{recipe}: {parameters}");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// What surfaces look like.

/// One surface is exact for every learned method whatever it looks like: opacity from an image, and light that takes its colour.
///
/// Half floats of sums, of transmittances and of what divides them: six roundings, of values up to 1.
#[test]
fn a_surface_with_an_image_or_of_stained_glass_is_exact() {
    let gpu = gpu();
    let c0 = [0.8, 0.6, 0.9];
    let halves = Texture::of("halves", [2, 1], |x, _| {
        if x == 0 {
            [255, 0, 255, 102]
        } else {
            [0, 255, 255, 255]
        }
    });
    let mut mapped = Material::unlit([0.9, 0.8, 0.7], 0.75);
    mapped.maps.color = Some(halves.into());
    mapped.maps.nearest = true;
    let mut glass = Material::unlit([0.2, 0.1, 0.3], 0.8);
    glass.transmission = [0.9, 0.5, 0.1];
    for recipe in ANCHORED {
        let model = shipped(recipe);
        for spec in specs(recipe) {
            for material in [&mapped, &glass] {
                let wall = peelnet_tests::wall(3.0, material.clone());
                let scene = peelnet_tests::scene("one", c0, vec![wall]);
                let image = draw(&gpu, &scene, &spec, &model, [16, 12]);
                for (i, pixel) in image.pixels.iter().enumerate() {
                    for k in 0..3 {
                        let (color, covers) = if material.is_transmissive() {
                            let covers = 0.8 * (1.0 - f64::from(material.transmission[k]));
                            (0.8 * f64::from(material.color[k]), covers)
                        } else {
                            let left = i % 16 < 8;
                            let texel = if left {
                                [1.0, 0.0, 1.0]
                            } else {
                                [0.0, 1.0, 1.0]
                            };
                            let alpha = if left { 0.75 * 0.4 } else { 0.75 };
                            (alpha * f64::from(material.color[k]) * texel[k], alpha)
                        };
                        let want = color + (1.0 - covers) * f64::from(c0[k]);
                        let error = (f64::from(pixel[k]) - want).abs();
                        assert!(error <= 6.0 * HALF, "{spec}, {i}: {pixel:?} for {want}");
                    }
                }
            }
        }
    }
}
