//! Scene features: which effects a scene needs, and which objects need them. A renderer is
//! specialised by them: unused effects cost nothing.

use crate::{
    effects::{EFFECTS, Effect, MaterialFlags},
    material::{Material, NUMBERS},
    scene::{Object, Scene},
};
use serde::Serialize;
use std::collections::HashSet;

/// Whether an effect is on, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SceneFeature {
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
pub struct SceneFeatures {
    /// Every effect there is.
    pub effects: Vec<SceneFeature>,
    /// The flags of its materials: the most pipelines that a pass over opaque or over transparent
    /// surfaces has.
    pub variants: Vec<MaterialFlags>,
}

impl SceneFeatures {
    /// Goes through the materials of a scene.
    pub fn new(scene: &Scene) -> Self {
        let lights = scene.light_flags();
        let mut variants: Vec<MaterialFlags> = Vec::new();
        let reasons = |effect: &Effect| effect.reason_in(scene).into_iter().collect();
        let mut whys: Vec<Vec<String>> = EFFECTS.iter().map(reasons).collect();
        let mut known = HashSet::new();
        for object in &scene.objects {
            let materials = object.mesh.parts.iter().zip(&object.materials);
            // A part without triangles needs nothing.
            for (_, material) in materials.filter(|(part, _)| !part.triangles.is_empty()) {
                let flags = MaterialFlags::new(material, object, lights);
                if !variants.contains(&flags) {
                    variants.push(flags);
                }
                for (effect, why) in EFFECTS.iter().zip(&mut whys) {
                    let is_needed = effect.is_needed_by(material, object, lights);
                    if is_needed && known.insert((effect.name, &object.name)) {
                        why.push(object.name.clone());
                    }
                }
            }
        }
        let effects = EFFECTS.iter().zip(whys).map(|(effect, why)| SceneFeature {
            name: effect.name,
            on: !why.is_empty(),
            why,
            adds: effect.adds,
        });
        let effects = effects.chain(beyond_pixels(scene)).collect();
        Self { effects, variants }
    }

    /// Whether an effect is on.
    pub fn has(&self, effect: &Effect) -> bool {
        let mut effects = self.effects.iter();
        effects.any(|e| e.name == effect.name && e.on)
    }

    /// The effects that are on, of those that a frame depends on.
    pub fn effects_on(&self) -> impl Iterator<Item = &'static Effect> {
        EFFECTS.iter().filter(|effect| self.has(effect))
    }
}

/// Effects that no pipeline of a frame depends on: layers matter only where one of them is
/// highlighted, states of a timeline are loaded one at a time, and the method decides which
/// statistics are gathered.
fn beyond_pixels(scene: &Scene) -> [SceneFeature; 3] {
    let several = scene.layers().len() > 1;
    let is_layered = |o: &&Object| several && o.layer.is_some();
    let layered = scene.objects.iter().filter(is_layered);
    let ages = scene.timeline.len() > 1;
    let states = scene.timeline.iter().filter(|_| ages);
    let method = "up to the method: a learned or moment method adds a pass over the surfaces";
    [
        SceneFeature {
            name: "layers",
            on: several,
            why: layered.map(|o| o.name.clone()).collect(),
            adds: "nothing until one is highlighted; then every fragment and its layer are stored and sorted",
        },
        SceneFeature {
            name: "ageing",
            on: ages,
            why: states.map(|s| s.label.clone()).collect(),
            adds: "nothing: one state is loaded",
        },
        SceneFeature {
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
            let mut numbers = NUMBERS.iter().map(|number| (number.values)(m));
            let maps = [&m.maps.color, &m.maps.emissive];
            numbers.all(|values| values.iter().all(|x| *x == values[0]))
                && maps.into_iter().flatten().all(|map| map.is_grey)
        };
        let vertices = |o: &Object| {
            let mut colors = o.mesh.colors.iter();
            o.mesh.splats.is_none() && colors.all(|&[r, g, b, _]| grey([r, g, b]))
        };
        let object = |o: &Object| o.materials.iter().all(material) && vertices(o);
        grey(self.background)
            && self.lights.iter().all(|l| grey(l.color))
            && self.objects.iter().all(object)
    }

    /// Whether transmitted light is coloured. Where all of it is grey, one channel holds the
    /// transmittance.
    pub fn is_tinted(&self) -> bool {
        let mut materials = self.objects.iter().flat_map(|o| &o.materials);
        materials.any(|m| {
            let [r, g, b] = m.transmission;
            let mapped = m.maps.color.as_ref().is_some_and(|map| !map.is_grey);
            m.transmission != [0.0; 3] && (r != g || g != b || mapped)
        })
    }
}
