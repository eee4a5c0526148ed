//! Frames of the learned methods: closed forms, scale, hard cases. All with the shipped networks.

use peelnet_core::{fragment::Fragment, methods::over, random::Random};
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_render::{Image, LearnedWeight, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Material, Scene, Texture, suite};
use peelnet_tests::{gpu, shipped, walls};

/// Ours. All know a pixel's nearest and farthest fragment.
const LEARNED: [Recipe; 5] = [
    Recipe::SMALL,
    Recipe::MEDIUM,
    Recipe::LARGE,
    Recipe::ANCHORED_SMALL,
    Recipe::ANCHORED_MEDIUM,
];

fn learned(model: &Model) -> LearnedWeight {
    LearnedWeight {
        recipe: model.meta.recipe,
        wgsl: peelnet_export::wgsl(model).unwrap(),
    }
}

/// A learned method in every precision that its targets have.
fn specs(recipe: Recipe) -> Vec<MethodSpec> {
    let name = recipe.method;
    let precisions = ["f16", "f32"].map(|targets| format!("{name}:targets={targets}").parse().ok());
    let all: Vec<MethodSpec> = precisions.into_iter().flatten().collect();
    if all.is_empty() {
        vec![name.parse().unwrap()]
    } else {
        all
    }
}

/// Whether a method's sums have 16 bits.
fn in_halves(spec: &MethodSpec) -> bool {
    !spec.to_string().ends_with("f32")
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
    for recipe in LEARNED {
        let model = shipped(recipe);
        for fragments in &cases {
            if fragments.len() > 2 && recipe == Recipe::ANCHORED_SMALL {
                continue;
            }
            let exact = over::composite(fragments, c0);
            for spec in specs(recipe) {
                let image = draw(&gpu, &walls(fragments, c0), &spec, &model, [3, 2]);
                let rounding = if in_halves(&spec) {
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
    for recipe in LEARNED {
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
                // The last slab of the smallest design keeps no farthest fragment: it is guessed, and the nearest is normalised with it.
                for k in [0, 2] {
                    let guessed = if recipe == Recipe::SMALL { 0.04 } else { 0.02 };
                    let bound = f32::max(guessed, 44.0 * HALF as f32) * exact[k].max(0.25);
                    assert!(
                        (p[k] - exact[k]).abs() <= bound,
                        "{spec}: {p:?} for {exact:?}"
                    );
                }
                // Every colour is pure, over black: together they are the coverage, of which the ends leave the rest to green. Sums of
                // 42 terms in halves err by as many roundings towards zero, of colours and of weights, and those of absorbance by as
                // many of 3.2, times the transmittance.
                let (shown, covered) = (p[0] + p[1] + p[2], exact[0] + exact[1] + exact[2]);
                let rounding = if in_halves(&spec) {
                    2.0 * HALF as f32
                } else {
                    2.0 * f32::EPSILON
                };
                let bound = 44.0 * rounding * covered;
                assert!((shown - p[3]).abs() <= bound, "{spec}: {p:?}");
                let bound = 44.0 * rounding * 3.2 * (1.0 - covered) + 2.0 * f32::EPSILON;
                assert!(
                    (p[3] - covered).abs() <= bound,
                    "{spec}: {p:?} for {covered}"
                );
            }
        }
    }
}

/// A scene that is 1,024 times as large, or as small, looks the same: within one step of an 8-bit display, in every pixel.
///
/// A power of two rounds no depth otherwise. A thousand does: where two fragments are a rounding apart they swap, and a sum in 16 bits falls
/// on the other side of a rounding. The hard cases judge that, pixel by pixel, and `high-alpha` declares it for half floats;
/// docs/learned-weights.md reports what was measured and tried.
#[test]
fn scale_changes_nothing_visible() {
    let gpu = gpu();
    for file in ["boxes-held", "foliage-held", "panes-held"] {
        let base = suite::load(file).unwrap();
        let exact = draw_exact(&gpu, &base);
        for recipe in LEARNED {
            let model = shipped(recipe);
            for spec in &specs(recipe) {
                let reference = draw(&gpu, &base, spec, &model, [256, 192]);
                for factor in [1.0 / 1024.0, 1024.0] {
                    let scene = base.scaled(factor);
                    let image = draw(&gpu, &scene, spec, &model, [256, 192]);
                    // At a silhouette the scaled triangle may miss a pixel's centre: the exact image shows it.
                    let same: Vec<bool> = exact
                        .pixels
                        .iter()
                        .zip(&draw_exact(&gpu, &scene).pixels)
                        .map(|(a, b)| (0..4).all(|k| (a[k] - b[k]).abs() < 1e-4))
                        .collect();
                    assert!(same.iter().filter(|s| **s).count() > same.len() * 9 / 10);
                    let pairs = reference.pixels.iter().zip(&image.pixels);
                    let display = |x: f32| peelnet_core::srgb::encode(x.clamp(0.0, 1.0)) * 255.0;
                    let differences =
                        pairs
                            .zip(&same)
                            .filter(|(_, same)| **same)
                            .map(|((a, b), _)| {
                                (0..3).fold(0.0, |d: f32, k| {
                                    d.max((display(a[k]) - display(b[k])).abs())
                                })
                            });
                    let worst = differences.fold(0.0, f32::max);
                    println!("{file}, {spec}, times {factor}: {worst}/255");
                    assert!(worst <= 1.0, "{file}, {spec}, times {factor}: {worst}/255");
                }
            }
        }
    }
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
        for recipe in LEARNED {
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
        (Recipe::SMALL, 150),
        (Recipe::MEDIUM, 150),
        (Recipe::LARGE, 200),
        (Recipe::ANCHORED_SMALL, 80),
        (Recipe::ANCHORED_MEDIUM, 150),
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
    for recipe in LEARNED {
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
