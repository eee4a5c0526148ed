//! `[[object]]` and `[[scatter]]`.

use super::{displaced, loader::Loader, raw::RawObject, timeline::Snapshot};
use crate::{
    error::SceneError,
    material::Material,
    mesh::Mesh,
    pattern::Pattern,
    scatter::{Scatter, fixed_axes},
    scene::Object,
    texture::Maps,
};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// What is wrong with a mesh without UVs whose material has textures.
const NO_UVS: &str = "has no texture coordinates for its material's maps; export it with them";

/// Loads and places an object as it is at the time that is shown.
pub(super) fn place(
    loader: &mut Loader<'_>,
    raw: &RawObject,
    index: usize,
    snapshot: &Snapshot,
) -> Result<Object, SceneError> {
    let field = format!("object {}", index + 1);
    let name = raw.name.as_deref().unwrap_or_default();
    let [now, next] = snapshot.changes.get(name).cloned().unwrap_or_default();
    let material = now.material.after(&raw.material);
    let has_maps = material.has_maps();
    let mesh = now.mesh.as_ref().unwrap_or(&raw.mesh);
    let mesh = loader.mesh(mesh, has_maps, &format!("{field}.mesh"))?;
    if has_maps && mesh.uvs.is_empty() {
        return Err(loader.value(&format!("{field}.mesh"), NO_UVS));
    }
    let mesh = match raw.vertex_colors {
        None => mesh,
        Some(ends) if ends.iter().flatten().all(|x| (0.0..=1.0).contains(x)) => {
            let copied = loader.files.budget.take_copy(&mesh);
            copied.map_err(|e| loader.value(&format!("{field}.vertex_colors"), e))?;
            Arc::new(mesh.colored_by_height(ends))
        }
        Some(_) => {
            return Err(loader.value(
                &format!("{field}.vertex_colors"),
                "must be two of [red, green, blue, alpha], each 0 … 1",
            ));
        }
    };
    let world_from_object = transform(raw, &mesh)
        .map_err(|(key, message)| loader.value(&format!("{field}{key}"), message))?;
    let taken = loader.files.budget.take_parts(1, mesh.parts.len());
    taken.map_err(|e| loader.value(&format!("{field}.mesh"), e))?;
    let mut materials = Vec::with_capacity(mesh.parts.len());
    let later = next.material.after(&raw.material);
    for part in &mesh.parts {
        let mut shown = loader.material(&part.material, &material, true, &field)?;
        if snapshot.share > 0.0 {
            let next = loader.material(&part.material, &later, false, &field)?;
            shown = shown.towards(&next, snapshot.share);
        }
        materials.push(shown);
    }
    let states = [&material, &later];
    displaced::in_object_space(&mut materials, states, snapshot.share, &world_from_object);
    let place = format!("{field}.material.displacement_map");
    let mesh = loader.displaced(mesh, &mut materials, &place)?;
    Ok(Object {
        name: raw.name.clone().unwrap_or(field),
        mesh,
        world_from_object,
        layer: raw.layer,
        materials,
    })
}

/// An object's transform. An error holds the key, to be appended to the object's field, and what is wrong.
fn transform(raw: &RawObject, mesh: &Mesh) -> Result<Mat4, (&'static str, &'static str)> {
    let is_finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
    if !(raw.scale.is_finite() && raw.scale != 0.0) {
        return Err((".scale", "must be finite and not 0"));
    }
    if !is_finite(&raw.rotate) || !is_finite(&raw.translate) {
        return Err(("", "rotate and translate must be finite"));
    }
    let mut world_from_object = Mat4::from_translation(raw.translate.into())
        * Mat4::from_quat(fixed_axes(raw.rotate))
        * Mat4::from_scale(Vec3::splat(raw.scale));
    if let Some(fit) = raw.fit {
        if !(fit.is_finite() && fit > 0.0) {
            return Err((".fit", "must be a positive length"));
        }
        if let Some((lo, hi)) = mesh.bounds() {
            let longest = (hi - lo).max_element();
            if longest > 0.0 {
                world_from_object = world_from_object
                    * Mat4::from_scale(Vec3::splat(fit / longest))
                    * Mat4::from_translation(-(lo + hi) / 2.0);
            }
        }
    }
    Ok(world_from_object)
}

/// The objects of a scatter, seen from `eye`.
pub(super) fn scatter(
    loader: &mut Loader<'_>,
    scatter: &Scatter,
    index: usize,
    eye: Vec3,
) -> Result<Vec<Object>, SceneError> {
    let field = format!("scatter {}", index + 1);
    scatter
        .check()
        .map_err(|(key, message)| loader.value(&format!("{field}.{key}"), message))?;
    let lighting =
        loader.lighting_word(scatter.lighting.as_deref(), &format!("{field}.lighting"))?;
    let map = scatter.color_map.as_ref();
    let map = loader.map(map, Pattern::color, "color_map", &field)?;
    let mut meshes = Vec::new();
    for mesh in scatter.mesh_list() {
        let mesh = loader.mesh(mesh, map.is_some(), &format!("{field}.mesh"))?;
        if map.is_some() && mesh.uvs.is_empty() {
            return Err(loader.value(&format!("{field}.mesh"), NO_UVS));
        }
        let own = mesh.parts.iter().map(|p| p.material.clone());
        let mut own: Vec<Material> = own.collect();
        meshes.push(loader.displaced(mesh, &mut own, &format!("{field}.mesh"))?);
    }
    let parts = meshes.iter().map(|m| m.parts.len()).max().unwrap_or(0);
    let taken = loader.files.budget.take_parts(scatter.count, parts);
    taken.map_err(|e| loader.value(&format!("{field}.count"), e))?;
    let placed = scatter.place(eye).into_iter().enumerate();
    let objects = placed.map(|(i, placed)| {
        let mesh = Arc::clone(&meshes[placed.mesh]);
        let materials = mesh.parts.iter().map(|p| Material {
            color: placed.color.unwrap_or(p.material.color),
            alpha: placed.alpha.unwrap_or(p.material.alpha),
            lighting: lighting.unwrap_or(p.material.lighting),
            // An opacity of 1 drawn from a range blends like the others.
            blend: placed.alpha.is_some() || map.as_ref().is_some_and(|map| map.has_alpha()),
            maps: Maps {
                color: map.clone().or_else(|| p.material.maps.color.clone()),
                ..p.material.maps.clone()
            },
            ..p.material.clone()
        });
        Object {
            name: format!("{field}, {}", i + 1),
            materials: materials.collect(),
            mesh,
            world_from_object: placed.world_from_object,
            layer: scatter.layer,
        }
    });
    Ok(objects.collect())
}
