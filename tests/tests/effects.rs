//! The effects that a scene may call for: absent where it does not, neutral where they are, and right where they are not.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use glam::Vec3;
use peelnet_core::{
    fragment::Fragment,
    guards::EMISSIVE_ALPHA,
    methods::over,
    shading::{self, Point, PointLight},
};
use peelnet_gpu::Gpu;
use peelnet_render::{Image, MethodSpec, Renderer};
use peelnet_scene::{Census, Effect, Light, Lighting, Material, Scene};
use peelnet_tests::{gpu, scene, wall};

fn draw(gpu: &Gpu, scene: &Scene, method: &str, size: [u32; 2]) -> Image {
    let renderer = Renderer::new(gpu, scene).unwrap();
    let mut prepared = renderer
        .prepare(&method.parse().unwrap(), size, None)
        .unwrap();
    renderer.draw(&mut prepared, &scene.views[0]).unwrap().image
}

fn light(position: Vec3, color: [f32; 3]) -> Light {
    Light {
        position,
        color,
        intensity: 1.5,
    }
}

/// A scene that calls for one effect, beside a plain one.
fn scene_with(effect: Option<Effect>) -> Scene {
    let mut material = Material::unlit([0.9, 0.4, 0.2], 0.6);
    let mut all = scene("effects", [0.1, 0.2, 0.3], vec![]);
    match effect {
        None => {}
        Some(Effect::Opaque) => (material.alpha, material.blend) = (1.0, false),
        Some(Effect::Culling) => material.double_sided = false,
        Some(Effect::Lighting) => material.lighting = Lighting::Phong,
        Some(Effect::Pbr) => material.lighting = Lighting::Pbr,
        Some(Effect::Cutout) => material.alpha_cutoff = Some(0.3),
        Some(Effect::Emission) => material.emission = [0.2, 0.0, 0.1],
        Some(Effect::LowResolution) => all.transparency_scale = 0.5,
    }
    if matches!(effect, Some(Effect::Lighting | Effect::Pbr)) {
        all.lights.push(light(Vec3::new(1.0, 1.0, 0.0), [1.0; 3]));
    }
    all.objects.push(wall(3.0, material));
    all.objects
        .push(wall(5.0, Material::unlit([0.1, 0.9, 0.4], 0.5)));
    all
}

/// What an effect brings with it is built where a scene calls for it and only there: bindings, targets, passes, and the text of the
/// shaders that the pipelines are made of.
#[test]
fn what_is_not_called_for_is_not_there() {
    let gpu = gpu();
    let plain = Renderer::new(&gpu, &scene_with(None)).unwrap();
    assert_eq!(plain.bindings(), ["camera", "materials"]);
    let passes = |s: &Scene| {
        let renderer = Renderer::new(&gpu, s).unwrap();
        let mut prepared = renderer
            .prepare(&"blended".parse().unwrap(), [8, 6], None)
            .unwrap();
        let (times, _) = renderer.time(&mut prepared, &s.views[0]).unwrap();
        times.len()
    };
    let fewest = passes(&scene_with(None));
    for effect in Effect::ALL {
        let with = scene_with(Some(effect));
        let census = Census::of(&with);
        assert!(census.has(effect), "{effect}");
        let bindings = Renderer::new(&gpu, &with).unwrap().bindings();
        let lit = matches!(effect, Effect::Lighting | Effect::Pbr);
        assert_eq!(bindings.contains(&"lights"), lit, "{effect}");
        let opaque = matches!(effect, Effect::Opaque | Effect::Cutout);
        assert_eq!(bindings.contains(&"opaque depth"), opaque, "{effect}");
        assert_eq!(
            passes(&with) > fewest,
            effect == Effect::LowResolution,
            "{effect}"
        );
        // The text that only this effect links.
        let words: &[&str] = match effect {
            Effect::Lighting => &["lights", "halfway", "world"],
            Effect::Pbr => &["lights", "fresnel", "world"],
            Effect::Emission => &["emission.rgb"],
            Effect::Cutout => &["is_hole"],
            _ => &[],
        };
        let text_of = |scene: &Scene| -> String {
            let variants = Census::of(scene).variants.into_iter();
            let texts = variants.map(|v| {
                let shader = if v.cutout {
                    "scene::opaque"
                } else {
                    "methods::blended::gather"
                };
                peelnet_shaders::link(shader, &v.features(), &[]).unwrap()
            });
            texts.collect()
        };
        let [with, without] = [text_of(&with), text_of(&with.without(effect))];
        for word in words {
            assert!(with.contains(word), "{effect}: {word}");
            assert!(!without.contains(word), "{effect}: {word}");
        }
    }
}

/// One plain object keeps the text of its shader, whatever another one calls for.
#[test]
fn an_effect_changes_only_what_it_names() {
    let plain = Census::of(&scene_with(None)).variants;
    assert_eq!(plain.len(), 1);
    for effect in Effect::ALL {
        let variants = Census::of(&scene_with(Some(effect))).variants;
        assert!(variants.contains(&plain[0]), "{effect}");
        assert!(variants.len() <= 2, "{effect}");
    }
}

/// Effects with neutral values leave the image as it is, within a step of an 8-bit display; and a scene without an effect is, bit
/// for bit, the scene that never had it.
#[test]
fn neutral_values_change_nothing() {
    let gpu = gpu();
    let size = [16, 12];
    let base = scene_with(None);
    let mut solid = base.clone();
    solid.objects[1] = wall(
        5.0,
        Material {
            blend: false,
            ..Material::unlit([0.1, 0.9, 0.4], 1.0)
        },
    );
    for effect in Effect::ALL {
        let (mut neutral, plain) = match effect {
            Effect::Cutout => (solid.clone(), &solid),
            _ => (base.clone(), &base),
        };
        match effect {
            // Behind everything, of the background's colour.
            Effect::Opaque => {
                let material = Material {
                    blend: false,
                    ..Material::unlit(base.background, 1.0)
                };
                neutral.objects.push(wall(50.0, material));
            }
            Effect::Culling => neutral.objects[0].materials[0].double_sided = false,
            // Radiance that is the colour: ambient light alone, of a colour that makes up for its share.
            Effect::Lighting | Effect::Pbr => {
                neutral.lights.push(light(Vec3::ZERO, [0.0; 3]));
                let (kind, ambient) = match effect {
                    Effect::Pbr => (Lighting::Pbr, 0.03),
                    _ => (Lighting::Phong, 0.1),
                };
                let m = &mut neutral.objects[0].materials[0];
                m.lighting = kind;
                m.color = m.color.map(|c| c / ambient);
            }
            Effect::Cutout => neutral.objects[1].materials[0].alpha_cutoff = Some(0.5),
            Effect::Emission => neutral.objects[0].materials[0].emission = [1e-9; 3],
            Effect::LowResolution => neutral.transparency_scale = 0.5,
        }
        assert!(Census::of(&neutral).has(effect), "{effect}");
        for method in ["abuffer", "wboit-eq9", "mboit4", "dual-peel"] {
            let [a, b] = [
                draw(&gpu, plain, method, size),
                draw(&gpu, &neutral, method, size),
            ];
            for (a, b) in a.pixels.iter().zip(&b.pixels) {
                for k in 0..3 {
                    assert!(
                        (a[k] - b[k]).abs() <= 1.0 / 255.0,
                        "{effect}, {method}: {a:?} {b:?}"
                    );
                }
            }
        }
        if !matches!(effect, Effect::Lighting | Effect::Pbr) {
            let stripped = draw(&gpu, &neutral.without(effect), "wboit-eq9", size);
            assert_eq!(stripped, draw(&gpu, plain, "wboit-eq9", size), "{effect}");
        }
    }
}

/// Lit surfaces against the 64-bit twin, pixel by pixel: 1e-4 of the brightest.
#[test]
fn shading_is_the_twin_of_the_core() {
    let gpu = gpu();
    let size = [24u32, 16];
    let lights = [
        light(Vec3::new(1.0, 1.5, -0.5), [2.0, 1.0, 0.5]),
        light(Vec3::new(-2.0, 0.3, -1.0), [0.2, 0.9, 3.0]),
    ];
    let color = [0.8, 0.5, 0.3];
    for lighting in [Lighting::Phong, Lighting::Pbr] {
        for (first, second) in [(0.0, 0.05), (0.0, 0.5), (0.4, 0.3), (1.0, 0.2), (1.0, 1.0)] {
            let mut material = Material::unlit(color, 0.5);
            material.lighting = lighting;
            (material.specular, material.shininess) = (first, 1.0 + 60.0 * second);
            (material.metallic, material.roughness) = (first, second);
            let mut scene = scene("lit", [0.0; 3], vec![wall(3.0, material.clone())]);
            scene.lights = lights.to_vec();
            let image = draw(&gpu, &scene, "abuffer", size);
            let points: Vec<PointLight> = lights
                .iter()
                .map(|l| PointLight {
                    position: l.position.as_dvec3().to_array(),
                    color: l.color.map(|c| f64::from(c) * f64::from(l.intensity)),
                })
                .collect();
            for (i, pixel) in image.pixels.iter().enumerate() {
                let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
                let aspect = f64::from(size[0]) / f64::from(size[1]);
                let ndc_x = (f64::from(x) + 0.5) / f64::from(size[0]) * 2.0 - 1.0;
                let ndc_y = 1.0 - (f64::from(y) + 0.5) / f64::from(size[1]) * 2.0;
                let at = Point {
                    position: [ndc_x * aspect * 3.0, ndc_y * 3.0, -3.0],
                    normal: [0.0, 0.0, 1.0],
                    eye: [0.0; 3],
                };
                let c = color.map(f64::from);
                let (first, second) = (f64::from(first), f64::from(second));
                let want = match lighting {
                    Lighting::Phong => {
                        shading::phong(&at, c, first, material.shininess.into(), &points)
                    }
                    _ => shading::physically_based(&at, c, first, second, &points),
                };
                for k in 0..3 {
                    let error = (f64::from(pixel[k]) - 0.5 * want[k]).abs();
                    assert!(
                        error <= 1e-4 * want[k].max(1.0),
                        "{lighting:?} {first} {second}: {pixel:?} for {want:?}"
                    );
                }
            }
        }
    }
}

/// What is emitted comes beyond what is covered, for every method: a single surface is exact, down to an opacity of 0, where it
/// covers 2⁻¹⁰ so that weighted sums and 16-bit targets know of it.
///
/// Half floats of sums up to 4: two roundings of 2⁻¹¹ each, and as many of what divides them.
#[test]
fn emission_is_exact_on_a_single_surface() {
    let gpu = gpu();
    let c0 = [0.3, 0.2, 0.1];
    for alpha in [0.0, 0.01, 0.5, 1.0] {
        let mut material = Material::unlit([0.2, 0.6, 0.4], alpha);
        material.emission = [0.5, 0.0, 2.0];
        let scene = scene("lamp", c0, vec![wall(3.0, material.clone())]);
        let covered = alpha.max(EMISSIVE_ALPHA);
        let beyond = |k: usize| material.color[k] + material.emission[k] / covered;
        let f = Fragment::new(3.0, covered, [beyond(0), beyond(1), beyond(2)]);
        let want = over::composite(&[f], c0);
        for spec in MethodSpec::all() {
            // Of few samples none may see a faint one; a coverage of 0.01 in half floats errs by a twentieth.
            if matches!(spec.name(), "stochastic" | "wavelet-3") && alpha < 0.5 {
                continue;
            }
            // Weights that grow with the opacity leave half floats nothing of a faint one.
            let has_targets = spec.entry().knobs().any(|(knob, _)| knob == "targets");
            let full = alpha < 0.5 && has_targets;
            let method = format!("{spec}{}", if full { ":targets=f32" } else { "" });
            let image = draw(&gpu, &scene, &method, [4, 3]);
            let bound = if spec.entry().exact {
                1e-5
            } else {
                4.0 * 4.0 / 2048.0
            };
            for p in &image.pixels {
                for k in 0..3 {
                    assert!(
                        (p[k] - want[k]).abs() <= bound,
                        "{spec}, alpha {alpha}: {p:?} for {want:?}"
                    );
                }
            }
        }
    }
}

/// An alpha below the cut-off is a hole, one above it is opaque, whatever it is.
#[test]
fn cut_outs_are_holes_or_opaque() {
    let gpu = gpu();
    for (alpha, whole) in [(0.29, false), (0.31, true), (1.0, true)] {
        let material = Material {
            alpha_cutoff: Some(0.3),
            ..Material::unlit([0.9, 0.5, 0.1], alpha)
        };
        let behind = wall(5.0, Material::unlit([0.0, 0.0, 1.0], 0.5));
        let scene = scene("holes", [0.2; 3], vec![wall(3.0, material), behind]);
        let want = if whole {
            [0.9, 0.5, 0.1]
        } else {
            [0.1, 0.1, 0.6]
        };
        for method in ["abuffer", "wboit-eq9", "kbuffer-4"] {
            let p = draw(&gpu, &scene, method, [4, 3]).pixels[5];
            for k in 0..3 {
                assert!((p[k] - want[k]).abs() < 1e-3, "{method} {alpha}: {p:?}");
            }
        }
    }
}
