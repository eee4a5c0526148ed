//! The scene file as TOML: tables and keys. An unknown key is an error, because a misspelt one would otherwise be silently ignored.

use super::references::{MapRef, MeshRef};
use crate::{scatter::Scatter, texture::Wrap};
use serde::{Deserialize, Deserializer, de::Error as _};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawScene {
    pub name: Option<String>,
    #[serde(default)]
    pub background: [f32; 3],
    #[serde(default = "one")]
    pub transparency_scale: f32,
    #[serde(default)]
    pub held_out: bool,
    pub camera: Option<RawCamera>,
    #[serde(default)]
    pub view: Vec<RawCamera>,
    pub orbit: Option<RawOrbit>,
    #[serde(default)]
    pub light: Vec<RawLight>,
    #[serde(default)]
    pub object: Vec<RawObject>,
    #[serde(default)]
    pub scatter: OneOrMany<Scatter>,
    #[serde(default)]
    pub timeline: Vec<RawState>,
}

/// `[scatter]` or `[[scatter]]`.
#[derive(Debug)]
pub(super) struct OneOrMany<T>(pub Vec<T>);

impl<T> Default for OneOrMany<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Through a value, so that the inner error and not "no variant matched" is reported.
        match toml::Value::deserialize(deserializer)? {
            toml::Value::Array(list) => list
                .into_iter()
                .map(|v| T::deserialize(v).map_err(D::Error::custom))
                .collect::<Result<_, _>>()
                .map(Self),
            one => T::deserialize(one)
                .map_err(D::Error::custom)
                .map(|one| Self(vec![one])),
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawCamera {
    pub position: [f32; 3],
    pub target: [f32; 3],
    #[serde(default = "up")]
    pub up: [f32; 3],
    #[serde(default = "fov")]
    pub fov_y: f32,
    pub near: f32,
    pub far: f32,
}

const fn up() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

const fn fov() -> f32 {
    45.0
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawOrbit {
    pub views: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLight {
    pub position: Option<[f32; 3]>,
    pub direction: Option<[f32; 3]>,
    #[serde(default = "white")]
    pub color: [f32; 3],
    #[serde(default = "one")]
    pub intensity: f32,
}

const fn white() -> [f32; 3] {
    [1.0; 3]
}

const fn one() -> f32 {
    1.0
}

#[derive(Debug, Deserialize)]
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

/// The values of a material that a scene file sets; the mesh's own material has the others.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMaterial {
    pub color: Option<[f32; 3]>,
    pub alpha: Option<f32>,
    pub lighting: Option<String>,
    pub specular: Option<f32>,
    pub shininess: Option<f32>,
    pub metallic: Option<f32>,
    pub roughness: Option<f32>,
    pub specular_color: Option<[f32; 3]>,
    pub glossiness: Option<f32>,
    pub emission: Option<[f32; 3]>,
    pub transmission_color: Option<[f32; 3]>,
    pub color_map: Option<MapRef>,
    pub normal_map: Option<MapRef>,
    pub metallic_roughness_map: Option<MapRef>,
    pub specular_color_map: Option<MapRef>,
    pub glossiness_map: Option<MapRef>,
    pub specular_glossiness_map: Option<MapRef>,
    pub occlusion_map: Option<MapRef>,
    pub emissive_map: Option<MapRef>,
    pub displacement_map: Option<MapRef>,
    pub displacement_scale: Option<f32>,
    pub displacement_middle: Option<f32>,
    pub displacement_level: Option<u32>,
    pub normal_scale: Option<f32>,
    pub occlusion_strength: Option<f32>,
    pub wrap: Option<Wrap>,
    pub alpha_mode: Option<AlphaMode>,
    pub alpha_cutoff: Option<f32>,
    pub double_sided: Option<bool>,
    pub blend: Option<bool>,
}

impl RawMaterial {
    pub fn has_maps(&self) -> bool {
        let maps = [
            &self.color_map,
            &self.normal_map,
            &self.metallic_roughness_map,
            &self.specular_color_map,
            &self.glossiness_map,
            &self.specular_glossiness_map,
            &self.occlusion_map,
            &self.emissive_map,
            &self.displacement_map,
        ];
        maps.into_iter().any(Option::is_some)
    }

    /// This material's values, and an earlier state's where this one has none.
    pub fn after(&self, earlier: &Self) -> Self {
        macro_rules! later {
            ($($field:ident),*) => { Self { $($field: self.$field.clone().or_else(|| earlier.$field.clone())),* } };
        }
        later!(
            color,
            alpha,
            lighting,
            specular,
            shininess,
            metallic,
            roughness,
            specular_color,
            glossiness,
            emission,
            transmission_color,
            color_map,
            normal_map,
            metallic_roughness_map,
            specular_color_map,
            glossiness_map,
            specular_glossiness_map,
            occlusion_map,
            emissive_map,
            displacement_map,
            displacement_scale,
            displacement_middle,
            displacement_level,
            normal_scale,
            occlusion_strength,
            wrap,
            alpha_mode,
            alpha_cutoff,
            double_sided,
            blend
        )
    }
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

/// What changes of an object.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawChange {
    pub name: String,
    pub mesh: Option<MeshRef>,
    #[serde(default)]
    pub material: RawMaterial,
}
