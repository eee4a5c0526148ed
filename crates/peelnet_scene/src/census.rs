//! The census: which effects a scene calls for, and what asks for each. A renderer builds what the census names and nothing else.

use crate::{Lighting, Material, Scene};
use serde::Serialize;
use std::fmt;

/// What a material calls for of the pipeline that draws it: each that a scene holds has a pipeline of its own in every pass, and
/// no shader asks a material what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// How it answers to light; unlit where there is none.
    pub lighting: Lighting,
    /// Whether it emits.
    pub emissive: bool,
    /// Whether it has holes.
    pub cutout: bool,
    /// Whether back faces are left out.
    pub culled: bool,
}

impl Variant {
    /// A material's, in a scene that has lights or none.
    pub fn of(material: &Material, lit: bool) -> Self {
        Self {
            lighting: if lit {
                material.lighting
            } else {
                Lighting::Unlit
            },
            emissive: material.is_emissive(),
            cutout: material.alpha_cutoff.is_some_and(|cutoff| cutoff > 0.0),
            culled: !material.double_sided,
        }
    }

    /// Whether normals, positions and lights are read.
    pub fn is_lit(self) -> bool {
        self.lighting != Lighting::Unlit
    }

    /// The shader features that it links.
    pub fn features(self) -> Vec<&'static str> {
        let lighting: &[&str] = match self.lighting {
            Lighting::Unlit => &[],
            Lighting::Phong => &["lit", "phong"],
            Lighting::Pbr => &["lit", "pbr"],
        };
        let mut all = lighting.to_vec();
        all.extend(self.emissive.then_some("emission"));
        all.extend(self.cutout.then_some("cutout"));
        all
    }
}

/// Something that a renderer does only where a scene calls for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Opaque surfaces.
    Opaque,
    /// Surfaces that show one side only.
    Culling,
    /// Blinn–Phong.
    Lighting,
    /// Cook–Torrance.
    Pbr,
    /// Holes where opacity is low.
    Cutout,
    /// Light that comes from a surface itself.
    Emission,
    /// Transparency at a lower resolution.
    LowResolution,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Opaque,
        Self::Culling,
        Self::Lighting,
        Self::Pbr,
        Self::Cutout,
        Self::Emission,
        Self::LowResolution,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Culling => "culling",
            Self::Lighting => "lighting",
            Self::Pbr => "pbr",
            Self::Cutout => "cutout",
            Self::Emission => "emission",
            Self::LowResolution => "low-resolution",
        }
    }

    /// What it adds to a frame.
    pub const fn adds(self) -> &'static str {
        match self {
            Self::Opaque => {
                "its draws in the background pass, a depth target of 4 bytes a pixel, a comparison in transparent passes"
            }
            Self::Culling => "nothing: back faces are not rasterised",
            Self::Lighting => {
                "normals and positions, a binding of lights, Blinn–Phong in the shader"
            }
            Self::Pbr => "normals and positions, a binding of lights, Cook–Torrance in the shader",
            Self::Cutout => "a comparison and a discard in the pipelines of these materials",
            Self::Emission => "an addition in the pipelines of these materials",
            Self::LowResolution => {
                "two passes over the pixels and 36 bytes a sample; fewer samples for everything transparent"
            }
        }
    }

    fn is_called_by(self, material: &Material, variant: Variant) -> bool {
        match self {
            Self::Opaque => material.is_opaque(),
            Self::Culling => variant.culled,
            Self::Lighting => variant.lighting == Lighting::Phong,
            Self::Pbr => variant.lighting == Lighting::Pbr,
            Self::Cutout => variant.cutout,
            Self::Emission => variant.emissive,
            Self::LowResolution => false,
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Whether an effect is on, and who asked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Called {
    /// The effect's name.
    pub name: &'static str,
    /// Whether anything asks for it.
    pub on: bool,
    /// What asks: names of objects, or a key of the scene.
    pub why: Vec<String>,
    /// What it adds to a frame.
    pub adds: &'static str,
}

/// What a scene calls for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Census {
    /// Every effect there is.
    pub effects: Vec<Called>,
    /// The variants of its materials: as many pipelines are in a pass over the surfaces, opaque and transparent ones apart, at most.
    pub variants: Vec<Variant>,
}

impl Census {
    /// Takes the census of a scene.
    pub fn of(scene: &Scene) -> Self {
        let lit = !scene.lights.is_empty();
        let mut variants: Vec<Variant> = Vec::new();
        let materials = scene.objects.iter().flat_map(|object| {
            let materials = object.mesh.parts.iter().zip(&object.materials);
            // A part without triangles calls for nothing.
            let drawn = materials.filter(|(part, _)| !part.triangles.is_empty());
            drawn.map(|(_, material)| (object.name.as_str(), material))
        });
        let mut why: Vec<Vec<String>> = vec![Vec::new(); Effect::ALL.len()];
        for (object, material) in materials {
            let variant = Variant::of(material, lit);
            if !variants.contains(&variant) {
                variants.push(variant);
            }
            for (effect, why) in Effect::ALL.iter().zip(&mut why) {
                if effect.is_called_by(material, variant) && !why.iter().any(|w| w == object) {
                    why.push(object.to_owned());
                }
            }
        }
        let mut effects: Vec<Called> = Effect::ALL
            .iter()
            .zip(why)
            .map(|(effect, why)| Called {
                name: effect.name(),
                on: !why.is_empty(),
                why,
                adds: effect.adds(),
            })
            .collect();
        if scene.transparency_scale < 1.0 {
            for effect in effects.iter_mut().filter(|e| e.name == "low-resolution") {
                effect.on = true;
                effect.why = vec![format!("transparency_scale = {}", scene.transparency_scale)];
            }
        }
        Self { effects, variants }
    }

    /// Whether an effect is on.
    pub fn has(&self, effect: Effect) -> bool {
        let mut of = self.effects.iter();
        of.any(|e| e.name == effect.name() && e.on)
    }
}

impl Scene {
    /// The scene as it would be if nothing called for an effect: what opaque objects leave is empty, what was lit is unlit.
    pub fn without(&self, effect: Effect) -> Self {
        let mut scene = self.clone();
        if effect == Effect::LowResolution {
            scene.transparency_scale = 1.0;
        }
        if effect == Effect::Opaque {
            let opaque = |m: &Material| m.is_opaque();
            scene.objects.retain(|o| !o.materials.iter().all(opaque));
        }
        for m in scene.objects.iter_mut().flat_map(|o| &mut o.materials) {
            match effect {
                Effect::Culling => m.double_sided = true,
                Effect::Lighting if m.lighting == Lighting::Phong => m.lighting = Lighting::Unlit,
                Effect::Pbr if m.lighting == Lighting::Pbr => m.lighting = Lighting::Unlit,
                Effect::Cutout => m.alpha_cutoff = m.alpha_cutoff.map(|_| 0.0),
                Effect::Emission => m.emission = [0.0; 3],
                _ => {}
            }
        }
        scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Light, Object};
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

    /// Each effect is called for by just what names it, and is gone without it.
    #[test]
    fn each_effect_has_its_cause() {
        let plain = Material::unlit([0.5; 3], 0.5);
        assert!(
            Effect::ALL
                .iter()
                .all(|e| !Census::of(&scene(plain.clone())).has(*e))
        );
        let light = Light {
            position: Vec3::ONE,
            color: [1.0; 3],
            intensity: 1.0,
        };
        for effect in Effect::ALL {
            let mut material = plain.clone();
            let mut lights = Vec::new();
            let mut scale = 1.0;
            match effect {
                Effect::Opaque => (material.alpha, material.blend) = (1.0, false),
                Effect::Culling => material.double_sided = false,
                Effect::Lighting => material.lighting = Lighting::Phong,
                Effect::Pbr => material.lighting = Lighting::Pbr,
                Effect::Cutout => material.alpha_cutoff = Some(0.4),
                Effect::Emission => material.emission = [0.0, 0.1, 0.0],
                Effect::LowResolution => scale = 0.5,
            }
            if matches!(effect, Effect::Lighting | Effect::Pbr) {
                // Without a light there is nothing to compute.
                assert!(!Census::of(&scene(material.clone())).has(effect));
                lights.push(light);
            }
            let mut scene = scene(material);
            scene.lights = lights;
            scene.transparency_scale = scale;
            let on = |s: &Scene| -> Vec<&str> {
                let census = Census::of(s);
                let on = census.effects.into_iter().filter(|e| e.on);
                on.map(|e| e.name).collect()
            };
            // A surface with holes is drawn with the opaque ones.
            let both = ["opaque", "cutout"];
            let alone = [effect.name()];
            let want = if effect == Effect::Cutout {
                &both[..]
            } else {
                &alone[..]
            };
            assert_eq!(on(&scene), want);
            assert!(!on(&scene.without(effect)).contains(&effect.name()));
        }
    }
}
