//! Materials of the specular–glossiness workflow, whose `color` and `color_map` are diffuse.

use super::{loader::Loader, raw::RawMaterial, references::MapRef};
use crate::{
    error::SceneError,
    material::{Lighting, Material},
    pattern::Pattern,
    specular_glossiness::{DIELECTRIC, Values},
    texture::{Maps, Texture},
};
use std::sync::Arc;

/// Values of a material that both workflows have.
pub(super) struct Finish {
    pub color: [f32; 3],
    pub metallic: f32,
    pub roughness: f32,
}

impl RawMaterial {
    /// The first key of the specular–glossiness workflow.
    fn specular_key(&self) -> Option<&'static str> {
        let keys = [
            ("specular_color", self.specular_color.is_some()),
            ("glossiness", self.glossiness.is_some()),
            ("specular_color_map", self.specular_color_map.is_some()),
            ("glossiness_map", self.glossiness_map.is_some()),
            (
                "specular_glossiness_map",
                self.specular_glossiness_map.is_some(),
            ),
        ];
        keys.into_iter()
            .find(|(_, is_given)| *is_given)
            .map(|k| k.0)
    }

    /// What speaks against that workflow.
    fn fault(&self, lighting: Lighting) -> Option<&'static str> {
        let is_metallic = self.metallic.is_some()
            || self.roughness.is_some()
            || self.metallic_roughness_map.is_some();
        let is_separate = self.specular_color_map.is_some() || self.glossiness_map.is_some();
        if is_metallic {
            return Some(
                "belongs to another workflow than metallic and roughness: give one of them",
            );
        }
        if is_separate && self.specular_glossiness_map.is_some() {
            return Some("and specular_glossiness_map mean the same: give one of them");
        }
        let is_phong = lighting == Lighting::Phong;
        is_phong.then_some("belongs to lighting = \"pbr\": add that, or leave it out")
    }
}

impl Loader<'_> {
    /// The values of a material of the specular–glossiness workflow, whose maps become those of the other; `None` of another material. Maps
    /// are those of the mesh unless they are `read`.
    pub fn specular_glossiness(
        &mut self,
        base: &Material,
        raw: &RawMaterial,
        maps: &mut Maps,
        (lighting, read): (Lighting, bool),
        field: &str,
    ) -> Result<Option<Finish>, SceneError> {
        let Some(key) = raw.specular_key() else {
            return Ok(None);
        };
        let fail = |loader: &Self, message: String| {
            loader.value(&format!("{field}.material.{key}"), message)
        };
        if let Some(message) = raw.fault(lighting) {
            return Err(fail(self, message.into()));
        }
        // An unlit surface shows its colour alone.
        if lighting == Lighting::Unlit {
            return Ok(None);
        }
        let packed = &raw.specular_glossiness_map;
        let has = |map: &Option<MapRef>| map.is_some() || packed.is_some();
        // A map multiplies the material's value, which is 1 where the file gives a map and no value.
        let values = Values {
            diffuse: raw.color.unwrap_or(base.color),
            specular: raw
                .specular_color
                .unwrap_or(if has(&raw.specular_color_map) {
                    [1.0; 3]
                } else {
                    [DIELECTRIC; 3]
                }),
            glossiness: raw.glossiness.unwrap_or(if has(&raw.glossiness_map) {
                1.0
            } else {
                1.0 - base.roughness
            }),
        };
        let maps_given = [
            packed,
            &raw.specular_color_map,
            &raw.glossiness_map,
            &raw.color_map,
        ];
        if !read && maps_given.into_iter().any(Option::is_some) {
            // Its values are in its maps.
            return Ok(Some(Finish {
                color: [1.0; 3],
                metallic: 1.0,
                roughness: 1.0,
            }));
        }
        let specular = self.specular_map(raw, read, field)?;
        let diffuse = maps.color.take();
        let budget = &mut self.files.budget;
        let converted = self
            .converter
            .convert(values, diffuse.as_ref(), specular.as_ref(), budget);
        let converted = converted.map_err(|e| fail(self, e))?;
        maps.color = converted.color_map;
        maps.metallic_roughness = converted.metallic_roughness_map;
        Ok(Some(Finish {
            color: converted.color,
            metallic: converted.metallic,
            roughness: converted.roughness,
        }))
    }

    /// Specular colours with the glossiness in alpha.
    fn specular_map(
        &mut self,
        raw: &RawMaterial,
        read: bool,
        field: &str,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let place = format!("{field}.material");
        let mut map = |map: &Option<MapRef>, of_pattern, key| {
            self.map(map.as_ref().filter(|_| read), of_pattern, key, &place)
        };
        let packed = map(
            &raw.specular_glossiness_map,
            Pattern::color,
            "specular_glossiness_map",
        )?;
        if packed.is_some() {
            return Ok(packed);
        }
        let colors = map(
            &raw.specular_color_map,
            Pattern::color,
            "specular_color_map",
        )?;
        let glossiness = map(&raw.glossiness_map, Pattern::grey, "glossiness_map")?;
        let budget = &mut self.files.budget;
        let packed = self
            .converter
            .packed(colors.as_ref(), glossiness.as_ref(), budget);
        packed.map_err(|e| self.value(&place, e))
    }
}
