//! The exported texts of slabs, function by function, against their CPU twin.

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    methods::slabs::{self, Design, Layout, Range, Seen},
    random::Random,
};
use peelnet_export::{Blend, Description, SelfTest, Target};
use peelnet_gpu::Gpu;
use peelnet_model::{Inputs, Model, Recipe};
use peelnet_tests::{Points, gpu, in_runs, run_text, shipped, stored};

/// The warp of the pixels below: ζ = ln depth.
fn warp() -> DepthWarp {
    DepthWarp::new((-1f64).exp(), 1f64.exp())
}

fn zeta(depth: f32) -> f64 {
    f64::from(warp().apply(depth.into()) as f32)
}

/// Whether every depth and opacity lies within its level, bin and slab. On the edge between two they may be rounded to either, in 32 bits
/// otherwise than in 64.
fn settled(pixel: &Points, design: &Design) -> bool {
    let zetas: Vec<f64> = pixel.iter().map(|p| zeta(p.0)).collect();
    let range = Range::of(zetas.iter().copied());
    let levels = zetas.iter().map(|z| 255.0 * (z * 0.5 + 0.5));
    let spread = levels.clone().fold([255.0f64, 0.0], |[low, high], l| {
        [low.min(l.floor()), high.max(l.ceil())]
    });
    let extent = (spread[1] - spread[0]).max(1.0);
    let apart = |x: f64, least: f64| (x - x.round()).abs() > least;
    let level_is = levels.clone().all(|l| apart(l, 1e-3) || l == l.round());
    let place_is = zetas.iter().all(|&z| {
        let t = range.place(z);
        let mut begin = 0.0;
        design.slabs.iter().all(|slab| {
            let bin = (t - begin) / (slab.end - begin) * f64::from(design.records.bins);
            begin = slab.end;
            // 255 levels are eight bits; the others of 24 are left for the pixel's part of them, and bins take eleven to thirteen.
            let outside = !(0.0..=f64::from(design.records.bins)).contains(&bin);
            (outside && (t - slab.end).abs() > 1e-4)
                || apart(bin, 0.02 + 0.3 / extent)
                || t == 0.0
                || t == 1.0
        })
    });
    let opacity_is = pixel.iter().all(|&(_, alpha)| {
        let b = absorbance(alpha);
        let level = b / (b + 1.0) * 1.0625 * f64::from(design.records.alphas - 1) + 0.5;
        apart(level, 0.002)
    });
    level_is && place_is && opacity_is
}

/// Pixels of every kind: few and many layers, narrow and wide, faint, opaque, deep, coplanar.
fn pixels(design: &Design) -> Vec<Points> {
    let mut random = Random::new(51, &[]);
    let mut all: Vec<Points> = Vec::new();
    for i in 0..6000 {
        let n = [1, 2, 3, 4, 6, 9, 14, 40][i % 8];
        let (from, width) = (random.between(-1.0, 0.8), random.between(0.05, 1.9));
        let kind = random.below(5);
        let pixel: Points = (0..n)
            .map(|_| {
                let depth = (from + width * random.unit()).min(1.0).exp();
                let alpha = match kind {
                    0 => random.between(0.01, 0.2),
                    1 => random.between(0.7, 1.0),
                    2 => [0.001, 0.3, 0.9999][random.below(3)],
                    _ => random.between(0.02, 0.98),
                };
                (depth, alpha)
            })
            .collect();
        all.push(pixel);
    }
    let even = |n: usize, alpha: f32| -> Points {
        (0..n)
            .map(|i| ((i as f32 / n as f32 * 1.9 - 0.95).exp(), alpha))
            .collect()
    };
    for n in 2..400 {
        all.push(even(n, [0.0, 0.001, 0.02, 0.5, 0.97][n % 5]));
        all.push(vec![
            (0.9 + 0.001 * n as f32, 0.013 * (1 + n % 60) as f32);
            2 + n % 15
        ]);
    }
    all.retain(|pixel| settled(pixel, design));
    all
}

/// What the exported functions say of a fragment.
#[derive(Clone, Copy)]
struct Answer {
    /// What the targets of the statistics hold, in the description's order; 0 where there are fewer.
    targets: [[f32; 4]; 4],
    known: bool,
    weight: f32,
}

impl Answer {
    /// Absorbance of each slab, and absorbance times depth in it; 0 where there is none, or none is kept.
    fn sums(&self, layout: Layout) -> [[f64; 2]; 4] {
        let [a, b, c, d] = self.targets;
        let firsts = match layout {
            Layout::Small => [a[3], c[0], c[1], 0.0],
            Layout::Medium => [a[3], b[3], c[3], 0.0],
            Layout::Large => d,
        };
        let slabs = layout.design().slabs.len();
        std::array::from_fn(|k| [if k < slabs { a[k] } else { 0.0 }, firsts[k]].map(f64::from))
    }
}

/// A target of the statistics as a variable of the driver: its declaration, and what a fragment does to it.
fn variable(target: &Target) -> [String; 2] {
    let channels = if target.format == "rg16float" { 2 } else { 4 };
    let (name, write) = (target.name, target.write);
    let clear: Vec<String> = target.clear[..channels]
        .iter()
        .map(|c| format!("f32({c})"))
        .collect();
    let declared = format!("var {name} = vec{channels}f({});", clear.join(", "));
    let blended: Vec<String> = ["x", "y", "z", "w"][..channels]
        .iter()
        .map(|c| {
            let blend = if *c == "w" {
                target.alpha
            } else {
                target.color
            };
            match blend {
                Blend::Add => format!("stored({name}.{c} + stored({write}.{c}))"),
                _ => format!("max({name}.{c}, {write}.{c})"),
            }
        })
        .collect();
    let done = format!("{name} = vec{channels}f({});", blended.join(", "));
    [declared, done]
}

/// Runs the exported functions over pixels, with the passes of the exported description, and targets that add and take maxima as blending
/// does.
fn on_the_gpu(
    gpu: &Gpu,
    model: &Model,
    pixels: &[Points],
    half: bool,
    warp: &DepthWarp,
) -> Vec<Vec<Answer>> {
    let rounded = stored(half);
    let description = Description::of(model.meta.recipe);
    let [_, statistics, weights] = description.passes else {
        panic!("{:?}", description.passes);
    };
    let variables: Vec<_> = statistics.targets.iter().map(variable).collect();
    let [declared, done] = [0, 1].map(|k| {
        let parts: Vec<&str> = variables.iter().map(|v| v[k].as_str()).collect();
        parts.join("\n")
    });
    let compute = statistics.compute.unwrap();
    let call = weights.compute.unwrap().call.trim_end_matches(".x");
    let kept: String = statistics
        .targets
        .iter()
        .zip(1..)
        .map(|(target, k)| {
            let zeros = if target.format == "rg16float" {
                ", 0.0, 0.0"
            } else {
                ""
            };
            format!(
                "answers[5u * id.x + {k}u] = vec4f({}{zeros});\n",
                target.name
            )
        })
        .collect();
    let root = format!(
        "import package::learned::weight::{{peelnet_pixel_range, peelnet_statistics, peelnet_fragment}};
        @group(0) @binding(0) var<storage, read> fragments: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
        fn stored_all(x: vec4f) -> vec4f {{ return {rounded}; }}
        fn stored(x: f32) -> f32 {{ return stored_all(vec4f(x)).x; }}
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&fragments) {{ return; }}
            let own = fragments[id.x];
            var range = vec2f(0.0);
            for (var i = u32(own.z); i < u32(own.w); i++) {{
                range = max(range, peelnet_pixel_range(fragments[i].x));
            }}
            {declared}
            for (var i = u32(own.z); i < u32(own.w); i++) {{
                let zeta = fragments[i].x;
                let alpha = fragments[i].y;
                {compute}
                {done}
            }}
            let zeta = own.x;
            let alpha = own.y;
            let w = {call};
            answers[5u * id.x] = vec4f(w, 0.0, 0.0);
            {kept}
        }}"
    );
    let text = peelnet_export::wgsl(model).unwrap();
    let sources = [("driver", root.as_str()), ("learned::weight", &text)];
    let wgsl = peelnet_shaders::link("driver", &[], &sources).unwrap();
    let fragments = in_runs(pixels, warp);
    let rows: Vec<[[f32; 4]; 5]> = run_text(gpu, &wgsl, &fragments, fragments.len());
    let mut rows = rows.into_iter().map(|[w, targets @ ..]| Answer {
        targets,
        known: w[1] == 1.0,
        weight: w[0],
    });
    pixels
        .iter()
        .map(|p| rows.by_ref().take(p.len()).collect())
        .collect()
}

/// The exported text's sums, known fragments and weights are those of `peelnet_core`, in both precisions of the targets.
///
/// Sums: every one of n additions, and every term, rounds once. Weights are compared given the GPU's own sums: they then differ by the roundings of
/// differences of those sums, by as much as moving the sums by sixteen roundings (2⁻²⁰) in sixteen random directions moves the 64-bit
/// weights, times four for what random directions do not show, and two hundred roundings of the weight, of which logarithms take most. One
/// in 200 may lie outside, where a rounding decides whether the nearer end is all that is left of its slab.
#[test]
fn the_exported_text_is_the_twin_of_the_core() {
    let gpu = gpu();
    for recipe in [Recipe::SMALL, Recipe::MEDIUM, Recipe::LARGE] {
        let model = shipped(recipe);
        let Inputs::Slabs(design, inputs) = recipe.inputs else {
            panic!("{recipe} reads no slabs");
        };
        let layout = design.layout().unwrap();
        let pixels = pixels(&design);
        let layers: usize = pixels.iter().map(Vec::len).sum();
        assert!(
            layers > 4000,
            "{layers} fragments of {} pixels",
            pixels.len()
        );
        for half in [false, true] {
            let answers = on_the_gpu(&gpu, &model, &pixels, half, &warp());
            let mut random = Random::new(52, &[]);
            let (mut compared, mut outside, mut known) = (0, 0, 0);
            for (pixel, answers) in pixels.iter().zip(&answers) {
                let sums = answers[0].sums(layout);
                check_sums(pixel, &sums, half, &design);
                let weights = |pixel: &Points, sums: &[[f64; 2]]| -> Vec<(f64, Seen)> {
                    let all = slabs::seen_given(pixel, &warp(), design, sums);
                    let weigh = |s: &Seen| s.weight(|between| model.answer(inputs, between));
                    all.iter().map(|s| (weigh(s), *s)).collect()
                };
                let base = weights(pixel, &sums);
                let moved: Vec<Vec<(f64, Seen)>> = (0..16)
                    .map(|_| {
                        let mut by = || 1.0 + f64::from(random.between(-1.0, 1.0)) * 2f64.powi(-20);
                        weights(pixel, &sums.map(|sum| sum.map(|x| x * by() + by() - 1.0)))
                    })
                    .collect();
                for (i, (got, (weight, seen))) in answers.iter().zip(&base).enumerate() {
                    let place = || format!("{recipe}, half {half}, {i} of {pixel:?}");
                    assert_eq!(got.known, seen.between.is_none(), "{}", place());
                    let spread = moved.iter().map(|m| (m[i].0 - weight).abs());
                    let spread = spread.fold(0.0, f64::max);
                    let bound = 4.0 * spread + 200.0 / f64::from(1 << 24);
                    compared += 1;
                    known += usize::from(got.known);
                    outside += usize::from((f64::from(got.weight) - weight).abs() > bound);
                }
            }
            println!("{recipe}, half {half}: {outside} of {compared} outside, {known} known");
            assert!(
                known > compared / 10 && known < compared,
                "{recipe}: {known}"
            );
            assert!(
                200 * outside <= compared,
                "{recipe}, half {half}: {outside} of {compared}"
            );
        }
    }
}

/// The sums of a pixel's slabs.
fn check_sums(pixel: &Points, sums: &[[f64; 2]; 4], half: bool, design: &Design) {
    let exact = pixel.iter().map(|p| absorbance(p.1)).sum::<f64>();
    let n = pixel.len() as f64;
    let rounding = if half {
        1.0 / 2048.0
    } else {
        1.0 / f64::from(1 << 24)
    };
    // WGSL's logarithm errs by 2⁻²¹ near 1, where opacities are small; subnormal halves step by 2⁻²⁴.
    let bound = exact * (n + 1.0) * (rounding + 4.0 / f64::from(1 << 22))
        + n * (0.5f64.powi(21) + 0.5f64.powi(24));
    let found: f64 = sums.iter().map(|s| s[0]).sum();
    assert!(
        (found - exact).abs() <= bound,
        "half {half}: {found} for {exact} of {pixel:?}"
    );
    for (sum, kept) in sums.iter().zip(design.slabs) {
        // A mean depth lies in the slab.
        assert!(
            !kept.mean || sum[1].abs() <= sum[0] + bound,
            "half {half}: {sum:?} of {pixel:?}"
        );
    }
}

/// What the header tells renderers to compare with is what the text answers: targets, weights and points of the network.
///
/// In 32 bits: logarithms near 1 err by 2⁻²¹, sums of four and weights by some roundings more.
#[test]
fn a_pasted_text_can_be_checked() {
    const SOME_ROUNDINGS: f32 = 1e-5;
    let gpu = gpu();
    let close =
        |found: f32, want: f32| (found - want).abs() <= SOME_ROUNDINGS * want.abs().max(1.0);
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let check = SelfTest::of(&model);
        assert_eq!(check.network.len(), 3, "{recipe}: {check:?}");
        let Inputs::Slabs(design, _) = recipe.inputs else {
            continue;
        };
        let pixel = check.pixel.unwrap();
        let points: Points = pixel.fragments.iter().map(|f| (f.z, f.alpha)).collect();
        let warp = DepthWarp::new(pixel.near.into(), pixel.far.into());
        let range = Range::of(pixel.fragments.iter().map(|f| f64::from(f.zeta))).stored();
        let (name, values) = &pixel.targets[0];
        assert_eq!(
            (*name, values),
            ("range", &range.map(|x| x as f32).to_vec())
        );
        let answers = on_the_gpu(&gpu, &model, &[points], false, &warp);
        for (found, want) in answers[0].iter().zip(&pixel.fragments) {
            assert!(close(found.weight, want.weight), "{recipe}: {want:?}");
        }
        let names: Vec<&str> = pixel.targets.iter().map(|t| t.0).collect();
        let described = Description::of(recipe).passes[1].targets;
        let described: Vec<&str> = described.iter().map(|t| t.name).collect();
        assert_eq!(names[1..], described, "{recipe}");
        let targets = pixel.targets[1..].iter().zip(&answers[0][0].targets);
        for ((name, want), found) in targets {
            let all = found.iter().zip(want);
            let same = all.clone().all(|(f, w)| close(*f, *w));
            assert!(same, "{recipe}, {name}: {found:?}, not {want:?}");
        }
        assert!(design.slabs.len() >= 3);
    }
}
