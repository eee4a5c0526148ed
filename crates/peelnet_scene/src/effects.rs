//! Effects of materials and lights, a row each. Scene features, the linker's features, the viewer,
//! `inspect`, the documents' table and the tests that unused effects cost nothing go through the
//! rows.

use crate::{
    material::{Lighting, Material, NUMBERS, Number},
    scene::{Blending, Light, Object, Scene, Source},
};
use bitflags::bitflags;
use std::{fmt, sync::LazyLock};

bitflags! {
    /// Pipeline specialisation key of a material. Each distinct key of a scene gets its own
    /// pipeline in every pass; no shader branches on materials.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct MaterialFlags: u32 {
        /// Lit by either model.
        const LIT = 1;
        /// Lit by Blinn–Phong.
        const PHONG = 1 << 1;
        /// Lit by Cook–Torrance.
        const PBR = 1 << 2;
        /// Emits.
        const EMISSION = 1 << 3;
        /// Has holes.
        const CUTOUT = 1 << 4;
        /// Reads any texture.
        const MAPPED = 1 << 5;
        /// Reads the colour map.
        const COLOR_MAP = 1 << 6;
        /// Reads the normal map, and tangents.
        const NORMAL_MAP = 1 << 7;
        /// Reads the map of metallic and roughness.
        const METALLIC_ROUGHNESS_MAP = 1 << 8;
        /// Reads the occlusion map.
        const OCCLUSION_MAP = 1 << 9;
        /// Reads the emissive map.
        const EMISSIVE_MAP = 1 << 10;
        /// Opacity is read from the colour map. Passes without colour need the map too then.
        const CLEAR_MAP = 1 << 11;
        /// The object has vertex colours.
        const VERTEX_COLORS = 1 << 12;
        /// Lit by a directional light.
        const SUN = 1 << 13;
        /// Transmits light, see [`Material::transmission`].
        const TRANSMISSION = 1 << 14;
        /// Back faces are left out.
        const CULLED = 1 << 15;
        /// Splats, see [`crate::Splats`].
        const SPLAT = 1 << 16;
        /// Blends as displays show, see [`crate::Blending`].
        const DISPLAY = 1 << 17;
    }
}

impl MaterialFlags {
    /// The textures, in the order of [`Maps::all`](crate::Maps::all).
    pub const MAPS: [Self; 5] = [
        Self::COLOR_MAP,
        Self::NORMAL_MAP,
        Self::METALLIC_ROUGHNESS_MAP,
        Self::OCCLUSION_MAP,
        Self::EMISSIVE_MAP,
    ];

    /// Those that show on lit surfaces alone.
    const OF_LIT: Self = Self::PHONG
        .union(Self::PBR)
        .union(Self::SUN)
        .union(Self::NORMAL_MAP)
        .union(Self::METALLIC_ROUGHNESS_MAP)
        .union(Self::OCCLUSION_MAP);

    /// The flags of a material on an object, in the light of a scene ([`Scene::light_flags`]).
    pub fn new(material: &Material, object: &Object, lights: Self) -> Self {
        let rows = EFFECTS.iter();
        let needed = rows.filter(|effect| effect.is_needed_by(material, object, lights));
        let mut flags: Self = needed.map(|effect| effect.flag).collect();
        let is_clear = material.maps.color.as_ref().is_some_and(|m| m.has_alpha);
        flags.set(Self::CLEAR_MAP, is_clear);
        if object.mesh.splats.is_some() {
            // They have neither a surface to be lit nor places in textures.
            flags &= Self::SPLAT | Self::DISPLAY;
        }
        flags.with_implied()
    }

    /// With [`Self::LIT`] where it is lit by a model, and [`Self::MAPPED`] where it reads textures.
    #[must_use]
    pub fn with_implied(mut self) -> Self {
        self.set(Self::LIT, self.intersects(Self::PHONG | Self::PBR));
        self.set(Self::MAPPED, !self.maps().is_empty());
        self
    }

    /// The textures among them.
    #[must_use]
    pub fn maps(self) -> Self {
        self & Self::from_iter(Self::MAPS)
    }

    /// Whether any of them shows on lit surfaces alone.
    pub fn needs_light(self) -> bool {
        self.intersects(Self::OF_LIT)
    }

    /// The shader features that it links: its flags' names in lower case, but for culling, of which
    /// shaders know nothing.
    pub fn features(self) -> Vec<&'static str> {
        static NAMES: LazyLock<Vec<(MaterialFlags, String)>> = LazyLock::new(|| {
            let flags = (MaterialFlags::all() - MaterialFlags::CULLED).iter_names();
            flags
                .map(|(name, flag)| (flag, name.to_lowercase()))
                .collect()
        });
        let on = NAMES.iter().filter(|(flag, _)| self.contains(*flag));
        on.map(|(_, name)| name.as_str()).collect()
    }
}

/// Something that a renderer does only where a scene needs it.
#[derive(Debug)]
pub struct Effect {
    /// Its name in reports and documents.
    pub name: &'static str,
    /// The flag of the materials that need it; empty where it changes no shader of theirs.
    pub flag: MaterialFlags,
    /// What in a scene file needs it, in Markdown.
    pub needed_by: &'static str,
    /// What it adds to a frame.
    pub adds: &'static str,
    rule: Rule,
}

/// What needs an effect, and how a scene is without it. Flags of [`MaterialFlags::OF_LIT`] are
/// needed by lit surfaces alone.
#[derive(Debug)]
enum Rule {
    /// A material whose number of this field is not 0.
    Number(&'static str),
    /// A material that is lit so.
    Lighting(Lighting),
    Material(fn(&Material) -> bool, fn(&mut Material)),
    /// A material on an object in the light of a scene.
    Surface(
        fn(&Material, &Object, MaterialFlags) -> bool,
        fn(&mut Scene),
    ),
    /// The whole scene, and why.
    Scene(fn(&Scene) -> Option<String>, fn(&mut Scene)),
}

impl Effect {
    /// The effect of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        EFFECTS.iter().find(|effect| effect.name == name)
    }

    /// The number that switches it on where it is not 0.
    pub fn number(&self) -> Option<&'static Number> {
        let Rule::Number(field) = self.rule else {
            return None;
        };
        NUMBERS.iter().find(|number| number.field == field)
    }

    pub(crate) fn is_needed_by(
        &self,
        material: &Material,
        object: &Object,
        lights: MaterialFlags,
    ) -> bool {
        let is_lit = lights.contains(MaterialFlags::LIT) && material.lighting != Lighting::Unlit;
        if self.flag.needs_light() && !is_lit {
            return false;
        }
        match self.rule {
            Rule::Number(_) => self.number().is_some_and(|n| !n.is_zero(material)),
            Rule::Lighting(model) => material.lighting == model,
            Rule::Material(is_needed, _) => is_needed(material),
            Rule::Surface(is_needed, _) => is_needed(material, object, lights),
            Rule::Scene(..) => false,
        }
    }

    pub(crate) fn reason_in(&self, scene: &Scene) -> Option<String> {
        match self.rule {
            Rule::Scene(reason, _) => reason(scene),
            _ => None,
        }
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}

impl Scene {
    /// The scene without an effect: opaque objects are removed, lit surfaces unlit, and so on.
    pub fn without(&self, effect: &Effect) -> Self {
        match effect.rule {
            Rule::Surface(_, remove) | Rule::Scene(_, remove) => {
                let mut scene = self.clone();
                remove(&mut scene);
                scene
            }
            Rule::Material(_, remove) => self.with_materials(remove),
            Rule::Lighting(model) => self.with_materials(|material| {
                if material.lighting == model {
                    material.lighting = Lighting::Unlit;
                }
            }),
            Rule::Number(_) => self.with_materials(|material| {
                let values = effect.number().map(|number| (number.values_mut)(material));
                values.into_iter().for_each(|values| values.fill(0.0));
            }),
        }
    }

    /// Which of [`MaterialFlags::LIT`] and [`MaterialFlags::SUN`] its lights make possible, and whether it blends in
    /// [`MaterialFlags::DISPLAY`] space.
    pub fn light_flags(&self) -> MaterialFlags {
        let is_sun = |l: &Light| matches!(l.source, Source::Toward(_));
        let mut flags = MaterialFlags::empty();
        flags.set(MaterialFlags::LIT, !self.lights.is_empty());
        flags.set(MaterialFlags::SUN, self.lights.iter().any(is_sun));
        flags.set(MaterialFlags::DISPLAY, self.blending == Blending::Display);
        flags
    }
}

const TEXTURE: &str = "a texture with its fetch, UVs, a sampler";

/// All effects.
pub static EFFECTS: &[Effect] = &[
    Effect {
        name: "opaque",
        flag: MaterialFlags::empty(),
        needed_by: "alpha 1 without `blend`, or a cut-out",
        adds: "its draws in the background pass, a depth target of 4 bytes a pixel, a comparison in transparent passes",
        rule: Rule::Surface(
            |material, _, _| material.is_opaque(),
            |scene| {
                let opaque = |o: &Object| o.materials.iter().all(Material::is_opaque);
                scene.objects.retain(|o| !opaque(o));
            },
        ),
    },
    Effect {
        name: "culling",
        flag: MaterialFlags::CULLED,
        needed_by: "`double_sided = false`",
        adds: "nothing: back faces are not rasterised",
        rule: Rule::Material(|m| !m.double_sided, |m| m.double_sided = true),
    },
    Effect {
        name: "lighting",
        flag: MaterialFlags::PHONG,
        needed_by: "`lighting = \"phong\"`, and a light",
        adds: "normals and positions, a binding of lights, Blinn–Phong in the shader",
        rule: Rule::Lighting(Lighting::Phong),
    },
    Effect {
        name: "pbr",
        flag: MaterialFlags::PBR,
        needed_by: "`lighting = \"pbr\"` with `metallic` and `roughness`, and a light",
        adds: "normals and positions, a binding of lights, Cook–Torrance in the shader",
        rule: Rule::Lighting(Lighting::Pbr),
    },
    Effect {
        name: "cutout",
        flag: MaterialFlags::CUTOUT,
        needed_by: "`alpha_mode = \"mask\"` with `alpha_cutoff`",
        adds: "a comparison and a discard in the pipelines of these materials",
        rule: Rule::Material(
            |m| m.alpha_cutoff.is_some_and(|cutoff| cutoff > 0.0),
            |m| m.alpha_cutoff = m.alpha_cutoff.map(|_| 0.0),
        ),
    },
    Effect {
        name: "emission",
        flag: MaterialFlags::EMISSION,
        needed_by: "`emission = [r, g, b]`",
        adds: "an addition in the pipelines of these materials",
        rule: Rule::Number("emission"),
    },
    Effect {
        name: "color-map",
        flag: MaterialFlags::COLOR_MAP,
        needed_by: "`color_map`",
        adds: TEXTURE,
        rule: Rule::Material(|m| m.maps.color.is_some(), |m| m.maps.color = None),
    },
    Effect {
        name: "normal-map",
        flag: MaterialFlags::NORMAL_MAP,
        needed_by: "`normal_map`, where the material is lit",
        adds: "a texture with its fetch, tangents, UVs, a sampler",
        rule: Rule::Material(|m| m.maps.normal.is_some(), |m| m.maps.normal = None),
    },
    Effect {
        name: "metallic-roughness-map",
        flag: MaterialFlags::METALLIC_ROUGHNESS_MAP,
        needed_by: "`metallic_roughness_map`, where the material is lit as `pbr`",
        adds: TEXTURE,
        rule: Rule::Material(
            |m| m.lighting == Lighting::Pbr && m.maps.metallic_roughness.is_some(),
            |m| m.maps.metallic_roughness = None,
        ),
    },
    Effect {
        name: "occlusion-map",
        flag: MaterialFlags::OCCLUSION_MAP,
        needed_by: "`occlusion_map`, where the material is lit",
        adds: TEXTURE,
        rule: Rule::Material(|m| m.maps.occlusion.is_some(), |m| m.maps.occlusion = None),
    },
    Effect {
        name: "emissive-map",
        flag: MaterialFlags::EMISSIVE_MAP,
        needed_by: "`emissive_map`, where the material emits",
        adds: TEXTURE,
        rule: Rule::Material(
            |m| m.emission != [0.0; 3] && m.maps.emissive.is_some(),
            |m| m.maps.emissive = None,
        ),
    },
    Effect {
        name: "vertex-colors",
        flag: MaterialFlags::VERTEX_COLORS,
        needed_by: "vertex colours of a mesh, or `vertex_colors` of an object",
        adds: "16 bytes a vertex and a product",
        rule: Rule::Surface(
            |_, object, _| !object.mesh.colors.is_empty(),
            |scene| {
                let objects = scene.objects.iter_mut();
                for object in objects.filter(|o| !o.mesh.colors.is_empty()) {
                    let mut mesh = (*object.mesh).clone();
                    mesh.colors.clear();
                    object.mesh = mesh.into();
                }
            },
        ),
    },
    Effect {
        name: "directional-light",
        flag: MaterialFlags::SUN,
        needed_by: "a light with `direction`",
        adds: "a choice between position and direction for each light",
        rule: Rule::Surface(
            |_, _, lights| lights.contains(MaterialFlags::SUN),
            |scene| {
                let is_point = |l: &Light| matches!(l.source, Source::Point(_));
                scene.lights.retain(is_point);
            },
        ),
    },
    Effect {
        name: "transmission",
        flag: MaterialFlags::TRANSMISSION,
        needed_by: "`transmission_color = [r, g, b]`",
        adds: "three channels of transmittance instead of one where it is not grey",
        rule: Rule::Number("transmission"),
    },
    Effect {
        name: "splats",
        flag: MaterialFlags::SPLAT,
        needed_by: "a mesh of Gaussian splats",
        adds: "48 bytes a splat and 8 to 96 of its colour, a projection for each corner, a comparison and a discard",
        rule: Rule::Surface(
            |_, object, _| object.mesh.splats.is_some(),
            |scene| scene.objects.retain(|o| o.mesh.splats.is_none()),
        ),
    },
    Effect {
        name: "display-space",
        flag: MaterialFlags::DISPLAY,
        needed_by: "`blending = \"display\"`, or splats without `blending = \"linear\"`",
        adds: "the transfer function of sRGB for each fragment of a surface",
        rule: Rule::Surface(
            |_, _, scene| scene.contains(MaterialFlags::DISPLAY),
            |scene| scene.blending = Blending::Linear,
        ),
    },
    Effect {
        name: "monochrome",
        flag: MaterialFlags::empty(),
        needed_by: "every colour is grey",
        adds: "nothing: weighted sums and transmittance share one target",
        rule: Rule::Scene(
            |scene| scene.is_grey().then(|| "every colour is grey".to_owned()),
            |scene| {
                // The nearest colour that is not grey.
                if scene.is_grey() {
                    scene.background[2] = scene.background[2].next_up();
                }
            },
        ),
    },
    Effect {
        name: "low-resolution",
        flag: MaterialFlags::empty(),
        needed_by: "`transparency_scale` below 1 in the scene, or the parameter `scale=S` of a method",
        adds: "two passes over the pixels and 36 bytes a sample; fewer samples for everything transparent",
        rule: Rule::Scene(
            |scene| {
                let scale = scene.transparency_scale;
                (scale < 1.0).then(|| format!("transparency_scale = {scale}"))
            },
            |scene| scene.transparency_scale = 1.0,
        ),
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of rows are unique, and each number that a row names exists.
    #[test]
    fn rows_can_be_found() {
        for effect in EFFECTS {
            let same = EFFECTS.iter().filter(|other| *other == effect);
            assert_eq!(same.count(), 1, "{effect}");
            let has_number = effect.number().is_some();
            assert_eq!(
                has_number,
                matches!(effect.rule, Rule::Number(_)),
                "{effect}"
            );
        }
    }
}
