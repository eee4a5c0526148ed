//! Materials: a mesh's own, with the values and textures that the scene file sets.

use super::{
    displaced,
    loader::Loader,
    raw::{AlphaMode, RawMaterial},
    references::MapRef,
    specular::Finish,
};
use crate::{
    error::SceneError,
    material::{Lighting, Material},
    pattern::Pattern,
    texture::{Maps, Texture},
};
use peelnet_files::printable;
use std::sync::Arc;

/// glTF's default.
const ALPHA_CUTOFF: f32 = 0.5;

impl Loader<'_> {
    /// The lighting that a word names.
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
                format!(
                    "\"{}\" is not one of \"unlit\", \"phong\", \"pbr\"",
                    printable(other)
                ),
            )),
        }
    }

    /// A texture: a file, read once, or a generated pattern, read as its use asks. `field` is the table of the key.
    pub fn map(
        &mut self,
        map: Option<&MapRef>,
        of_pattern: fn(&Pattern) -> Result<Texture, String>,
        key: &'static str,
        field: &str,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        match map {
            None => Ok(None),
            Some(MapRef::Pattern(pattern)) => {
                let texture = self.pattern(pattern, of_pattern, key);
                texture
                    .map(Some)
                    .map_err(|e| self.value(&format!("{field}.{key}"), e))
            }
            Some(MapRef::File(name)) => self.texture(name).map(Some),
        }
    }

    /// The textures of a material: those of the scene file, else the mesh's.
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
        let displacement = match &raw.displacement_map {
            Some(_) => self.displacement(raw, read, field)?,
            None => base.displacement.clone(),
        };
        let mut map = |map: &Option<MapRef>, of_pattern, key, base: &Option<Arc<Texture>>| {
            let own = map.as_ref().filter(|_| read);
            let own = self.map(own, of_pattern, key, &format!("{field}.material"))?;
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
            displacement,
            normal_scale: raw.normal_scale.unwrap_or(base.normal_scale),
            occlusion_strength: raw.occlusion_strength.unwrap_or(base.occlusion_strength),
            wrap: raw.wrap.map_or(base.wrap, |wrap| [wrap; 2]),
            nearest: base.nearest,
        })
    }

    /// A mesh's material with the scene file's values. Textures stay the mesh's unless they are `read`.
    pub fn material(
        &mut self,
        base: &Material,
        raw: &RawMaterial,
        read: bool,
        field: &str,
    ) -> Result<Material, SceneError> {
        let mut maps = self.maps(&base.maps, raw, read, field)?;
        let fail = |(key, message): (&str, String)| {
            self.value(&format!("{field}.material.{key}"), message)
        };
        check_numbers(raw).map_err(fail)?;
        let (alpha_cutoff, blend) = opacity(base, raw, &maps).map_err(fail)?;
        let lighting = self
            .lighting_word(
                raw.lighting.as_deref(),
                &format!("{field}.material.lighting"),
            )?
            .unwrap_or(base.lighting);
        if raw.metallic_roughness_map.is_some() && lighting == Lighting::Phong {
            let message = "belongs to lighting = \"pbr\": add that, or leave it out";
            return Err(fail(("metallic_roughness_map", message.into())));
        }
        let converted = self.specular_glossiness(base, raw, &mut maps, (lighting, read), field)?;
        // A map multiplies the material's value, which is 1 where the file gives a map and no value.
        let by_map = |map: &Option<MapRef>, base: f32| if map.is_some() { 1.0 } else { base };
        let metal = &raw.metallic_roughness_map;
        let Finish {
            color,
            metallic,
            roughness,
        } = converted.unwrap_or(Finish {
            color: raw.color.unwrap_or(base.color),
            metallic: raw.metallic.unwrap_or(by_map(metal, base.metallic)),
            roughness: raw.roughness.unwrap_or(by_map(metal, base.roughness)),
        });
        Ok(Material {
            name: base.name.clone(),
            color,
            alpha: raw.alpha.unwrap_or(base.alpha),
            lighting,
            specular: raw.specular.unwrap_or(base.specular),
            shininess: raw.shininess.unwrap_or(base.shininess),
            metallic,
            roughness,
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

/// A key of a material, and what is wrong with its value.
pub(super) type Fault = (&'static str, String);

fn in_unit(key: &'static str, x: f32) -> Result<f32, Fault> {
    if (0.0..=1.0).contains(&x) {
        Ok(x)
    } else {
        Err((key, format!("{x} must lie in 0 … 1")))
    }
}

/// Checks the colour of a surface or a light.
pub(crate) fn check_color(color: [f32; 3]) -> Result<(), String> {
    match color.into_iter().find(|x| !(0.0..=1.0).contains(x)) {
        None => Ok(()),
        Some(x) => Err(format!(
            "{x} must lie in 0 … 1: divide numbers of 0 … 255 by 255; what is brighter than white has an emission or an intensity"
        )),
    }
}

/// Checks the ranges of a material's numbers.
fn check_numbers(raw: &RawMaterial) -> Result<(), Fault> {
    for x in raw.transmission_color.into_iter().flatten() {
        in_unit("transmission_color", x)?;
    }
    for x in raw.specular_color.into_iter().flatten() {
        in_unit("specular_color", x)?;
    }
    for (key, x) in [
        ("alpha", raw.alpha),
        ("metallic", raw.metallic),
        ("roughness", raw.roughness),
        ("glossiness", raw.glossiness),
    ] {
        x.map_or(Ok(0.0), |x| in_unit(key, x))?;
    }
    if let Some(color) = raw.color {
        check_color(color).map_err(|e| ("color", e))?;
    }
    let colors = [("emission", raw.emission)];
    let colors = colors.map(|(key, color)| (key, color.map_or(Vec::new(), Vec::from)));
    let specular = ("specular", raw.specular.into_iter().collect());
    for (key, numbers) in colors.into_iter().chain([specular]) {
        if let Some(x) = numbers.iter().find(|x| !(x.is_finite() && **x >= 0.0)) {
            return Err((key, format!("{x} must be finite and not negative")));
        }
    }
    displaced::check(raw)?;
    // pow(0, 0) is not defined in shaders.
    let is_sharp = |x: &f32| x.is_finite() && *x >= 1.0;
    match raw.shininess.filter(|x| !is_sharp(x)) {
        Some(x) => Err(("shininess", format!("{x} must be finite and at least 1"))),
        None => Ok(()),
    }
}

/// The cutoff of a material's opacity, and whether it blends.
fn opacity(base: &Material, raw: &RawMaterial, maps: &Maps) -> Result<(Option<f32>, bool), Fault> {
    if raw.alpha_cutoff.is_some() && raw.alpha_mode != Some(AlphaMode::Mask) {
        let message = "belongs to alpha_mode = \"mask\": add that, or leave it out";
        return Err(("alpha_cutoff", message.into()));
    }
    if raw.alpha_mode.is_some() && raw.blend.is_some() {
        let message = "means the same as alpha_mode: give one of them";
        return Err(("blend", message.into()));
    }
    let cutoff = raw.alpha_cutoff.unwrap_or(ALPHA_CUTOFF);
    Ok(match raw.alpha_mode {
        None => {
            // A colour map with transparent texels makes the surface transparent.
            let own = raw.color_map.as_ref().and(maps.color.as_ref());
            let is_clear = own.is_some_and(|map| map.has_alpha());
            (
                base.alpha_cutoff,
                raw.blend.unwrap_or(base.blend || is_clear),
            )
        }
        Some(AlphaMode::Opaque) => (Some(0.0), false),
        Some(AlphaMode::Mask) => (Some(in_unit("alpha_cutoff", cutoff)?), false),
        Some(AlphaMode::Blend) => (None, true),
    })
}
