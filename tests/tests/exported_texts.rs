//! The exported texts, function by function: against their CPU twins, against the committed files, and what documents say of them.

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    features::Rest,
    methods::anchored::{self, Place, Seen},
    random::Random,
    statistics::{FAR_END, NEAR_END},
};
use peelnet_export::{Description, Language, Options};
use peelnet_gpu::Gpu;
use peelnet_model::{Inputs, Model, Recipe};
use peelnet_tests::{Points, evaluate_text, gpu, in_runs, run_text, shipped, stored};
use std::{
    fs,
    path::{Path, PathBuf},
};

const ANCHORED: [Recipe; 2] = [Recipe::ANCHORED_SMALL, Recipe::ANCHORED_MEDIUM];

fn text(model: &Model) -> String {
    peelnet_export::wgsl(model).unwrap()
}

/// Relative rounding of a half float.
const HALF: f64 = 1.0 / 2048.0;

fn path(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    root.join(name)
}

fn read(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Whether what does not match is written anew: `PEELNET_UPDATE=1 cargo nextest run -p peelnet_tests --test exported_texts`.
fn update() -> bool {
    std::env::var_os("PEELNET_UPDATE").is_some()
}

/// What engines are given is what the renderer draws with.
#[test]
fn committed_texts_are_what_is_exported_today() {
    let is_current = |file: &str, text: &str| {
        assert!(
            read(file) == text,
            "{file} is another text than the exporter writes: run this test with PEELNET_UPDATE=1"
        );
    };
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        for language in Language::ALL {
            let file = format!("models/{recipe}/model.{}", language.extension());
            let options = Options {
                language,
                ..Options::default()
            };
            if update() {
                peelnet_export::export(&gpu(), &model, &path(&file), &options).unwrap();
            }
            is_current(&file, &peelnet_export::text(&model, &options).unwrap());
        }
        let file = format!("models/{recipe}/model.json");
        is_current(&file, &peelnet_export::json(&model).unwrap());
    }
}

/// The document's instructions are the exporter's.
#[test]
fn the_document_says_what_the_exported_text_says() {
    const DOCUMENT: &str = "docs/learned-weights.md";
    const BEGIN: &str = "<!-- description of medium -->";
    const END: &str = "<!-- end of description -->";
    let document = read(DOCUMENT);
    let (before, after) = document.split_once(BEGIN).unwrap();
    let (section, after) = after.split_once(END).unwrap();
    let want = Description::of(Recipe::MEDIUM).markdown();
    if update() {
        let text = format!("{before}{BEGIN}\n\n{want}\n{END}{after}");
        fs::write(path(DOCUMENT), text).unwrap();
        return;
    }
    assert_eq!(
        section.trim(),
        want.trim(),
        "run this test with PEELNET_UPDATE=1"
    );
}

/// Depth on the logarithmic scale, on the linear one where near is not above 0, and for a flat range.
///
/// WGSL's logarithm errs by 2⁻²¹ where the ratio is below 2, and by three roundings elsewhere; the scale multiplies that. The
/// division errs by 2.5 roundings of the ratio, which the logarithm makes absolute.
#[test]
fn depths_are_those_of_the_core() {
    let gpu = gpu();
    let mut random = Random::new(41, &[]);
    let mut inputs: Vec<[[f32; 4]; 2]> = (0..4000)
        .map(|i| {
            let near = random.log_between(1e-3, 1e3);
            let far = near * random.log_between(1.01, 1e5);
            let z = near + (far - near) * random.between(-0.1, 1.1);
            let [near, far, z] = if i % 4 == 0 {
                [near - 100.0, far, z - 100.0]
            } else {
                [near, far, z]
            };
            [[z, near, far, 0.0], [0.0; 4]]
        })
        .collect();
    for (near, z) in [(1.0, 1.0), (5.0, 7.0), (0.0, 0.0), (0.0, 3.0), (-2.0, -2.0)] {
        inputs.push([[z, near, near, 0.0], [0.0; 4]]);
    }
    let got = evaluate_text(
        &gpu,
        &text(&shipped(Recipe::MEDIUM)),
        "peelnet_zeta",
        "y.x = peelnet_zeta(a.x, a.y, a.z);",
        &inputs,
    );
    for ([[z, near, far, _], _], y) in inputs.iter().zip(&got) {
        let warp = DepthWarp::new(f64::from(*near), f64::from(*far));
        // The 64-bit logarithm of a depth before the range may not exist.
        let want = if *z <= *near {
            -1.0
        } else {
            warp.apply(f64::from(*z))
        };
        let bound =
            2f64.powi(-22) + warp.scale() * 2f64.powi(-20) + if *near <= 0.0 { 1e-5 } else { 0.0 };
        assert!(
            (f64::from(y[0]) - want).abs() <= bound,
            "{z} in {near} .. {far}: {} for {want}",
            y[0]
        );
    }
}

/// The resolve is that of the core, also where nothing is covered or a sum is empty: a dozen roundings of the colours.
#[test]
fn resolves_are_those_of_the_core() {
    let gpu = gpu();
    let mut random = Random::new(42, &[]);
    let inputs: Vec<[[f32; 4]; 2]> = (0..2000)
        .map(|_| {
            let mut sum = || {
                let a = [0.0, 1e-6, random.unit(), 3.0 * random.unit()][random.below(4)];
                let [r, g, b] = random.color();
                [a * r, a * g, a * b, a]
            };
            [sum(), sum()]
        })
        .collect();
    let background = [0.3, 0.5, 0.7];
    for absorbance in [0.0f32, 1e-6, 0.2, 3.0, 40.0] {
        let t = f64::from((-absorbance).exp());
        for recipe in ANCHORED {
            let separate = recipe == Recipe::ANCHORED_MEDIUM;
            let ends = if separate { "b, " } else { "" };
            let got = evaluate_text(
                &gpu,
                &text(&shipped(recipe)),
                "peelnet_resolve",
                &format!("y = peelnet_resolve(a, {ends}{absorbance:?}, vec3f(0.3, 0.5, 0.7));"),
                &inputs,
            );
            for ([sums, ends], y) in inputs.iter().zip(&got) {
                let (sums, ends) = (sums.map(f64::from), ends.map(f64::from));
                let want = if separate {
                    anchored::resolve_separate_ends(sums, ends, t, background)
                } else {
                    anchored::resolve(sums, t, background)
                };
                for k in 0..3 {
                    // The coverage is a difference: its rounding is that of 1, and quotients of sums below it pass it on.
                    assert!(
                        (f64::from(y[k]) - want[k]).abs() <= 1e-5,
                        "{recipe}, {absorbance}: {sums:?} {ends:?} give {y:?} for {want:?}"
                    );
                }
                assert!((f64::from(y[3]) - (1.0 - t)).abs() <= 1e-6, "{y:?}");
                if absorbance == 0.0 {
                    assert_eq!(y[..3], [0.3, 0.5, 0.7], "{recipe}: {sums:?} {ends:?}");
                }
            }
        }
    }
}

/// The warp of the pixels below: ζ = ln depth.
fn warp() -> DepthWarp {
    DepthWarp::new((-1f64).exp(), 1f64.exp())
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
    /// Of the recipe's inputs.
    features: [f32; 12],
    weight: f32,
}

/// Runs the exported functions over pixels, with targets that add and take maxima as blending does.
fn on_the_gpu(gpu: &Gpu, model: &Model, pixels: &[Points], half: bool) -> Vec<Vec<Answer>> {
    let rounded = stored(half);
    let about = model.meta.recipe.inputs.about();
    let mut values: Vec<&str> = about.iter().map(|about| about.wgsl).collect();
    values.resize(12, "0.0");
    let [first, second, third] = [0, 4, 8].map(|k| values[k..k + 4].join(", "));
    let mut parts: Vec<_> = about.iter().filter_map(|about| about.shared).collect();
    parts.dedup();
    let shared: String = parts
        .iter()
        .map(|part| format!("let {} = {};", part.name, part.wgsl))
        .collect();
    let functions: String = parts
        .iter()
        .filter_map(|part| part.wgsl.split_once('('))
        .map(|(function, _)| format!(", {function}"))
        .collect();
    let root = format!(
        "import package::learned::weight::{{peelnet_statistics, peelnet_place, peelnet_rest, peelnet_fragment{functions}}};
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
            let rest = peelnet_rest(place, moments, extent);
            {shared}
            let w = peelnet_fragment(own.y, own.x, moments, extent);
            answers[5u * id.x] = moments;
            answers[5u * id.x + 1u] = vec4f(extent.w, place.end, place.in_front, w.x);
            answers[5u * id.x + 2u] = vec4f({first});
            answers[5u * id.x + 3u] = vec4f({second});
            answers[5u * id.x + 4u] = vec4f({third});
        }}"
    );
    let text = text(model);
    let sources = [("driver", root.as_str()), ("learned::weight", &text)];
    let wgsl = peelnet_shaders::link("driver", &[], &sources).unwrap();
    let fragments = in_runs(pixels, &warp());
    let rows: Vec<[f32; 20]> = run_text(gpu, &wgsl, &fragments, fragments.len());
    let mut rows = rows.into_iter().map(|a| Answer {
        moments: [a[0], a[1], a[2], a[3], a[4]],
        end: a[5],
        in_front: a[6],
        weight: a[7],
        features: std::array::from_fn(|k| a[8 + k]),
    });
    pixels
        .iter()
        .map(|p| rows.by_ref().take(p.len()).collect())
        .collect()
}

/// The sums `b_0 … b_4` of a pixel.
fn check_sums(pixel: &Points, moments: &[f32; 5], half: bool) {
    let n = pixel.len() as f64;
    let rounding = if half { HALF } else { 1.0 / f64::from(1 << 24) };
    // 32-bit logarithms of opacities near 1 err by more than a rounding.
    let term = rounding + 4.0 / f64::from(1 << 22);
    for (k, &sum) in moments.iter().enumerate() {
        let terms = pixel
            .iter()
            .map(|&(z, a)| absorbance(a) * warp().apply(z.into()).powi(k as i32));
        let (exact, size) = terms.fold((0.0, 0.0), |(s, a), t| (s + t, a + t.abs()));
        // WGSL's logarithm errs by 2⁻²¹ near 1, where opacities are small; subnormal halves step by 2⁻²⁴.
        let bound = size * (n + 1.0) * term + n * (0.5f64.powi(21) + 0.5f64.powi(24));
        assert!(
            (f64::from(sum) - exact).abs() <= bound,
            "half {half}, b_{k} of {pixel:?}: {sum} for {exact}"
        );
    }
}

/// The exported text's statistics, places, features and weights are those of `peelnet_core`, in both precisions of the
/// targets.
///
/// Sums: every one of n additions, and every term, rounds once. Everything else is compared given the GPU's own sums. The
/// features then err by the roundings of differences of those sums, up to a dozen operations deep: by as much as moving the
/// sums by sixteen roundings (2⁻²⁰) in sixteen random directions moves the 64-bit features, times four for what random
/// directions do not show, and ten roundings of the value itself. The bounds' points are roots of a quadratic, whose worst
/// direction random ones may miss: one share, or weight, in 200 may lie outside. Where the moments determine the answer badly, that is wide, and as wide as it is for any renderer.
#[test]
fn the_exported_text_is_the_twin_of_the_core() {
    let gpu = gpu();
    let pixels = pixels();
    let mut random = Random::new(33, &[]);
    for recipe in ANCHORED {
        let model = shipped(recipe);
        let Inputs::Rest(inputs) = recipe.inputs else {
            panic!("{recipe} reads no rest of a pixel");
        };
        let share = |rest: &Rest<f64>| model.answer(inputs, rest);
        for half in [false, true] {
            let answers = on_the_gpu(&gpu, &model, &pixels, half);
            // Of each feature, and of the weight behind them.
            let weight = inputs.len();
            let (mut compared, mut outside) = (vec![0u32; weight + 1], vec![0u32; weight + 1]);
            for (pixel, answers) in pixels.iter().zip(&answers) {
                check_sums(pixel, &answers[0].moments, half);
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
                    for (k, input) in inputs.iter().enumerate().filter(|_| between) {
                        // A root near 0 is compared by its square.
                        let plain = |x: f64| if k == 0 { x * x } else { x };
                        let x = plain((input.value)(&want.rest));
                        let spread = moved
                            .iter()
                            .map(|m| (plain((input.value)(&m[i].rest)) - x).abs())
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
                    compared[weight] += 1;
                    if (f64::from(got.weight) - w).abs() > bound {
                        outside[weight] += 1;
                    }
                }
            }
            let limits: Vec<u32> = compared.iter().map(|n| n / 200).collect();
            assert_eq!(outside[..3], [0; 3], "{recipe}, half {half}");
            assert!(
                outside.iter().zip(&limits).all(|(n, limit)| n <= limit),
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
