//! Nodes, lights and cameras.

use super::{GltfCamera, LoadedGltf};
use crate::{
    error::SceneError,
    files::Files,
    mesh::Mesh,
    scene::{Light, Source},
    texture::Texture,
};
use glam::{Mat4, Vec3};
use gltf::{camera::Projection, khr_lights_punctual::Kind};
use std::{
    collections::{BTreeSet, HashMap},
    path::Path,
    sync::Arc,
};

/// Reads the nodes of a file: meshes, lights and cameras.
pub(super) struct Reader<'a, 'f> {
    pub path: &'a Path,
    pub files: &'a mut Files<'f>,
    pub buffers: Vec<Vec<u8>>,
    /// By number, and whether their opacity is dropped; `None` for those that cannot be drawn.
    pub images: HashMap<(usize, bool), Option<Arc<Texture>>>,
    /// What the file uses and is not drawn, each once.
    pub missing: BTreeSet<String>,
    pub loaded: LoadedGltf,
}

/// A value within its bounds; the lower one instead of a value that is not finite.
pub(super) fn finite(x: f32, low: f32, high: f32) -> f32 {
    if x.is_finite() {
        x.clamp(low, high)
    } else {
        low
    }
}

impl<'a, 'f> Reader<'a, 'f> {
    pub fn new(path: &'a Path, files: &'a mut Files<'f>, buffers: Vec<Vec<u8>>) -> Self {
        Self {
            path,
            files,
            buffers,
            images: HashMap::new(),
            missing: BTreeSet::new(),
            loaded: LoadedGltf {
                mesh: Mesh::empty(),
                lights: Vec::new(),
                cameras: Vec::new(),
                warnings: Vec::new(),
                files: Vec::new(),
            },
        }
    }

    pub fn fail(&self, message: String) -> SceneError {
        SceneError::Mesh {
            path: self.path.to_owned(),
            line: None,
            message,
        }
    }

    /// Adds a node and its children.
    pub fn node(
        &mut self,
        node: &gltf::Node<'_>,
        parent: Mat4,
        depth: usize,
    ) -> Result<(), SceneError> {
        // A node that is its own descendant would recurse forever.
        if depth > 256 {
            return Err(self.fail(format!(
                "node {} lies more than 256 levels deep; is it its own child?",
                node.index()
            )));
        }
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if !world.is_finite() {
            return Err(self.fail(format!(
                "node {}: its transform is not finite; repair it",
                node.index()
            )));
        }
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&mesh, &primitive, world)?;
            }
        }
        if let Some(light) = node.light() {
            self.light(&light, world);
        }
        if let Some(camera) = node.camera() {
            match camera.projection() {
                Projection::Perspective(p) => self.loaded.cameras.push(GltfCamera {
                    file_from_camera: world,
                    fov_y: p.yfov(),
                    near: p.znear(),
                    far: p.zfar(),
                }),
                Projection::Orthographic(_) => {
                    self.missing.insert("orthographic cameras".into());
                }
            }
        }
        for child in node.children() {
            self.node(&child, world, depth + 1)?;
        }
        Ok(())
    }

    fn light(&mut self, light: &gltf::khr_lights_punctual::Light<'_>, world: Mat4) {
        match light.kind() {
            Kind::Point => self.loaded.lights.push(Light {
                source: Source::Point(world.transform_point3(Vec3::ZERO)),
                color: light.color(),
                intensity: light.intensity(),
            }),
            // It shines along −z.
            Kind::Directional => self.loaded.lights.push(Light {
                source: Source::Toward(world.transform_vector3(Vec3::Z).normalize_or(Vec3::Y)),
                color: light.color(),
                intensity: light.intensity(),
            }),
            Kind::Spot { .. } => drop(self.missing.insert("spot lights".into())),
        }
    }
}
