//! Materials: a mesh's own, with the values and textures that the scene file sets.

use super::{loader::Loader, raw::MapRef};
use crate::{
    error::{Fault, SceneError, check_color},
    material::{AlphaMode, Lighting, Material, RawMaterial},
    specular_glossiness::{DIELECTRIC, Values, convert},
    texture::{Displacement, Maps, Texture},
};
use glam::Mat4;
use std::sync::Arc;

/// glTF's default.
const ALPHA_CUTOFF: f32 = 0.5;

const ADD_MAP: &str = "belongs to a displacement_map: add that, or leave it out";
const ADD_SCALE: &str = "needs displacement_scale, the length by which white rises over black";
const ADD_MASK: &str = "belongs to alpha_mode = \"mask\": add that, or leave it out";
const ONE_MODE: &str = "means the same as alpha_mode: give one of them";
const ADD_PBR: &str = "belongs to lighting = \"pbr\": add that, or leave it out";
const ONE_WORKFLOW: &str =
    "belongs to another workflow than metallic and roughness: give one of them";
const ONE_MAP: &str = "and specular_glossiness_map mean the same: give one of them";

/// Keys of the specular–glossiness workflow, whose `color` and `color_map` are diffuse, and those of the other.
const SPECULAR: [&str; 5] = [
    "specular_color",
    "glossiness",
    "specular_color_map",
    "glossiness_map",
    "specular_glossiness_map",
];
const METALLIC: [&str; 3] = ["metallic", "roughness", "metallic_roughness_map"];

/// Keys that need a displacement map.
const DISPLACED: [&str; 3] = [
    "displacement_scale",
    "displacement_middle",
    "displacement_level",
];

impl RawMaterial {
    /// The first of these keys that is given.
    fn first(&self, keys: &[&str]) -> Option<&'static str> {
        self.given().into_iter().find(|key| keys.contains(key))
    }

    /// Checks the values, and that keys which need or exclude each other do.
    fn check(&self, lighting: Lighting) -> Result<(), Fault> {
        self.check_bounds()?;
        self.color.map_or(Ok(()), check_color)?;
        let given = self.given();
        let has = |key: &str| given.contains(&key);
        let is_phong = lighting == Lighting::Phong;
        let is_masked = self.alpha_mode == Some(AlphaMode::Mask);
        let is_metallic = self.first(&METALLIC).is_some();
        let is_separate = has("specular_color_map") || has("glossiness_map");
        let specular = self.first(&SPECULAR);
        let refuse = |is_wrong: bool, key: Option<&'static str>, message: &str| match key {
            Some(key) if is_wrong => Err((key, message.to_owned())),
            _ => Ok(()),
        };
        let is_double = is_separate && has("specular_glossiness_map");
        refuse(!has("displacement_map"), self.first(&DISPLACED), ADD_MAP)?;
        let map = self.first(&["displacement_map"]);
        refuse(!has("displacement_scale"), map, ADD_SCALE)?;
        refuse(!is_masked, self.first(&["alpha_cutoff"]), ADD_MASK)?;
        refuse(has("alpha_mode"), self.first(&["blend"]), ONE_MODE)?;
        refuse(is_metallic, specular, ONE_WORKFLOW)?;
        refuse(is_double, specular, ONE_MAP)?;
        refuse(is_phong, self.first(&METALLIC), ADD_PBR)?;
        refuse(is_phong, specular, ADD_PBR)
    }

    /// The cutoff of a material's opacity, and whether it blends.
    fn opacity(&self, base: &Material, maps: &Maps) -> (Option<f32>, bool) {
        match self.alpha_mode {
            None => {
                // A colour map with transparent texels makes the surface transparent.
                let own = self.color_map.as_ref().and(maps.color.as_ref());
                let is_clear = own.is_some_and(|map| map.has_alpha);
                // Nor is a cut-out transparent between its holes unless it blends.
                let thinned = self.alpha.filter(|alpha| *alpha < 1.0);
                let is_clear = is_clear || (base.alpha_cutoff.is_some() && thinned.is_some());
                let cutoff = thinned.map_or(base.alpha_cutoff, |alpha| base.cutoff_at(alpha));
                (cutoff, self.blend.unwrap_or(base.blend || is_clear))
            }
            Some(AlphaMode::Opaque) => (Some(0.0), false),
            Some(AlphaMode::Mask) => (Some(self.alpha_cutoff.unwrap_or(ALPHA_CUTOFF)), false),
            Some(AlphaMode::Blend) => (None, true),
        }
    }
}

impl Loader<'_> {
    /// A mesh's material with the scene file's values. Textures stay the mesh's unless they are `read`.
    pub fn material(
        &mut self,
        base: &Material,
        raw: &RawMaterial,
        read: bool,
        object: &str,
    ) -> Result<Material, SceneError> {
        let table = format!("{object}.material");
        let lighting = raw.lighting.unwrap_or(base.lighting);
        raw.check(lighting).map_err(|e| self.fault(&table, e))?;
        let mut map = |map: &Option<MapRef>, key: &str, base: &Option<Arc<Texture>>| match map {
            Some(map) if read => self.map(map, key, &table).map(Some),
            _ => Ok::<_, SceneError>(base.clone()),
        };
        let own = &base.maps;
        let displacement = match &raw.displacement_map {
            None => own.displacement.clone(),
            file => map(file, "displacement_map", &None)?.map(|map| Displacement {
                map,
                scale: raw.displacement_scale.unwrap_or_default(),
                middle: raw.displacement_middle.unwrap_or_default(),
                level: raw.displacement_level,
            }),
        };
        let maps = Maps {
            color: map(&raw.color_map, "color_map", &own.color)?,
            normal: map(&raw.normal_map, "normal_map", &own.normal)?,
            metallic_roughness: map(
                &raw.metallic_roughness_map,
                "metallic_roughness_map",
                &own.metallic_roughness,
            )?,
            occlusion: map(&raw.occlusion_map, "occlusion_map", &own.occlusion)?,
            emissive: map(&raw.emissive_map, "emissive_map", &own.emissive)?,
            displacement,
            wrap: raw.wrap.map_or(own.wrap, |wrap| [wrap; 2]),
            ..own.clone()
        };
        let (alpha_cutoff, blend) = raw.opacity(base, &maps);
        // A map multiplies the material's value, which is 1 where the file gives a map and no value.
        let by_map = |map: &Option<MapRef>, base: f32| if map.is_some() { 1.0 } else { base };
        let metal = &raw.metallic_roughness_map;
        let mut material = Material {
            lighting,
            metallic: by_map(metal, base.metallic),
            roughness: by_map(metal, base.roughness),
            emission: base.emission.map(|c| by_map(&raw.emissive_map, c)),
            maps,
            alpha_cutoff,
            double_sided: raw.double_sided.unwrap_or(base.double_sided),
            blend,
            ..base.clone()
        };
        raw.set_numbers(&mut material);
        match raw.first(&SPECULAR) {
            // An unlit surface shows its colour alone.
            Some(key) if lighting != Lighting::Unlit => {
                self.converted(material, base.roughness, raw, read, [&table, key])
            }
            _ => Ok(material),
        }
    }

    /// A material of the specular–glossiness workflow, as one of the other.
    fn converted(
        &mut self,
        mut material: Material,
        base_roughness: f32,
        raw: &RawMaterial,
        read: bool,
        [table, key]: [&str; 2],
    ) -> Result<Material, SceneError> {
        let packed = &raw.specular_glossiness_map;
        let (colors, glossiness) = (&raw.specular_color_map, &raw.glossiness_map);
        let mut all = [packed, colors, glossiness, &raw.color_map].into_iter();
        if !read && all.any(Option::is_some) {
            // Its values are in its maps.
            (material.color, material.metallic, material.roughness) = ([1.0; 3], 1.0, 1.0);
            return Ok(material);
        }
        let has = |map: &Option<MapRef>| map.is_some() || packed.is_some();
        let by_map = |map, other: f32| if has(map) { 1.0 } else { other };
        let values = Values {
            diffuse: material.color,
            specular: raw
                .specular_color
                .unwrap_or([by_map(colors, DIELECTRIC); 3]),
            glossiness: raw
                .glossiness
                .unwrap_or(by_map(glossiness, 1.0 - base_roughness)),
        };
        let mut map = |map: &Option<MapRef>, key: &str| {
            let read = map.as_ref().map(|map| self.map(map, key, table));
            read.transpose()
        };
        // Specular colours with the glossiness in alpha.
        let specular = match map(packed, "specular_glossiness_map")? {
            Some(packed) => Ok(Some(packed)),
            None => {
                let colors = map(colors, "specular_color_map")?;
                let glossiness = map(glossiness, "glossiness_map")?;
                let both = [colors.as_ref(), glossiness.as_ref()];
                let packed = (both != [None, None]).then(|| {
                    let texel = |s: [u8; 4], g: [u8; 4]| [s[0], s[1], s[2], g[0]];
                    self.files.joined("gloss", both, texel)
                });
                packed.transpose()
            }
        };
        let converted = specular.and_then(|specular| {
            convert(values, &mut material, specular.as_ref(), &mut self.files)
        });
        converted.map_err(|e| self.value(&format!("{table}.{key}"), e))?;
        Ok(material)
    }
}

/// Makes a scene file's lengths those of the object, and interpolates them: `next` is the material of the next state, to which the time has gone
/// a `share` of the way. Displacements of the mesh's own file are in its lengths.
pub(super) fn displace_in_object_space(
    materials: &mut [Material],
    now: &RawMaterial,
    next: &RawMaterial,
    share: f32,
    world_from_object: &Mat4,
) {
    if now.displacement_map.is_none() {
        return;
    }
    let has_next = share > 0.0 && next.displacement_map.is_some();
    let next = if has_next { next } else { now };
    let mix = |a: Option<f32>, b: Option<f32>| {
        let a = a.unwrap_or_default();
        a + share * (b.unwrap_or_default() - a)
    };
    let unit = world_from_object.x_axis.truncate().length();
    for displacement in materials.iter_mut().flat_map(|m| &mut m.maps.displacement) {
        displacement.scale = mix(now.displacement_scale, next.displacement_scale) / unit;
        displacement.middle = mix(now.displacement_middle, next.displacement_middle);
    }
}
