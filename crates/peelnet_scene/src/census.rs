//! The census: which effects a scene needs, and which objects need them. A renderer is specialised by it: unused effects cost nothing.

use crate::{
    material::{Lighting, Material},
    scene::{Light, Object, Scene, Source},
    texture::Maps,
};
use serde::Serialize;
use std::fmt;

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
        let before = [
            (self.is_lit(), "lit"),
            (self.lighting == Lighting::Phong, "phong"),
            (self.lighting == Lighting::Pbr, "pbr"),
            (self.emissive, "emission"),
            (self.cutout, "cutout"),
            (self.is_mapped(), "mapped"),
        ];
        let maps = self.maps.into_iter().zip(Maps::KEYS);
        let after = [
            (self.clear_map, "clear_map"),
            (self.vertex_colors, "vertex_colors"),
            (self.sun, "sun"),
            (self.transmissive, "transmission"),
        ];
        let all = before.into_iter().chain(maps).chain(after);
        all.filter_map(|(on, name)| on.then_some(name)).collect()
    }
}

/// Declares [`Effect`]: name, what it adds to a frame, and whether a material needs it, from the material and its [`Variant`].
macro_rules! effects {
    ($($effect:ident $name:literal $adds:literal $needed:expr;)*) => {
        /// Something that a renderer does only where a scene needs it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Effect {
            $(#[doc = concat!($name, ": adds ", $adds)] $effect,)*
        }

        impl Effect {
            /// All of them.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$effect),*];

            /// Its name.
            pub const fn name(self) -> &'static str {
                [$($name),*][self as usize]
            }

            /// What it adds to a frame.
            pub const fn adds(self) -> &'static str {
                [$($adds),*][self as usize]
            }

            fn is_needed_by(self, material: &Material, variant: Variant) -> bool {
                let needed: [fn(&Material, Variant) -> bool; Self::ALL.len()] = [$($needed),*];
                needed[self as usize](material, variant)
            }
        }
    };
}

effects! {
    Opaque "opaque" "its draws in the background pass, a depth target of 4 bytes a pixel, a comparison in transparent passes"
        |material, _| material.is_opaque();
    Culling "culling" "nothing: back faces are not rasterised" |_, variant| variant.culled;
    Lighting "lighting" "normals and positions, a binding of lights, Blinn–Phong in the shader"
        |_, variant| variant.lighting == Lighting::Phong;
    Pbr "pbr" "normals and positions, a binding of lights, Cook–Torrance in the shader"
        |_, variant| variant.lighting == Lighting::Pbr;
    Cutout "cutout" "a comparison and a discard in the pipelines of these materials" |_, variant| variant.cutout;
    Emission "emission" "an addition in the pipelines of these materials" |_, variant| variant.emissive;
    ColorMap "color-map" "a texture with its fetch, UVs, a sampler" |_, variant| variant.maps[0];
    NormalMap "normal-map" "a texture with its fetch, tangents, UVs, a sampler" |_, variant| variant.maps[1];
    MetallicRoughnessMap "metallic-roughness-map" "a texture with its fetch, UVs, a sampler" |_, variant| variant.maps[2];
    OcclusionMap "occlusion-map" "a texture with its fetch, UVs, a sampler" |_, variant| variant.maps[3];
    EmissiveMap "emissive-map" "a texture with its fetch, UVs, a sampler" |_, variant| variant.maps[4];
    VertexColors "vertex-colors" "16 bytes a vertex and a product" |_, variant| variant.vertex_colors;
    Sun "directional-light" "a choice between position and direction for each light" |_, variant| variant.sun;
    Transmission "transmission" "three channels of transmittance instead of one where it is not grey"
        |_, variant| variant.transmissive;
    Monochrome "monochrome" "nothing: weighted sums and transmittance share one target" |_, _| false;
    LowResolution "low-resolution"
        "two passes over the pixels and 36 bytes a sample; fewer samples for everything transparent" |_, _| false;
}

impl Effect {
    /// The five maps in the order of [`Maps::all`].
    pub const MAPS: [Self; 5] = [
        Self::ColorMap,
        Self::NormalMap,
        Self::MetallicRoughnessMap,
        Self::OcclusionMap,
        Self::EmissiveMap,
    ];
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
        let mut effects = Effect::ALL.map(|effect| Called {
            name: effect.name(),
            on: false,
            why: Vec::new(),
            adds: effect.adds(),
        });
        for object in &scene.objects {
            let materials = object.mesh.parts.iter().zip(&object.materials);
            // A part without triangles needs nothing.
            for (_, material) in materials.filter(|(part, _)| !part.triangles.is_empty()) {
                let variant = Variant::of(material, object, setting);
                if !variants.contains(&variant) {
                    variants.push(variant);
                }
                for (effect, called) in Effect::ALL.iter().zip(&mut effects) {
                    let is_needed = effect.is_needed_by(material, variant);
                    if is_needed && !called.why.contains(&object.name) {
                        called.why.push(object.name.clone());
                    }
                }
            }
        }
        let low = scene.transparency_scale < 1.0;
        let why = format!("transparency_scale = {}", scene.transparency_scale);
        effects[Effect::LowResolution as usize].why = low.then_some(why).into_iter().collect();
        if scene.is_grey() {
            effects[Effect::Monochrome as usize].why = vec!["every colour is grey".into()];
        }
        for called in &mut effects {
            called.on = !called.why.is_empty();
        }
        let effects = effects.into_iter().chain(beyond_pixels(scene)).collect();
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
    let several = scene.layers().len() > 1;
    let layered = scene
        .objects
        .iter()
        .filter(|o| several && o.layer.is_some());
    let ages = scene.timeline.len() > 1;
    let states = scene.timeline.iter().filter(|_| ages);
    let method = "up to the method: a learned or moment method adds a pass over the surfaces";
    [
        Called {
            name: "layers",
            on: several,
            why: layered.map(|o| o.name.clone()).collect(),
            adds: "nothing until one is highlighted; then every fragment and its layer are stored and sorted",
        },
        Called {
            name: "ageing",
            on: ages,
            why: states.map(|s| s.label.clone()).collect(),
            adds: "nothing: one state is loaded",
        },
        Called {
            name: "statistics",
            on: false,
            why: vec![method.into()],
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
        let object = |o: &Object| o.materials.iter().all(material) && vertices(o);
        grey(self.background)
            && self.lights.iter().all(|l| grey(l.color))
            && self.objects.iter().all(object)
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
        match effect {
            Effect::LowResolution => scene.transparency_scale = 1.0,
            Effect::Opaque => {
                let opaque = |m: &Material| m.is_opaque();
                scene.objects.retain(|o| !o.materials.iter().all(opaque));
            }
            Effect::Sun => {
                let is_point = |l: &Light| matches!(l.source, Source::Point(_));
                scene.lights.retain(is_point);
            }
            // The nearest colour that is not grey.
            Effect::Monochrome if scene.is_grey() => {
                scene.background[2] = scene.background[2].next_up();
            }
            _ => {}
        }
        for o in &mut scene.objects {
            if effect == Effect::VertexColors && !o.mesh.colors.is_empty() {
                let mut mesh = (*o.mesh).clone();
                mesh.colors.clear();
                o.mesh = mesh.into();
            }
            for m in &mut o.materials {
                match effect {
                    Effect::Culling => m.double_sided = true,
                    Effect::Lighting if m.lighting == Lighting::Phong => {
                        m.lighting = Lighting::Unlit;
                    }
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
        }
        scene
    }
}
