//! `[[object]]` and `[[scatter]]`.

use super::{loader::Loader, materials::displace_in_object_space, raw::RawObject};
use crate::{
    displacement::displaced,
    error::{Fault, SceneError, require},
    material::{Material, RawMaterial},
    mesh::Mesh,
    scatter::{Scatter, fixed_axes},
    scene::Object,
    texture::Maps,
};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// Loads and places an object. `next` is its material at the next state of the timeline, to which the time has gone a `share` of the way.
pub(super) fn place(
    loader: &mut Loader<'_>,
    raw: &RawObject,
    next: &RawMaterial,
    share: f32,
    field: String,
) -> Result<Object, SceneError> {
    let at_mesh = format!("{field}.mesh");
    let mut given = raw.material.given().into_iter();
    let has_maps = given.any(|key| key.ends_with("_map"));
    let mut mesh = loader.mesh(&raw.mesh, has_maps, &at_mesh)?;
    if let Some(ends) = raw.vertex_colors {
        let at = format!("{field}.vertex_colors");
        if !ends.iter().flatten().all(|x| (0.0..=1.0).contains(x)) {
            let message = "must be two of [red, green, blue, alpha], each 0 … 1";
            return Err(loader.value(&at, message));
        }
        let [triangles, vertices] = [mesh.triangles.len(), mesh.positions.len()];
        let budget = &mut loader.files.budget;
        let copied = budget.take_mesh(triangles as u64, vertices as u64);
        copied.map_err(|e| loader.value(&at, e))?;
        mesh = Arc::new(mesh.colored_by_height(ends));
    }
    let world_from_object = transform(raw, &mesh).map_err(|e| loader.fault(&field, e))?;
    let taken = loader.files.budget.take_parts(1, mesh.parts.len());
    taken.map_err(|e| loader.value(&at_mesh, e))?;
    let mut materials = Vec::with_capacity(mesh.parts.len());
    for part in &mesh.parts {
        let mut shown = loader.material(&part.material, &raw.material, true, &field)?;
        if share > 0.0 {
            let next = loader.material(&part.material, next, false, &field)?;
            shown = shown.towards(&next, share);
        }
        // As a vertex of a mesh file does.
        let is_said = raw.material.alpha_mode.is_some() || raw.material.blend.is_some();
        let mut ends = raw.vertex_colors.iter().flatten();
        shown.blend |= !is_said && ends.any(|color| color[3] < 1.0);
        materials.push(shown);
    }
    if mesh.splats.is_some() {
        let given = raw.material.given().into_iter();
        for key in given.filter(|key| !matches!(*key, "color" | "alpha")) {
            let what = format!("{field}.material.{key}: changes nothing of splats; leave it out");
            loader.files.warn(loader.path, &what);
        }
    }
    let has = |map: fn(&Maps) -> bool| materials.iter().any(|m| map(&m.maps));
    for (key, is_used) in [
        ("normal_scale", has(|maps| maps.normal.is_some())),
        ("occlusion_strength", has(|maps| maps.occlusion.is_some())),
        ("wrap", has(Maps::has_any)),
    ] {
        if !is_used && raw.material.given().contains(&key) {
            let what =
                format!("{field}.material.{key}: changes nothing without a map; leave it out");
            loader.files.warn(loader.path, &what);
        }
    }
    let now = &raw.material;
    displace_in_object_space(&mut materials, now, next, share, &world_from_object);
    let at_map = format!("{field}.material.displacement_map");
    let mesh = displaced(mesh, &mut materials, &mut loader.files.budget);
    Ok(Object {
        mesh: mesh.map_err(|e| loader.value(&at_map, e))?,
        name: raw.name.clone().unwrap_or(field),
        world_from_object,
        layer: raw.layer,
        materials,
    })
}

impl RawObject {
    /// Its transform without `fit`.
    pub fn placed(&self) -> Mat4 {
        Mat4::from_translation(self.translate.into())
            * Mat4::from_quat(fixed_axes(self.rotate))
            * Mat4::from_scale(Vec3::splat(self.scale))
    }
}

fn transform(raw: &RawObject, mesh: &Mesh) -> Result<Mat4, Fault> {
    let is_scale = raw.scale.is_finite() && raw.scale != 0.0;
    require(is_scale, "scale", "must be finite and not 0")?;
    let mut turns = raw.rotate.iter().chain(&raw.translate);
    let is_finite = turns.all(|x| x.is_finite());
    require(is_finite, "translate", "and rotate must be finite")?;
    let world_from_object = raw.placed();
    let Some(fit) = raw.fit else {
        return Ok(world_from_object);
    };
    let is_length = fit.is_finite() && fit > 0.0;
    require(is_length, "fit", "must be a positive length")?;
    let (lo, hi) = mesh.main_bounds().unwrap_or_default();
    let longest = (hi - lo).max_element();
    if longest <= 0.0 {
        return Ok(world_from_object);
    }
    Ok(world_from_object
        * Mat4::from_scale(Vec3::splat(fit / longest))
        * Mat4::from_translation(-(lo + hi) / 2.0))
}

/// The objects of a scatter, seen from `eye`.
pub(super) fn scatter(
    loader: &mut Loader<'_>,
    scatter: &Scatter,
    field: &str,
    eye: Vec3,
) -> Result<Vec<Object>, SceneError> {
    scatter.check().map_err(|e| loader.fault(field, e))?;
    if scatter.jitter != 0.0 && scatter.grid.is_none() {
        let what = format!("{field}.jitter: changes nothing without a grid; leave it out");
        loader.files.warn(loader.path, &what);
    }
    let map = scatter.color_map.as_ref();
    let map = map.map(|map| loader.map(map, "color_map", field));
    let map = map.transpose()?;
    let at_mesh = format!("{field}.mesh");
    let mut meshes = Vec::new();
    for mesh in scatter.mesh_list() {
        let mesh = loader.mesh(mesh, map.is_some(), &at_mesh)?;
        let own = mesh.parts.iter().map(|p| p.material.clone());
        let mut own: Vec<Material> = own.collect();
        let mesh = displaced(mesh, &mut own, &mut loader.files.budget);
        meshes.push(mesh.map_err(|e| loader.value(&at_mesh, e))?);
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
            lighting: scatter.lighting.unwrap_or(p.material.lighting),
            // An opacity of 1 drawn from a range blends like the others.
            blend: p.material.blend
                || placed.alpha.is_some()
                || map.as_ref().is_some_and(|map| map.has_alpha),
            alpha_cutoff: p
                .material
                .cutoff_at(placed.alpha.unwrap_or(p.material.alpha)),
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
