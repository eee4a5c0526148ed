//! A material in a scene file: what it says of a mesh's own one, and its images.

use super::Loader;
use crate::{
    Lighting, Maps, Material, SceneError, Texture, Wrap, files::FileKind, pattern::Pattern,
};
use serde::{Deserialize, Deserializer, de::Error as _};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMaterial {
    color: Option<[f32; 3]>,
    alpha: Option<f32>,
    lighting: Option<String>,
    specular: Option<f32>,
    shininess: Option<f32>,
    metallic: Option<f32>,
    roughness: Option<f32>,
    emission: Option<[f32; 3]>,
    transmission_color: Option<[f32; 3]>,
    color_map: Option<MapRef>,
    normal_map: Option<MapRef>,
    metallic_roughness_map: Option<MapRef>,
    occlusion_map: Option<MapRef>,
    emissive_map: Option<MapRef>,
    normal_scale: Option<f32>,
    occlusion_strength: Option<f32>,
    wrap: Option<Wrap>,
    alpha_mode: Option<AlphaMode>,
    alpha_cutoff: Option<f32>,
    double_sided: Option<bool>,
    blend: Option<bool>,
}

impl RawMaterial {
    pub fn has_maps(&self) -> bool {
        let maps = [
            &self.color_map,
            &self.normal_map,
            &self.metallic_roughness_map,
            &self.occlusion_map,
            &self.emissive_map,
        ];
        maps.into_iter().any(Option::is_some)
    }

    /// What an earlier state says, but for what this one says anew.
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
            emission,
            transmission_color,
            color_map,
            normal_map,
            metallic_roughness_map,
            occlusion_map,
            emissive_map,
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

/// An image in a scene file: a path, or a table with `pattern = …`.
#[derive(Clone, Debug, PartialEq)]
pub enum MapRef {
    /// A file, relative to the scene file.
    File(PathBuf),
    /// A generated pattern.
    Pattern(Box<Pattern>),
}

impl<'de> Deserialize<'de> for MapRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(path) => Ok(Self::File(path.into())),
            table @ toml::Value::Table(_) => Pattern::deserialize(table)
                .map(|pattern| Self::Pattern(Box::new(pattern)))
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a map is a path or a table with pattern = …, not {}",
                other.type_str()
            ))),
        }
    }
}

/// What opacity means, as in glTF 2.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum AlphaMode {
    Opaque,
    Mask,
    Blend,
}

/// glTF's default.
const ALPHA_CUTOFF: f32 = 0.5;

impl Loader<'_> {
    pub fn lighting_word(
        &self,
        word: Option<&str>,
        field: &str,
    ) -> Result<Option<Lighting>, SceneError> {
        match word {
            None => Ok(None),
            Some("unlit") => Ok(Some(Lighting::Unlit)),
            Some("phong") => Ok(Some(Lighting::Phong)),
            Some("pbr") => Ok(Some(Lighting::Pbr)),
            Some(other) => Err(self.value(
                field,
                format!("\"{other}\" is not one of \"unlit\", \"phong\", \"pbr\""),
            )),
        }
    }

    /// An image: a file, read once, or a pattern read as what it is for.
    fn map(
        &mut self,
        map: Option<&MapRef>,
        of_pattern: fn(&Pattern) -> Result<Texture, String>,
        field: &str,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let file = match map {
            None => return Ok(None),
            Some(MapRef::Pattern(pattern)) => {
                let texture = of_pattern(pattern).map_err(|e| self.value(field, e))?;
                return Ok(Some(Arc::new(texture)));
            }
            Some(MapRef::File(name)) => self.path.parent().unwrap_or(Path::new(".")).join(name),
        };
        if let Some(known) = self.images.get(&file) {
            return Ok(Some(Arc::clone(known)));
        }
        let bytes = self.files.read(&file, FileKind::Image)?;
        let texture = Texture::decode(&file.display().to_string(), &bytes);
        let texture = Arc::new(texture.map_err(|message| SceneError::Mesh {
            path: file.clone(),
            line: None,
            message,
        })?);
        self.files.record(&file, &bytes);
        self.images.insert(file, Arc::clone(&texture));
        Ok(Some(texture))
    }

    /// The images of a material: those given, and the base's where none is.
    fn maps(
        &mut self,
        base: &Maps,
        raw: &RawMaterial,
        read: bool,
        field: &str,
    ) -> Result<Maps, SceneError> {
        let at = |key: &str| format!("{field}.material.{key}");
        let number = |x: f32| x.is_finite() && x.abs() <= 100.0;
        if let Some(x) = raw.normal_scale.filter(|x| !number(*x)) {
            return Err(self.value(&at("normal_scale"), format!("{x} must lie in -100 … 100")));
        }
        let strength = raw.occlusion_strength.filter(|x| !(0.0..=1.0).contains(x));
        if let Some(x) = strength {
            return Err(self.value(&at("occlusion_strength"), format!("{x} must lie in 0 … 1")));
        }
        let mut map = |map: &Option<MapRef>, of_pattern, key: &str, base: &Option<Arc<Texture>>| {
            let own = self.map(map.as_ref().filter(|_| read), of_pattern, &at(key))?;
            Ok::<_, SceneError>(own.or_else(|| base.clone()))
        };
        let metal = &raw.metallic_roughness_map;
        Ok(Maps {
            color: map(&raw.color_map, Pattern::color, "color_map", &base.color)?,
            normal: map(
                &raw.normal_map,
                Pattern::normals,
                "normal_map",
                &base.normal,
            )?,
            metallic_roughness: map(
                metal,
                Pattern::metallic_roughness,
                "metallic_roughness_map",
                &base.metallic_roughness,
            )?,
            occlusion: map(
                &raw.occlusion_map,
                Pattern::occlusion,
                "occlusion_map",
                &base.occlusion,
            )?,
            emissive: map(
                &raw.emissive_map,
                Pattern::color,
                "emissive_map",
                &base.emissive,
            )?,
            normal_scale: raw.normal_scale.unwrap_or(base.normal_scale),
            occlusion_strength: raw.occlusion_strength.unwrap_or(base.occlusion_strength),
            wrap: raw.wrap.map_or(base.wrap, |wrap| [wrap; 2]),
            nearest: base.nearest,
        })
    }

    /// A mesh's material with what a scene file says of it; images are left as they are unless they are `read`.
    pub fn material(
        &mut self,
        base: &Material,
        raw: &RawMaterial,
        read: bool,
        field: &str,
    ) -> Result<Material, SceneError> {
        let maps = self.maps(&base.maps, raw, read, field)?;
        let at = |key: &str| format!("{field}.material.{key}");
        let unit = |key: &str, x: f32| {
            if (0.0..=1.0).contains(&x) {
                Ok(x)
            } else {
                Err(self.value(&at(key), format!("{x} must lie in 0 … 1")))
            }
        };
        let not_negative = |key: &str, x: f32| {
            if x.is_finite() && x >= 0.0 {
                Ok(x)
            } else {
                Err(self.value(&at(key), format!("{x} must be finite and not negative")))
            }
        };
        for c in raw.transmission_color.into_iter().flatten() {
            unit("transmission_color", c)?;
        }
        for (key, color) in [("color", raw.color), ("emission", raw.emission)] {
            for c in color.into_iter().flatten() {
                not_negative(key, c)?;
            }
        }
        if raw.alpha_cutoff.is_some() && raw.alpha_mode != Some(AlphaMode::Mask) {
            let mend = "belongs to alpha_mode = \"mask\": add that, or leave it out";
            return Err(self.value(&at("alpha_cutoff"), mend));
        }
        if raw.alpha_mode.is_some() && raw.blend.is_some() {
            let mend = "says what alpha_mode says: give one of them";
            return Err(self.value(&at("blend"), mend));
        }
        let cutoff = raw.alpha_cutoff.unwrap_or(ALPHA_CUTOFF);
        let (alpha_cutoff, blend) = match raw.alpha_mode {
            None => {
                // An image that can be seen through is meant to be.
                let own = raw.color_map.as_ref().and(maps.color.as_ref());
                let clear = own.is_some_and(|map| map.has_alpha());
                let blend = raw.blend.unwrap_or(base.blend || clear);
                (base.alpha_cutoff, blend)
            }
            Some(AlphaMode::Opaque) => (Some(0.0), false),
            Some(AlphaMode::Mask) => (Some(unit("alpha_cutoff", cutoff)?), false),
            Some(AlphaMode::Blend) => (None, true),
        };
        let lighting = self
            .lighting_word(raw.lighting.as_deref(), &at("lighting"))?
            .unwrap_or(base.lighting);
        if raw.metallic_roughness_map.is_some() && lighting == Lighting::Phong {
            let mend = "belongs to lighting = \"pbr\": add that, or leave it out";
            return Err(self.value(&at("metallic_roughness_map"), mend));
        }
        // A map multiplies the material's value: all of it counts where no value is given.
        let by_map = |map: &Option<MapRef>, base: f32| if map.is_some() { 1.0 } else { base };
        let metal = &raw.metallic_roughness_map;
        Ok(Material {
            name: base.name.clone(),
            color: raw.color.unwrap_or(base.color),
            alpha: raw.alpha.map_or(Ok(base.alpha), |a| unit("alpha", a))?,
            lighting,
            specular: raw
                .specular
                .map_or(Ok(base.specular), |x| not_negative("specular", x))?,
            shininess: raw.shininess.map_or(Ok(base.shininess), |x| {
                if x.is_finite() && x >= 1.0 {
                    Ok(x)
                } else {
                    // pow(0, 0) is not defined in shaders.
                    Err(self.value(
                        &at("shininess"),
                        format!("{x} must be finite and at least 1"),
                    ))
                }
            })?,
            metallic: raw
                .metallic
                .map_or(Ok(by_map(metal, base.metallic)), |x| unit("metallic", x))?,
            roughness: raw
                .roughness
                .map_or(Ok(by_map(metal, base.roughness)), |x| unit("roughness", x))?,
            emission: raw
                .emission
                .unwrap_or(base.emission.map(|c| by_map(&raw.emissive_map, c))),
            transmission: raw.transmission_color.unwrap_or(base.transmission),
            maps,
            alpha_cutoff,
            double_sided: raw.double_sided.unwrap_or(base.double_sided),
            blend,
        })
    }
}
