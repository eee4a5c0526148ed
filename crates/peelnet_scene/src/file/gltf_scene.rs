//! A glTF file as a whole scene.

use crate::{
    camera::Camera,
    error::{SceneError, shown},
    files::Files,
    gltf::{self, GltfCamera},
    material::Lighting,
    mesh::Part,
    scene::{Light, Object, Scene, Source},
};
use glam::{Mat4, Vec3};
use std::{path::Path, sync::Arc};

/// A glTF file with its own lights and cameras; where it has none, with two lights, and a camera that sees all of it.
pub(super) fn load(path: &Path, mut files: Files<'_>) -> Result<Scene, SceneError> {
    let loaded = gltf::load(path, &mut files)?;
    let (low, high) = loaded.mesh.bounds().unwrap_or_default();
    let bounds = Bounds {
        middle: (low + high) / 2.0,
        radius: ((high - low).length() / 2.0).max(1e-6),
    };
    let cameras = loaded.cameras.iter();
    let mut views: Vec<Camera> = cameras.filter_map(|c| camera(c, bounds)).collect();
    if views.is_empty() {
        views.push(fitting_camera(bounds));
    }
    let mut lights = loaded.lights;
    let mut warnings = loaded.warnings;
    let is_lit = |p: &Part| p.material.lighting == Lighting::Pbr;
    if lights.is_empty() && loaded.mesh.parts.iter().any(is_lit) {
        warnings.push(format!(
            "{}: has no point light: two are added; put it into a scene file with lights of your own, or none",
            shown(path)
        ));
        lights.extend(default_lights(bounds));
    }
    let name = super::name_of(path);
    let materials = loaded.mesh.parts.iter().map(|p| p.material.clone());
    let object = Object {
        name: name.clone(),
        materials: materials.collect(),
        mesh: Arc::new(loaded.mesh),
        world_from_object: Mat4::IDENTITY,
        layer: None,
    };
    Ok(Scene {
        name,
        source: path.to_owned(),
        files: files.used().to_vec(),
        hash: files.hash(),
        background: [1.0; 3],
        transparency_scale: 1.0,
        views,
        lights,
        objects: vec![object],
        held_out: false,
        warnings,
        timeline: Vec::new(),
        time: 0.0,
    })
}

/// A sphere around all of a file.
#[derive(Clone, Copy)]
struct Bounds {
    middle: Vec3,
    radius: f32,
}

/// A camera of the file; `None` where its numbers make no sense.
fn camera(c: &GltfCamera, bounds: Bounds) -> Option<Camera> {
    let position = c.file_from_camera.transform_point3(Vec3::ZERO);
    let direction = |v: Vec3| c.file_from_camera.transform_vector3(v).try_normalize();
    let distance = (position - bounds.middle).length();
    let far = c.far.unwrap_or(distance + 4.0 * bounds.radius);
    let camera = Camera {
        position,
        target: position + direction(Vec3::NEG_Z)?,
        up: direction(Vec3::Y)?,
        fov_y_degrees: c.fov_y.to_degrees(),
        near: c.near,
        far,
    };
    let is_sound = c.near > 0.0
        && c.near < far
        && far.is_finite()
        && (0.01..179.0).contains(&camera.fov_y_degrees);
    (is_sound && camera.view_from_world().is_finite()).then_some(camera)
}

/// A camera that sees all of a file.
fn fitting_camera(bounds: Bounds) -> Camera {
    let towards = Vec3::new(0.5, 0.35, 1.0).normalize();
    Camera {
        position: bounds.middle + towards * bounds.radius * 2.8,
        target: bounds.middle,
        up: Vec3::Y,
        fov_y_degrees: 45.0,
        near: bounds.radius * 0.5,
        far: bounds.radius * 8.0,
    }
}

/// Lights so bright that a white surface facing them is nearly white.
fn default_lights(bounds: Bounds) -> [Light; 2] {
    [([0.6, 0.9, 1.0], 0.8), ([-1.0, 0.1, 0.7], 0.4)].map(|(towards, share)| {
        let distance = 4.0 * bounds.radius;
        Light {
            source: Source::Point(bounds.middle + Vec3::from(towards).normalize() * distance),
            color: [1.0; 3],
            intensity: share * std::f32::consts::PI * distance * distance,
        }
    })
}
