//! Nodes, lights and cameras.

use crate::import::{FileCamera, Imported};
use crate::{
    budget::check_parts,
    error::SceneError,
    files::Files,
    mesh::Mesh,
    scene::{Light, Source},
    texture::{Made, Texture},
    warnings::Warnings,
};
use glam::{Mat4, Vec3};
use gltf::{Semantic, camera::Projection, khr_lights_punctual::Kind, mesh::Mode};
use std::{collections::HashMap, path::Path, sync::Arc};

/// Reads the nodes of a file: meshes, lights and cameras.
pub(super) struct Reader<'a, 'f> {
    pub path: &'a Path,
    pub files: &'a mut Files<'f>,
    pub buffers: Vec<Vec<u8>>,
    /// Of materials of the specular–glossiness workflow.
    pub made: Made,
    /// By number, and whether their opacity is dropped; `None` for those that cannot be drawn.
    pub images: HashMap<(usize, bool), Option<Arc<Texture>>>,
    /// What the file uses and is not drawn.
    pub missing: Warnings,
    pub loaded: Imported,
}

/// A value within its bounds; the lower one instead of a value that is not finite.
pub(super) fn finite(x: f32, low: f32, high: f32) -> f32 {
    if x.is_finite() {
        x.clamp(low, high)
    } else {
        low
    }
}

/// Counts of a file may be anything.
fn sum(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    [0, 1, 2].map(|k| a[k].saturating_add(b[k]))
}

/// How many primitives, triangles and vertices a mesh has.
fn size(mesh: &gltf::Mesh<'_>) -> [u64; 3] {
    mesh.primitives().fold([0; 3], |all, primitive| {
        let vertices = primitive.get(&Semantic::Positions);
        let vertices = vertices.map_or(0, |a| a.count() as u64);
        let indices = primitive.indices().map_or(vertices, |a| a.count() as u64);
        let triangles = match primitive.mode() {
            Mode::Triangles => indices / 3,
            Mode::TriangleStrip | Mode::TriangleFan => indices.saturating_sub(2),
            _ => return all,
        };
        let own = [1, triangles, vertices];
        sum(all, own)
    })
}

impl<'a, 'f> Reader<'a, 'f> {
    pub fn new(path: &'a Path, files: &'a mut Files<'f>, buffers: Vec<Vec<u8>>) -> Self {
        Self {
            path,
            files,
            buffers,
            made: Made::default(),
            images: HashMap::new(),
            missing: Warnings::default(),
            loaded: Imported::mesh(Mesh::empty(), Vec::new()),
        }
    }

    pub fn fail(&self, message: String) -> SceneError {
        SceneError::file(self.path, None, message)
    }

    /// Adds a scene's nodes.
    pub fn scene(&mut self, scene: &gltf::Scene<'_>) -> Result<(), SceneError> {
        self.count(scene)?;
        // Children come before siblings, in the file's order. Not by recursion: trees may be deep.
        let mut open: Vec<(gltf::Node<'_>, Mat4)> = Vec::new();
        open.extend(scene.nodes().map(|node| (node, Mat4::IDENTITY)));
        open.reverse();
        while let Some((node, parent)) = open.pop() {
            let world = self.node(&node, parent)?;
            let before = open.len();
            open.extend(node.children().map(|child| (child, world)));
            open[before..].reverse();
        }
        Ok(())
    }

    /// Counts what a scene's nodes instance, before any of it is made.
    fn count(&mut self, scene: &gltf::Scene<'_>) -> Result<(), SceneError> {
        let mut meshes: HashMap<usize, [u64; 3]> = HashMap::new();
        let mut all = [0; 3];
        let mut open: Vec<gltf::Node<'_>> = scene.nodes().collect();
        while let Some(node) = open.pop() {
            if let Some(mesh) = node.mesh() {
                let of = meshes.entry(mesh.index()).or_insert_with(|| size(&mesh));
                all = sum(all, *of);
            }
            open.extend(node.children());
        }
        let [primitives, triangles, vertices] = all;
        let budget = &mut self.files.budget;
        check_parts(primitives)
            .and_then(|()| budget.take_mesh(triangles, vertices))
            .map_err(|e| self.fail(format!("its nodes show {primitives} primitives with {e}")))
    }

    /// Adds a node without its children; returns its place in the world.
    fn node(&mut self, node: &gltf::Node<'_>, parent: Mat4) -> Result<Mat4, SceneError> {
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
                Projection::Perspective(p) => self.loaded.cameras.push(FileCamera {
                    file_from_camera: world,
                    fov_y: p.yfov(),
                    near: p.znear(),
                    far: p.zfar(),
                }),
                Projection::Orthographic(_) => {
                    self.missing.add("orthographic cameras");
                }
            }
        }
        Ok(world)
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
            Kind::Spot { .. } => self.missing.add("spot lights"),
        }
    }
}
