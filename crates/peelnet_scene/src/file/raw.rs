//! The scene file as TOML: tables and keys. An unknown key is an error, because a misspelt one would otherwise be silently ignored.

use crate::{
    camera::Camera,
    error::{Fault, within},
    material::Lighting,
    parameters::parameters,
    pattern::Pattern,
    scatter::Scatter,
    shapes::Shape,
    texture::Wrap,
};
use serde::{Deserialize, Deserializer, de::Error as _};
use std::path::PathBuf;
use toml::Value;

/// Longest displacement, scene units, and farthest middle.
const MOST_DISPLACED: f32 = 1e9;

parameters! {
    #[derive(Debug)]
    pub(super) struct RawScene {
        name: Option<String> = None,
        background: [f32; 3] = [0.0; 3],
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

/// `[scatter]` or `[[scatter]]`: through a value, so that the inner error and not "no variant matched" is reported.
fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Scatter>, D::Error> {
    let all = match Value::deserialize(deserializer)? {
        Value::Array(list) => list,
        one => vec![one],
    };
    let read = |value| Scatter::deserialize(value).map_err(D::Error::custom);
    all.into_iter().map(read).collect()
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

/// Declares the keys of a material, all of which may be left out, with the bounds of numbers and of each number of a colour.
macro_rules! material_keys {
    ($($key:ident: $type:ty $(=> [$low:expr, $high:expr])? $(=> each [$least:expr, $most:expr])?,)*) => {
        /// The values of a material that a scene file sets; the mesh's own material has the others.
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct RawMaterial {
            $(pub $key: Option<$type>,)*
        }

        impl RawMaterial {
            /// This material's values, and an earlier state's where this one has none.
            pub fn after(&self, earlier: &Self) -> Self {
                Self { $($key: self.$key.clone().or_else(|| earlier.$key.clone()),)* }
            }

            pub fn given(&self) -> Vec<&'static str> {
                let all = [$((self.$key.is_some(), stringify!($key)),)*].into_iter();
                all.filter_map(|(given, key)| given.then_some(key)).collect()
            }

            pub fn check_bounds(&self) -> Result<(), Fault> {
                let check = |key, numbers: &[f32], low, high| {
                    numbers.iter().try_for_each(|x| within(key, *x, low, high))
                };
                $(
                    $(check(stringify!($key), self.$key.as_slice(), $low, $high)?;)?
                    $(check(stringify!($key), self.$key.as_slice().as_flattened(), $least, $most)?;)?
                )*
                Ok(())
            }
        }
    };
}

material_keys! {
    color: [f32; 3],
    alpha: f32 => [0.0, 1.0],
    lighting: Lighting,
    specular: f32 => [0.0, f32::MAX],
    // pow(0, 0) is not defined in shaders.
    shininess: f32 => [1.0, f32::MAX],
    metallic: f32 => [0.0, 1.0],
    roughness: f32 => [0.0, 1.0],
    specular_color: [f32; 3] => each [0.0, 1.0],
    glossiness: f32 => [0.0, 1.0],
    emission: [f32; 3] => each [0.0, f32::MAX],
    transmission_color: [f32; 3] => each [0.0, 1.0],
    color_map: MapRef,
    normal_map: MapRef,
    metallic_roughness_map: MapRef,
    specular_color_map: MapRef,
    glossiness_map: MapRef,
    specular_glossiness_map: MapRef,
    occlusion_map: MapRef,
    emissive_map: MapRef,
    displacement_map: MapRef,
    displacement_scale: f32 => [-MOST_DISPLACED, MOST_DISPLACED],
    displacement_middle: f32 => [-MOST_DISPLACED, MOST_DISPLACED],
    displacement_level: u32,
    normal_scale: f32 => [-100.0, 100.0],
    occlusion_strength: f32 => [0.0, 1.0],
    wrap: Wrap,
    alpha_mode: AlphaMode,
    alpha_cutoff: f32 => [0.0, 1.0],
    double_sided: bool,
    blend: bool,
}

/// What opacity means, as in glTF 2.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum AlphaMode {
    Opaque,
    Mask,
    Blend,
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

/// A path relative to the scene file, or a table that describes something generated.
#[derive(Clone, Debug)]
pub(crate) enum Reference<T> {
    File(PathBuf),
    Made(Box<T>),
}

/// A mesh: a path, or a table with `shape = …`.
pub(crate) type MeshRef = Reference<Shape>;

/// A texture: a path, or a table with `pattern = …`.
pub(crate) type MapRef = Reference<Pattern>;

/// What a table describes: the name of that, and the key that its table needs.
pub(crate) trait Made {
    const NAMES: [&str; 2];
}

impl Made for Shape {
    const NAMES: [&str; 2] = ["mesh", "shape"];
}

impl Made for Pattern {
    const NAMES: [&str; 2] = ["map", "pattern"];
}

impl<'de, T: Made + Deserialize<'de>> Deserialize<'de> for Reference<T> {
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
