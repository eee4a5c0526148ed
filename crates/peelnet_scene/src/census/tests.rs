//! Each effect is needed by just the scenes that have its cause.

use super::*;
use crate::{camera::Camera, texture::Texture};
use glam::Vec3;

fn scene(material: Material) -> Scene {
    let triangle = [[Vec3::ZERO, Vec3::X, Vec3::Y]];
    let camera = Camera {
        position: Vec3::Z,
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov_y_degrees: 45.0,
        near: 0.1,
        far: 10.0,
    };
    let object = Object::of_triangles("thing", &triangle, material);
    Scene::generated("one", "a test", [0.0; 3], camera, vec![object])
}

/// A material without effects.
fn plain() -> Material {
    Material::unlit([0.5, 0.4, 0.5], 0.5)
}

/// A material that needs an effect, as far as a material can, and the effects that come with it.
fn material_with(effect: Effect) -> (Material, Vec<&'static str>) {
    let texture = || {
        let texture = Texture::of("red", [1, 1], |_, _| [255, 0, 0, 255]);
        Some(std::sync::Arc::new(texture))
    };
    let mut material = plain();
    let maps = &mut material.maps;
    let mut others = Vec::new();
    match effect {
        Effect::Opaque => (material.alpha, material.blend) = (1.0, false),
        Effect::Culling => material.double_sided = false,
        Effect::Lighting => material.lighting = Lighting::Phong,
        Effect::Pbr => material.lighting = Lighting::Pbr,
        Effect::Cutout => {
            (material.alpha_cutoff, material.blend) = (Some(0.4), false);
            // A surface with holes is drawn with the opaque ones.
            others.push("opaque");
        }
        Effect::Emission => material.emission = [0.0, 0.1, 0.0],
        Effect::ColorMap => maps.color = texture(),
        Effect::NormalMap | Effect::OcclusionMap => {
            match effect {
                Effect::NormalMap => maps.normal = texture(),
                _ => maps.occlusion = texture(),
            }
            material.lighting = Lighting::Phong;
            others.push("lighting");
        }
        Effect::MetallicRoughnessMap => {
            maps.metallic_roughness = texture();
            material.lighting = Lighting::Pbr;
            others.push("pbr");
        }
        Effect::EmissiveMap => {
            maps.emissive = texture();
            material.emission = [0.0, 0.1, 0.0];
            others.push("emission");
        }
        Effect::Sun => {
            material.lighting = Lighting::Phong;
            others.push("lighting");
        }
        Effect::Transmission => material.transmission = [0.0, 0.5, 0.0],
        Effect::Monochrome => material.color = [0.25; 3],
        Effect::VertexColors | Effect::LowResolution => {}
    }
    (material, others)
}

/// Names of the effects that are on.
fn on(scene: &Scene) -> Vec<&str> {
    let on = Census::of(scene).effects.into_iter().filter(|e| e.on);
    on.map(|e| e.name).collect()
}

#[test]
fn each_effect_has_its_cause() {
    for effect in Effect::ALL {
        assert!(!Census::of(&scene(plain())).has(effect), "{effect}");
        let (material, mut expected) = material_with(effect);
        let is_lit = material.lighting != Lighting::Unlit;
        let mut scene = scene(material);
        if is_lit {
            // Without a light there is nothing to compute.
            assert!(!Census::of(&scene).has(effect), "{effect}");
        }
        let light = Light {
            source: Source::Point(Vec3::ONE),
            color: [1.0; 3],
            intensity: 1.0,
        };
        if effect == Effect::Sun {
            scene.lights.push(Light {
                source: Source::Toward(Vec3::Y),
                ..light
            });
        }
        scene.lights.extend(is_lit.then_some(light));
        if effect == Effect::VertexColors {
            let mut mesh = (*scene.objects[0].mesh).clone();
            mesh.colors = vec![[1.0, 0.0, 0.0, 1.0]; 3];
            scene.objects[0].mesh = mesh.into();
        }
        if effect == Effect::LowResolution {
            scene.transparency_scale = 0.5;
        }
        expected.push(effect.name());
        expected.sort_unstable();
        let mut found = on(&scene);
        found.sort_unstable();
        assert_eq!(found, expected, "{effect}");
        assert!(
            !on(&scene.without(effect)).contains(&effect.name()),
            "{effect}"
        );
    }
}
