//! The scene file as TOML: tables and keys. An unknown key is an error, because a misspelt one would otherwise be silently ignored.

use crate::{
    camera::Camera, material::RawMaterial, parameters::parameters, pattern::Pattern,
    scatter::Scatter, scene::Blending, shapes::Shape,
};
use serde::{
    Deserialize, Deserializer,
    de::{
        Error as _, MapAccess, SeqAccess, Visitor,
        value::{MapAccessDeserializer, SeqAccessDeserializer},
    },
};
use std::{fmt, path::PathBuf};
use toml::Value;

parameters! {
    #[derive(Debug)]
    pub(super) struct RawScene {
        name: Option<String> = None,
        background: [f32; 3] = [0.0; 3],
        blending: Option<Blending> = None,
        transparency_scale: f32 = 1.0,
        held_out: bool = false,
        camera: Option<Camera> = None,
        view: Vec<Camera> = Vec::new(),
        orbit: Option<RawOrbit> = None,
        light: Vec<RawLight> = Vec::new(),
        object: Vec<RawObject> = Vec::new(),
        #[serde(deserialize_with = "one_or_many")]
        scatter: Vec<Scatter> = Vec::new(),
        timeline: Vec<RawState> = Vec::new(),
    }
}

parameters! {
    #[derive(Debug)]
    pub(super) struct RawLight {
        position: Option<[f32; 3]> = None,
        direction: Option<[f32; 3]> = None,
        color: [f32; 3] = [1.0; 3],
        intensity: f32 = 1.0,
    }
}

const fn one() -> f32 {
    1.0
}

/// `[scatter]` or `[[scatter]]`, read where they stand: an error has the line of its key.
fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Scatter>, D::Error> {
    struct OneOrMany;

    impl<'de> Visitor<'de> for OneOrMany {
        type Value = Vec<Scatter>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table or an array of tables")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, all: A) -> Result<Vec<Scatter>, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(all))
        }

        fn visit_map<A: MapAccess<'de>>(self, one: A) -> Result<Vec<Scatter>, A::Error> {
            Scatter::deserialize(MapAccessDeserializer::new(one)).map(|one| vec![one])
        }
    }

    deserializer.deserialize_any(OneOrMany)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawOrbit {
    pub views: u32,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawObject {
    pub name: Option<String>,
    pub mesh: MeshRef,
    pub fit: Option<f32>,
    #[serde(default = "one")]
    pub scale: f32,
    #[serde(default)]
    pub rotate: [f32; 3],
    #[serde(default)]
    pub translate: [f32; 3],
    pub layer: Option<u32>,
    /// Linear RGB and alpha of the lowest and of the highest vertex, mixed by height between them.
    pub vertex_colors: Option<[[f32; 4]; 2]>,
    #[serde(default)]
    pub material: RawMaterial,
}

/// A state of the timeline: what changes from its time on.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawState {
    pub time: f32,
    #[serde(default)]
    pub label: String,
    #[serde(default)]
    pub object: Vec<RawChange>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawChange {
    pub name: String,
    pub mesh: Option<MeshRef>,
    #[serde(default)]
    pub material: RawMaterial,
}

impl RawScene {
    /// The files that objects name, in any state of the timeline.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let objects = self.object.iter().map(|o| (Some(&o.mesh), &o.material));
        let changes = self.timeline.iter().flat_map(|state| &state.object);
        let changes = changes.map(|change| (change.mesh.as_ref(), &change.material));
        objects.chain(changes).flat_map(|(mesh, material)| {
            let maps = material.maps().filter_map(Reference::file);
            maps.chain(mesh.and_then(Reference::file))
        })
    }
}

/// A path relative to the scene file, or a table that describes something generated.
#[derive(Clone, Debug)]
pub(crate) enum Reference<T> {
    File(PathBuf),
    Made(Box<T>),
}

impl<T> Reference<T> {
    fn file(&self) -> Option<&PathBuf> {
        match self {
            Self::File(path) => Some(path),
            Self::Made(_) => None,
        }
    }
}

/// A mesh: a path, or a table with `shape = …`.
pub(crate) type MeshRef = Reference<Shape>;

/// A texture: a path, or a table with `pattern = …`.
pub(crate) type MapRef = Reference<Pattern>;

/// What a table describes: the name of that, and the key that its table needs.
pub(crate) trait Described {
    const NAMES: [&str; 2];
}

impl Described for Shape {
    const NAMES: [&str; 2] = ["mesh", "shape"];
}

impl Described for Pattern {
    const NAMES: [&str; 2] = ["map", "pattern"];
}

impl<'de, T: Described + Deserialize<'de>> Deserialize<'de> for Reference<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [what, key] = T::NAMES;
        match Value::deserialize(deserializer)? {
            Value::String(path) => Ok(Self::File(path.into())),
            Value::Table(table) if table.contains_key(key) => T::deserialize(table)
                .map(|made| Self::Made(Box::new(made)))
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a {what} is a path or a table with {key} = …, not {}",
                other.type_str()
            ))),
        }
    }
}
