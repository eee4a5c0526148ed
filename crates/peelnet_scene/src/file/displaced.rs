//! Displacement maps of materials, and the objects whose meshes they move.

use super::{loader::Loader, materials::Fault, raw::RawMaterial};
use crate::{
    displacement::{self, Displacement, MAX_LEVEL},
    error::SceneError,
    material::Material,
    mesh::Mesh,
    pattern::Pattern,
};
use glam::Mat4;
use std::sync::Arc;

/// Checks the keys of a displacement.
pub(super) fn check(raw: &RawMaterial) -> Result<(), Fault> {
    let keys = [
        ("displacement_scale", raw.displacement_scale.is_some()),
        ("displacement_middle", raw.displacement_middle.is_some()),
        ("displacement_level", raw.displacement_level.is_some()),
    ];
    if raw.displacement_map.is_none() {
        return match keys.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((key, _)) => {
                let message = "belongs to a displacement_map: add that, or leave it out";
                Err((key, message.into()))
            }
        };
    }
    if raw.displacement_scale.is_none() {
        let message = "needs displacement_scale, the length by which white rises over black";
        return Err(("displacement_map", message.into()));
    }
    for (key, x) in [
        ("displacement_scale", raw.displacement_scale),
        ("displacement_middle", raw.displacement_middle),
    ] {
        if let Some(x) = x.filter(|x| !(x.is_finite() && x.abs() <= 1e9)) {
            return Err((key, format!("{x} must be finite, and at most 1e9")));
        }
    }
    match raw.displacement_level.filter(|level| *level > MAX_LEVEL) {
        Some(level) => Err((
            "displacement_level",
            format!("{level} must lie in 0 … {MAX_LEVEL}"),
        )),
        None => Ok(()),
    }
}

impl Loader<'_> {
    /// A material's own displacement, in lengths of the scene; `None` unless textures are `read`.
    pub fn displacement(
        &mut self,
        raw: &RawMaterial,
        read: bool,
        field: &str,
    ) -> Result<Option<Displacement>, SceneError> {
        let map = raw.displacement_map.as_ref().filter(|_| read);
        let place = format!("{field}.material");
        let map = self.map(map, Pattern::grey, "displacement_map", &place)?;
        Ok(map.map(|map| Displacement {
            map,
            scale: raw.displacement_scale.unwrap_or_default(),
            middle: raw.displacement_middle.unwrap_or_default(),
            level: raw.displacement_level,
        }))
    }

    /// A mesh moved by its materials' displacements, which they have no more.
    pub fn displaced(
        &mut self,
        mesh: Arc<Mesh>,
        materials: &mut [Material],
        field: &str,
    ) -> Result<Arc<Mesh>, SceneError> {
        if materials.iter().all(|m| m.maps.displacement.is_none()) {
            return Ok(mesh);
        }
        let moved = displacement::displaced(&mesh, materials, &mut self.files.budget);
        let moved = moved.map_err(|e| self.value(field, e))?;
        for material in materials {
            material.maps.displacement = None;
        }
        Ok(Arc::new(moved))
    }
}

/// Makes a scene file's lengths those of the object, and interpolates them: `next` is the material of the next state, to which the time has gone
/// a `share` of the way. Displacements of the mesh's own file are in its lengths.
pub(super) fn in_object_space(
    materials: &mut [Material],
    [now, next]: [&RawMaterial; 2],
    share: f32,
    world_from_object: &Mat4,
) {
    if now.displacement_map.is_none() {
        return;
    }
    let mix = |a: Option<f32>, b: Option<f32>| {
        let a = a.unwrap_or_default();
        a + share * (b.unwrap_or_default() - a)
    };
    let has_next = share > 0.0 && next.displacement_map.is_some();
    let next = if has_next { next } else { now };
    let unit = world_from_object.x_axis.truncate().length();
    for material in materials {
        if let Some(displacement) = &mut material.maps.displacement {
            displacement.scale = mix(now.displacement_scale, next.displacement_scale) / unit;
            displacement.middle = mix(now.displacement_middle, next.displacement_middle);
        }
    }
}
