//! The census: which effects a scene needs, and which objects need them. A renderer is specialised by it: unused effects cost nothing.

#[cfg(doc)]
use crate::texture::Maps;
use crate::{
    material::{Lighting, Material},
    scene::{Light, Object, Scene, Source},
};
use serde::Serialize;
use std::fmt;

#[cfg(test)]
mod tests;

/// Pipeline specialisation key of a material. Each distinct key of a scene gets its own pipeline in every pass; no shader branches on
/// materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// How it is lit; unlit in a scene without lights.
    pub lighting: Lighting,
    /// Whether it emits.
    pub emissive: bool,
    /// Whether it has holes.
    pub cutout: bool,
    /// Whether back faces are left out.
    pub culled: bool,
    /// Which textures of [`Maps::all`] are read.
    pub maps: [bool; 5],
    /// Whether opacity is read from the colour map. Passes without colour need the map too then.
    pub clear_map: bool,
    /// Whether there are vertex colours.
    pub vertex_colors: bool,
    /// Whether it is lit by a directional light.
    pub sun: bool,
    /// Whether light is transmitted, see [`Material::transmission`].
    pub transmissive: bool,
}

/// The properties of a scene that its materials' variants depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Whether there is any light.
    pub lit: bool,
    /// Whether any light is directional.
    pub sun: bool,
}

impl Setting {
    /// The setting of a scene.
    pub fn of(scene: &Scene) -> Self {
        let is_sun = |l: &Light| matches!(l.source, Source::Toward(_));
        Self {
            lit: !scene.lights.is_empty(),
            sun: scene.lights.iter().any(is_sun),
        }
    }
}

impl Variant {
    /// The variant of a material on an object.
    pub fn of(material: &Material, object: &Object, setting: Setting) -> Self {
        let lighting = if setting.lit {
            material.lighting
        } else {
            Lighting::Unlit
        };
        let is_lit = lighting != Lighting::Unlit;
        let emissive = material.is_emissive();
        let [color, normal, metal, occlusion, emission] = material.maps.all();
        Self {
            lighting,
            emissive,
            cutout: material.alpha_cutoff.is_some_and(|cutoff| cutoff > 0.0),
            culled: !material.double_sided,
            maps: [
                color.is_some(),
                is_lit && normal.is_some(),
                lighting == Lighting::Pbr && metal.is_some(),
                is_lit && occlusion.is_some(),
                emissive && emission.is_some(),
            ],
            clear_map: color.is_some_and(|map| map.has_alpha()),
            vertex_colors: !object.mesh.colors.is_empty(),
            sun: is_lit && setting.sun,
            transmissive: material.is_transmissive(),
        }
    }

    /// Whether any texture is read.
    pub fn is_mapped(self) -> bool {
        self.maps.contains(&true)
    }

    /// Whether tangents are read.
    pub const fn has_normal_map(self) -> bool {
        self.maps[1]
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
        all.extend(self.is_mapped().then_some("mapped"));
        let maps = self.maps.iter().zip(MAP_FEATURES);
        all.extend(maps.filter_map(|(read, name)| read.then_some(name)));
        all.extend(self.clear_map.then_some("clear_map"));
        all.extend(self.vertex_colors.then_some("vertex_colors"));
        all.extend(self.sun.then_some("sun"));
        all.extend(self.transmissive.then_some("transmission"));
        all
    }
}

/// Shader features of the maps, in the order of [`Maps::all`].
const MAP_FEATURES: [&str; 5] = [
    "color_map",
    "normal_map",
    "metallic_roughness_map",
    "occlusion_map",
    "emissive_map",
];

/// Something that a renderer does only where a scene needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Opaque surfaces.
    Opaque,
    /// Surfaces whose back faces are culled.
    Culling,
    /// Blinn–Phong.
    Lighting,
    /// Cook–Torrance.
    Pbr,
    /// Holes where opacity is low.
    Cutout,
    /// Emissive surfaces.
    Emission,
    /// Textures of base colour and opacity.
    ColorMap,
    /// Textures of normals.
    NormalMap,
    /// Textures of metallic and roughness.
    MetallicRoughnessMap,
    /// Textures of ambient occlusion.
    OcclusionMap,
    /// Textures of emission.
    EmissiveMap,
    /// Vertex colours.
    VertexColors,
    /// Directional lights.
    Sun,
    /// Coloured transmission through surfaces.
    Transmission,
    /// A scene whose colours are all grey.
    Monochrome,
    /// Transparency at a lower resolution.
    LowResolution,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Opaque,
        Self::Culling,
        Self::Lighting,
        Self::Pbr,
        Self::Cutout,
        Self::Emission,
        Self::ColorMap,
        Self::NormalMap,
        Self::MetallicRoughnessMap,
        Self::OcclusionMap,
        Self::EmissiveMap,
        Self::VertexColors,
        Self::Sun,
        Self::Transmission,
        Self::Monochrome,
        Self::LowResolution,
    ];

    /// The five maps in the order of [`Maps::all`].
    pub const MAPS: [Self; 5] = [
        Self::ColorMap,
        Self::NormalMap,
        Self::MetallicRoughnessMap,
        Self::OcclusionMap,
        Self::EmissiveMap,
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
            Self::ColorMap => "color-map",
            Self::NormalMap => "normal-map",
            Self::MetallicRoughnessMap => "metallic-roughness-map",
            Self::OcclusionMap => "occlusion-map",
            Self::EmissiveMap => "emissive-map",
            Self::VertexColors => "vertex-colors",
            Self::Sun => "directional-light",
            Self::Transmission => "transmission",
            Self::Monochrome => "monochrome",
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
            Self::ColorMap => "a texture with its fetch, UVs, a sampler",
            Self::NormalMap => "a texture with its fetch, tangents, UVs, a sampler",
            Self::MetallicRoughnessMap | Self::OcclusionMap | Self::EmissiveMap => {
                "a texture with its fetch, UVs, a sampler"
            }
            Self::VertexColors => "16 bytes a vertex and a product",
            Self::Sun => "a choice between position and direction for each light",
            Self::Transmission => {
                "three channels of transmittance instead of one where it is not grey"
            }
            Self::Monochrome => "nothing: weighted sums and transmittance share one target",
            Self::LowResolution => {
                "two passes over the pixels and 36 bytes a sample; fewer samples for everything transparent"
            }
        }
    }

    fn is_needed_by(self, material: &Material, variant: Variant) -> bool {
        match self {
            Self::Opaque => material.is_opaque(),
            Self::Culling => variant.culled,
            Self::Lighting => variant.lighting == Lighting::Phong,
            Self::Pbr => variant.lighting == Lighting::Pbr,
            Self::Cutout => variant.cutout,
            Self::Emission => variant.emissive,
            Self::ColorMap => variant.maps[0],
            Self::NormalMap => variant.maps[1],
            Self::MetallicRoughnessMap => variant.maps[2],
            Self::OcclusionMap => variant.maps[3],
            Self::EmissiveMap => variant.maps[4],
            Self::VertexColors => variant.vertex_colors,
            Self::Sun => variant.sun,
            Self::Transmission => variant.transmissive,
            Self::LowResolution | Self::Monochrome => false,
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Whether an effect is on, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Called {
    /// The effect's name.
    pub name: &'static str,
    /// Whether anything needs it.
    pub on: bool,
    /// What needs it: names of objects, or a key of the scene.
    pub why: Vec<String>,
    /// What it adds to a frame.
    pub adds: &'static str,
}

/// The effects that a scene needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Census {
    /// Every effect there is.
    pub effects: Vec<Called>,
    /// The variants of its materials: the most pipelines that a pass over opaque or over transparent surfaces has.
    pub variants: Vec<Variant>,
}

impl Census {
    /// Takes the census of a scene.
    pub fn of(scene: &Scene) -> Self {
        let setting = Setting::of(scene);
        let mut variants: Vec<Variant> = Vec::new();
        let materials = scene.objects.iter().flat_map(|object| {
            let materials = object.mesh.parts.iter().zip(&object.materials);
            // A part without triangles needs nothing.
            let drawn = materials.filter(|(part, _)| !part.triangles.is_empty());
            drawn.map(move |(_, material)| (object, material))
        });
        let mut why: Vec<Vec<String>> = vec![Vec::new(); Effect::ALL.len()];
        for (object, material) in materials {
            let variant = Variant::of(material, object, setting);
            if !variants.contains(&variant) {
                variants.push(variant);
            }
            for (effect, why) in Effect::ALL.iter().zip(&mut why) {
                let is_new = || !why.contains(&object.name);
                if effect.is_needed_by(material, variant) && is_new() {
                    why.push(object.name.clone());
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
        let mut call = |which: Effect, why: String| {
            for effect in effects.iter_mut().filter(|e| e.name == which.name()) {
                (effect.on, effect.why) = (true, vec![why.clone()]);
            }
        };
        if scene.transparency_scale < 1.0 {
            let why = format!("transparency_scale = {}", scene.transparency_scale);
            call(Effect::LowResolution, why);
        }
        if scene.is_grey() {
            call(Effect::Monochrome, "every colour is grey".into());
        }
        effects.extend(beyond_pixels(scene));
        Self { effects, variants }
    }

    /// Whether an effect is on.
    pub fn has(&self, effect: Effect) -> bool {
        let mut of = self.effects.iter();
        of.any(|e| e.name == effect.name() && e.on)
    }
}

/// Effects that no pipeline of a frame depends on: layers matter only where one of them is highlighted, states of a timeline are loaded
/// one at a time, and the method decides which statistics are gathered.
fn beyond_pixels(scene: &Scene) -> [Called; 3] {
    let layered = scene.objects.iter().filter(|o| o.layer.is_some());
    let several = scene.layers().len() > 1;
    let states = scene.timeline.iter().map(|s| s.label.clone());
    [
        Called {
            name: "layers",
            on: several,
            why: layered
                .filter(|_| several)
                .map(|o| o.name.clone())
                .collect(),
            adds: "nothing until one is highlighted; then every fragment and its layer are stored and sorted",
        },
        Called {
            name: "ageing",
            on: scene.timeline.len() > 1,
            why: states.filter(|_| scene.timeline.len() > 1).collect(),
            adds: "nothing: one state is loaded",
        },
        Called {
            name: "statistics",
            on: false,
            why: vec![
                "up to the method: a learned or moment method adds a pass over the surfaces".into(),
            ],
            adds: "a pass over the transparent surfaces and its targets",
        },
    ]
}

impl Scene {
    /// Whether every colour is grey: of materials, textures, vertices, lights and the background.
    pub fn is_grey(&self) -> bool {
        let grey = |[r, g, b]: [f32; 3]| r == g && g == b;
        let material = |m: &Material| {
            let colors = [m.color, m.emission, m.transmission];
            let maps = [&m.maps.color, &m.maps.emissive];
            colors.into_iter().all(grey) && maps.into_iter().flatten().all(|map| map.is_grey())
        };
        let vertices = |o: &Object| o.mesh.colors.iter().all(|&[r, g, b, _]| grey([r, g, b]));
        grey(self.background)
            && self.lights.iter().all(|l| grey(l.color))
            && self
                .objects
                .iter()
                .all(|o| o.materials.iter().all(material) && vertices(o))
    }

    /// Whether transmitted light is coloured. Where all of it is grey, one channel holds the transmittance.
    pub fn is_tinted(&self) -> bool {
        let mut materials = self.objects.iter().flat_map(|o| &o.materials);
        materials.any(|m| {
            let [r, g, b] = m.transmission;
            let mapped = m.maps.color.as_ref().is_some_and(|map| !map.is_grey());
            m.is_transmissive() && (r != g || g != b || mapped)
        })
    }

    /// The scene without an effect: opaque objects are removed, lit surfaces unlit, and so on.
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
                Effect::ColorMap => m.maps.color = None,
                Effect::NormalMap => m.maps.normal = None,
                Effect::MetallicRoughnessMap => m.maps.metallic_roughness = None,
                Effect::OcclusionMap => m.maps.occlusion = None,
                Effect::EmissiveMap => m.maps.emissive = None,
                Effect::Transmission => m.transmission = [0.0; 3],
                _ => {}
            }
        }
        for o in &mut scene.objects {
            if effect == Effect::VertexColors && !o.mesh.colors.is_empty() {
                let mut mesh = (*o.mesh).clone();
                mesh.colors.clear();
                o.mesh = mesh.into();
            }
        }
        if effect == Effect::Sun {
            scene
                .lights
                .retain(|l| matches!(l.source, Source::Point(_)));
        }
        // The nearest colour that is not grey.
        if effect == Effect::Monochrome && scene.is_grey() {
            scene.background[2] = scene.background[2].next_up();
        }
        scene
    }
}
