//! Each effect is needed by just the scenes that have its cause.

use super::*;
use crate::{suite, texture::Texture};
use glam::Vec3;

fn scene(material: Material) -> Scene {
    let triangle = [[Vec3::ZERO, Vec3::X, Vec3::Y]];
    let camera = suite::load("boxes").expect("ships").views[0];
    let object = Object::of_triangles("thing", &triangle, material);
    Scene::generated("one", "a test", [0.0; 3], camera, vec![object])
}

/// A material without effects.
fn plain() -> Material {
    Material::unlit([0.5, 0.4, 0.5], 0.5)
}

/// Adds the cause of an effect to a scene; returns the effects that come with it.
fn add(effect: Effect, scene: &mut Scene) -> &'static [&'static str] {
    let texture = Texture::of("red", [1, 1], |_, _| [255, 0, 0, 255]);
    let texture = Some(std::sync::Arc::new(texture));
    let object = &mut scene.objects[0];
    let material = &mut object.materials[0];
    match effect {
        Effect::Opaque => (material.alpha, material.blend) = (1.0, false),
        Effect::Culling => material.double_sided = false,
        Effect::Lighting | Effect::Sun => material.lighting = Lighting::Phong,
        Effect::Pbr => material.lighting = Lighting::Pbr,
        Effect::Cutout => (material.alpha_cutoff, material.blend) = (Some(0.4), false),
        Effect::Emission => material.emission = [0.0, 0.1, 0.0],
        Effect::ColorMap => material.maps.color = texture,
        Effect::NormalMap => {
            (material.maps.normal, material.lighting) = (texture, Lighting::Phong);
        }
        Effect::OcclusionMap => {
            (material.maps.occlusion, material.lighting) = (texture, Lighting::Phong);
        }
        Effect::MetallicRoughnessMap => {
            (material.maps.metallic_roughness, material.lighting) = (texture, Lighting::Pbr);
        }
        Effect::EmissiveMap => {
            (material.maps.emissive, material.emission) = (texture, [0.0, 0.1, 0.0]);
        }
        Effect::VertexColors => {
            let mut mesh = (*object.mesh).clone();
            mesh.colors = vec![[1.0, 0.0, 0.0, 1.0]; 3];
            object.mesh = mesh.into();
        }
        Effect::Transmission => material.transmission = [0.0, 0.5, 0.0],
        Effect::Monochrome => material.color = [0.25; 3],
        Effect::LowResolution => scene.transparency_scale = 0.5,
    }
    match effect {
        Effect::NormalMap | Effect::OcclusionMap | Effect::Sun => &["lighting"],
        Effect::MetallicRoughnessMap => &["pbr"],
        Effect::EmissiveMap => &["emission"],
        // A surface with holes is drawn with the opaque ones.
        Effect::Cutout => &["opaque"],
        _ => &[],
    }
}

/// Names of the effects that are on.
fn on(scene: &Scene) -> Vec<&str> {
    let on = Census::of(scene).effects.into_iter().filter(|e| e.on);
    on.map(|e| e.name).collect()
}

#[test]
fn each_effect_has_its_cause() {
    for effect in Effect::ALL {
        let mut scene = scene(plain());
        assert!(!Census::of(&scene).has(effect), "{effect}");
        let mut expected = add(effect, &mut scene).to_vec();
        expected.push(effect.name());
        if scene.objects[0].materials[0].lighting != Lighting::Unlit {
            // Without a light there is nothing to compute.
            assert!(!Census::of(&scene).has(effect), "{effect}");
            let mut light = |source| {
                scene.lights.push(Light {
                    source,
                    color: [1.0; 3],
                    intensity: 1.0,
                });
            };
            light(Source::Point(Vec3::ONE));
            if effect == Effect::Sun {
                light(Source::Toward(Vec3::Y));
            }
        }
        let mut found = on(&scene);
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected, "{effect}");
        let without = scene.without(effect);
        assert!(!on(&without).contains(&effect.name()), "{effect}");
    }
}
