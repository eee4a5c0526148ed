//! Effects of materials and lights: they cost nothing in a scene without them, and neutral values change nothing.

use crate::splats::{ONE, One, cloud};
use glam::Vec3;
use peelnet_render::Renderer;
use peelnet_scene::{
    Blending, EFFECTS, Effect, Light, Lighting, Material, MaterialFlags, Scene, SceneFeatures,
    Source,
};
use peelnet_tests::{assert_alike, draw, even, gpu, light, opaque, prepare, scene, wall};
use std::sync::Arc;

/// The effect that another one needs, so that it shows.
fn needs(effect: &Effect) -> Option<&'static Effect> {
    match effect.name {
        "lighting" | "pbr" => None,
        "metallic-roughness-map" => Effect::find("pbr"),
        "emissive-map" => Effect::find("emission"),
        _ if effect.flag.needs_light() => Effect::find("lighting"),
        _ => None,
    }
}

/// Gives a scene an effect: its first surface, so that it shows, as far as it has one; or with values that change nothing.
fn add(effect: &Effect, all: &mut Scene, neutral: bool) {
    let either = |shown: [f32; 3], unseen: f32| if neutral { [unseen; 3] } else { shown };
    let object = &mut all.objects[0];
    let material = &mut object.materials[0];
    match effect.name {
        // Behind everything, of the background's colour.
        "opaque" if neutral => all.objects.push(wall(50.0, opaque(all.background))),
        "opaque" => (material.alpha, material.blend) = (1.0, false),
        "culling" => material.double_sided = false,
        "lighting" | "pbr" => {
            let (kind, ambient) = match effect.name {
                "pbr" => (Lighting::Pbr, 0.03),
                _ => (Lighting::Phong, 0.1),
            };
            material.lighting = kind;
            if neutral {
                // Radiance that is the colour: ambient light alone, of a colour that makes up for its share.
                material.color = material.color.map(|c| c / ambient);
            }
            all.lights = vec![light(Vec3::new(1.0, 1.0, 0.0), either([1.0; 3], 0.0))];
        }
        "cutout" if neutral => all.objects[1].materials[0].alpha_cutoff = Some(0.5),
        "cutout" => (material.alpha_cutoff, material.blend) = (Some(0.3), false),
        "low-resolution" => all.transparency_scale = 0.5,
        "vertex-colors" => {
            let [r, g, b] = either([0.5, 1.0, 0.25], 1.0);
            let mesh = Arc::make_mut(&mut object.mesh);
            mesh.colors = vec![[r, g, b, 1.0]; mesh.positions.len()];
        }
        "directional-light" => all.lights.push(Light {
            source: Source::Toward(Vec3::Z),
            ..light(Vec3::ZERO, either([1.0; 3], 0.0))
        }),
        "splats" => all.objects.push(cloud(&[One {
            opacity: if neutral { 0.0 } else { 0.5 },
            ..ONE
        }])),
        "display-space" => all.blending = Blending::Display,
        "monochrome" => {
            material.color = [0.6; 3];
            all.objects[1].materials[0].color = [0.3; 3];
            all.background = [0.1; 3];
        }
        name => {
            // A number that switches it on.
            if let Some(number) = effect.number() {
                let value = if neutral { 1e-9 } else { 0.5 };
                (number.values_mut)(material).fill(value);
                return;
            }
            let maps = &mut material.maps;
            let place = match name {
                "normal-map" => &mut maps.normal,
                "metallic-roughness-map" => &mut maps.metallic_roughness,
                "occlusion-map" => &mut maps.occlusion,
                "emissive-map" => &mut maps.emissive,
                _ => &mut maps.color,
            };
            *place = even(match (neutral, name) {
                (false, _) => [200, 150, 220, 255],
                (true, "normal-map") => [128, 128, 255, 255],
                (true, _) => [255; 4],
            });
        }
    }
}

/// A scene with one effect, beside a plain surface.
fn scene_with(effect: Option<&Effect>) -> Scene {
    let wall = |z, color, alpha| wall(z, Material::unlit(color, alpha));
    let objects = vec![
        wall(3.0, [0.9, 0.4, 0.2], 0.6),
        wall(5.0, [0.1, 0.9, 0.4], 0.5),
    ];
    let mut all = scene("effects", [0.1, 0.2, 0.3], objects);
    for effect in [effect.and_then(needs), effect].into_iter().flatten() {
        add(effect, &mut all, false);
    }
    all
}

/// What each effect brings with it, and the one that it needs: bindings, attributes of vertices, and text that only it links.
/// An effect that a number switches on brings that number's text, and what the effect brings that it needs.
const BROUGHT: &str = "
    opaque | opaque depth | |
    culling | | |
    lighting | lights | normal | lights halfway world
    pbr | lights | normal | lights fresnel world
    cutout | opaque depth | | is_hole
    color-map | sampler, color-map | uv | color_map textureSampleGrad
    normal-map | lights, sampler, normal-map | uv, tangent, normal | normal_map tangent
    metallic-roughness-map | lights, sampler, metallic-roughness-map | uv, normal | metallic_roughness_map
    occlusion-map | lights, sampler, occlusion-map | uv, normal | occlusion_map
    emissive-map | sampler, emissive-map | uv | emissive_map
    vertex-colors | | color | surface.color
    directional-light | lights | normal | light.is_point
    splats | splats, harmonics | splat | gaussian
    display-space | | | shown_of
    monochrome | | |
    low-resolution | | |";

fn brought(effect: &Effect) -> Vec<String> {
    if let Some(number) = effect.number() {
        let mut row = needs(effect).map_or(vec![String::new(); 3], brought);
        row[2] = format!("material.{}", number.field);
        return row;
    }
    let mut rows = BROUGHT.lines().map(|line| line.split('|').map(str::trim));
    let row = rows.find_map(|mut row| (row.next() == Some(effect.name)).then_some(row));
    row.unwrap().map(str::to_owned).collect()
}

/// What an effect brings with it is built where a scene needs it and only there: bindings, targets, passes, and the text of the
/// shaders that the pipelines are made of.
#[test]
fn what_is_not_called_for_is_not_there() {
    let gpu = gpu();
    // Bytes of a pixel, and passes.
    let costs = |s: &Scene| {
        let renderer = Renderer::new(&gpu, s).unwrap();
        let mut prepared = prepare(&renderer, "blended", [8, 6]);
        let frame = renderer.profile(&mut prepared, &s.views[0]).unwrap();
        (frame.stats.bytes_per_pixel, frame.times.len())
    };
    let (least, fewest) = costs(&scene_with(None));
    let plain = SceneFeatures::new(&scene_with(None)).variants;
    assert_eq!(plain.len(), 1);
    for effect in EFFECTS {
        let row = brought(effect);
        let with = scene_with(Some(effect));
        let features = SceneFeatures::new(&with);
        // What comes with it; a surface with holes is drawn with the opaque ones.
        let is_expected = |e: &&Effect| {
            let with_holes = (effect.name, e.name) == ("cutout", "opaque");
            *e == effect || needs(effect) == Some(*e) || with_holes
        };
        let expected = EFFECTS.iter().filter(is_expected);
        let on = features.effects.iter().filter(|e| e.on).map(|e| e.name);
        assert!(on.eq(expected.map(|e| e.name)), "{effect}");
        let stripped = with.without(effect);
        assert!(!SceneFeatures::new(&stripped).has(effect), "{effect}");
        // Without a light there is nothing to compute.
        let mut dark = with.clone();
        dark.lights.clear();
        assert!(with.lights.is_empty() || !SceneFeatures::new(&dark).has(effect));
        // One plain object keeps the text of its shader, whatever another one needs; but all blend in one space.
        let of_all = effect.name == "display-space";
        assert!(of_all || features.variants.contains(&plain[0]), "{effect}");
        assert!(features.variants.len() <= 2, "{effect}");
        let renderer = Renderer::new(&gpu, &with).unwrap();
        let bindings = renderer.bindings();
        assert_eq!(bindings[..2], ["camera", "materials"], "{effect}");
        assert_eq!(bindings[2..].join(", "), row[0], "{effect}");
        let attributes = renderer.vertex_attributes();
        assert_eq!(attributes[..2], ["position", "material"], "{effect}");
        assert_eq!(attributes[2..].join(", "), row[1], "{effect}");
        let (bytes, passes) = costs(&with);
        // Without a scale every frame of this method has the same targets, but for grey, which has one less.
        if effect.name != "low-resolution" {
            assert_eq!(bytes < least, effect.name == "monochrome", "{effect}");
        }
        assert_eq!(passes > fewest, effect.name == "low-resolution", "{effect}");
        let text_of = |scene: &Scene| -> String {
            let variants = SceneFeatures::new(scene).variants.into_iter();
            let texts = variants.map(|v| {
                let shaders = ["methods::blended::gather", "scene::opaque"];
                let shader = shaders[usize::from(v.contains(MaterialFlags::CUTOUT))];
                let linked = peelnet_render::shaders::link(shader, &v.features(), &[]);
                linked.unwrap().text.clone()
            });
            texts.collect()
        };
        let [with, without] = [text_of(&with), text_of(&stripped)];
        for word in row[2].split_whitespace() {
            assert!(with.contains(word), "{effect}: {word}");
            assert!(!without.contains(word), "{effect}: {word}");
        }
    }
}

/// A scene, and the same with an effect that changes nothing.
fn neutral(effect: &Effect) -> [Scene; 2] {
    let mut plain = scene_with(needs(effect));
    let mut with = plain.clone();
    match effect.name {
        "cutout" => {
            plain.objects[1] = wall(5.0, opaque([0.1, 0.9, 0.4]));
            with = plain.clone();
        }
        "display-space" => {
            // Of one colour all mixtures are that, in either space.
            for object in &mut plain.objects {
                object.materials[0].color = plain.background;
            }
            with = plain.clone();
        }
        "monochrome" => {
            with = scene_with(Some(effect));
            plain = with.without(effect);
        }
        _ => {}
    }
    add(effect, &mut with, true);
    [plain, with]
}

/// Effects with neutral values leave the image as it is, within a step of an 8-bit display; and a scene without an effect is, bit
/// for bit, the scene that never had it.
#[test]
fn neutral_values_change_nothing() {
    let gpu = gpu();
    let size = [16, 12];
    for effect in EFFECTS {
        let [plain, with] = neutral(effect);
        let on = |scene: &Scene| SceneFeatures::new(scene).has(effect);
        assert!(on(&with) && !on(&plain), "{effect}");
        for method in ["abuffer", "wboit-eq9", "mboit4", "dual-peel"] {
            let [a, b] = [&plain, &with].map(|scene| draw(&gpu, scene, method, size).pixels);
            assert_alike(&a, &b, 1.0 / 255.0, format!("{effect}, {method}"));
        }
        // What is lit cannot be drawn by its colour instead.
        if !matches!(effect.name, "lighting" | "pbr") {
            let stripped = draw(&gpu, &with.without(effect), "wboit-eq9", size);
            assert_eq!(stripped, draw(&gpu, &plain, "wboit-eq9", size), "{effect}");
        }
    }
}
