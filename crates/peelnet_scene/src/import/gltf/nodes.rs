//! Nodes, lights and cameras.

use super::splats::{AllDeclared, count};
use crate::{
    budget::{self, MAX_PARTS},
    camera::Camera,
    error::{SceneError, shown},
    files::Files,
    import::Imported,
    scene::{Light, Source},
    texture::Texture,
};
use glam::{Mat4, Quat, Vec3};
use gltf::{Semantic, camera::Projection, khr_lights_punctual::Kind, mesh::Mode, scene::Transform};
use std::{collections::HashMap, path::Path, sync::Arc};

/// Reads the nodes of a file: meshes, lights and cameras.
pub(super) struct Reader<'a, 'f> {
    pub path: &'a Path,
    pub files: &'a mut Files<'f>,
    pub document: &'a gltf::Document,
    /// Primitives that are splats.
    pub declared: Arc<AllDeclared>,
    pub buffers: Vec<Arc<Vec<u8>>>,
    /// By source, and whether opacity is left out; `None` for those that cannot be drawn.
    pub images: HashMap<(String, bool), Option<Arc<Texture>>>,
    /// What stands before what the file uses and is not drawn.
    pub not_drawn: String,
    pub loaded: Imported,
}

/// A value within its bounds; the lower one instead of NaN.
pub(super) fn finite(x: f32, low: f32, high: f32) -> f32 {
    if x.is_nan() { low } else { x.clamp(low, high) }
}

/// The name of an element, or its kind and number.
pub(super) fn name_of(name: Option<&str>, kind: &str, number: usize) -> String {
    name.map_or_else(|| format!("{kind} {number}"), str::to_owned)
}

/// Counts of a file may be anything.
fn sum(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    [0, 1, 2].map(|k| a[k].saturating_add(b[k]))
}

/// How many primitives, triangles and vertices a mesh has.
fn size(mesh: &gltf::Mesh<'_>, declared: &AllDeclared) -> [u64; 3] {
    mesh.primitives().fold([0; 3], |all, primitive| {
        if let Some(declared) = declared.get(&(mesh.index(), primitive.index())) {
            let splats = count(&primitive, declared);
            return splats.map_or(all, |n| sum(all, [1, n, n]));
        }
        let vertices = primitive.get(&Semantic::Positions);
        let vertices = vertices.map_or(0, |a| a.count() as u64);
        let indices = primitive.indices().map_or(vertices, |a| a.count() as u64);
        let triangles = match primitive.mode() {
            Mode::Triangles => indices / 3,
            Mode::TriangleStrip | Mode::TriangleFan => indices.saturating_sub(2),
            _ => return all,
        };
        // Without normals, every triangle gets vertices of its own.
        let vertices = match primitive.get(&Semantic::Normals) {
            Some(normals) if normals.count() as u64 == vertices => vertices,
            _ => vertices.max(triangles.saturating_mul(3)),
        };
        let own = [1, triangles, vertices];
        sum(all, own)
    })
}

impl<'a, 'f> Reader<'a, 'f> {
    pub fn new(path: &'a Path, files: &'a mut Files<'f>, document: &'a gltf::Document) -> Self {
        Self {
            path,
            files,
            document,
            declared: Arc::default(),
            buffers: Vec::new(),
            images: HashMap::new(),
            not_drawn: format!("{}: not drawn: ", shown(path)),
            loaded: Imported {
                is_scene: true,
                ..Imported::default()
            },
        }
    }

    /// Warns of something that the file uses and is not drawn, which has a name between two texts.
    pub fn missing(&mut self, before: &str, name: &str, after: &str) {
        let before = format!("{}{before}", self.not_drawn);
        self.files.warnings.about(before, name, after);
    }

    pub fn fail(&self, message: String) -> SceneError {
        SceneError::file(self.path, None, message)
    }

    pub fn scene(&mut self, scene: &gltf::Scene<'_>) -> Result<(), SceneError> {
        let nodes = self.nodes(scene)?;
        // What they instance is counted before any of it is made.
        let mut meshes: HashMap<usize, [u64; 3]> = HashMap::new();
        let shown = nodes.iter().filter_map(|(node, _)| node.mesh());
        let all = shown.fold([0; 3], |all, mesh| {
            let own = meshes.entry(mesh.index());
            let own = own.or_insert_with(|| size(&mesh, &self.declared));
            sum(all, *own)
        });
        let [primitives, triangles, vertices] = all;
        let budget = &mut self.files.budget;
        budget::check(primitives, MAX_PARTS, "parts")
            .and_then(|()| budget.take_mesh(triangles, vertices))
            .map_err(|e| self.fail(format!("its nodes show {primitives} primitives with {e}")))?;
        nodes
            .into_iter()
            .try_for_each(|(node, world)| self.node(&node, world))
    }

    /// The nodes of a scene, and their places in the world: children before siblings, in the file's order. Not by recursion: trees may be deep. A
    /// node with two parents is an error: it would be drawn twice, and so on at every level below it, or without end in a circle.
    fn nodes<'d>(
        &self,
        scene: &gltf::Scene<'d>,
    ) -> Result<Vec<(gltf::Node<'d>, Mat4)>, SceneError> {
        let mut nodes = Vec::new();
        let mut parents: HashMap<usize, Option<usize>> = HashMap::new();
        let mut open: Vec<(gltf::Node<'d>, Option<usize>, Mat4)> = Vec::new();
        open.extend(scene.nodes().map(|node| (node, None, Mat4::IDENTITY)));
        open.reverse();
        while let Some((node, parent, place)) = open.pop() {
            let number = node.index();
            if let Some(other) = parents.insert(number, parent) {
                let root = || format!("scene {}", scene.index());
                let name = |p: Option<usize>| p.map_or_else(root, |p| format!("node {p}"));
                return Err(self.fail(format!(
                    "node {number} is a child of {} and of {}: a node has one parent; give each place a node of its own, which may name the same mesh",
                    name(other),
                    name(parent)
                )));
            }
            let mut transform = node.transform();
            if let Transform::Decomposed { rotation, .. } = &mut transform {
                // Of another length it would skew and scale.
                let turn = Quat::from_array(*rotation);
                if !turn.is_normalized() {
                    *rotation = turn.normalize().to_array();
                }
            }
            let world = place * Mat4::from_cols_array_2d(&transform.matrix());
            if !world.is_finite() {
                let message = "its transform is not finite; repair it";
                return Err(self.fail(format!("node {number}: {message}")));
            }
            let before = open.len();
            open.extend(node.children().map(|child| (child, Some(number), world)));
            open[before..].reverse();
            nodes.push((node, world));
        }
        Ok(nodes)
    }

    fn node(&mut self, node: &gltf::Node<'_>, world: Mat4) -> Result<(), SceneError> {
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&mesh, &primitive, world)?;
            }
        }
        if let Some(light) = node.light() {
            let (source, kind) = match light.kind() {
                Kind::Point => {
                    let place = world.transform_point3(Vec3::ZERO);
                    (Some(Source::Point(place)), "")
                }
                // It shines along −z.
                Kind::Directional => {
                    let toward = world.transform_vector3(Vec3::Z).try_normalize();
                    (toward.map(Source::Toward), "lights without a direction")
                }
                Kind::Spot { .. } => (None, "spot lights"),
            };
            if light.range().is_some() && matches!(source, Some(Source::Point(_))) {
                self.missing("ranges of lights", "", "");
            }
            let color = light.color().map(|c| finite(c, 0.0, 1.0));
            let intensity = finite(light.intensity(), 0.0, f32::MAX);
            if (color, intensity) != (light.color(), light.intensity()) {
                let name = name_of(light.name(), "light", light.index());
                self.files.warnings.clamped(self.path, &name);
            }
            match source {
                None => self.missing(kind, "", ""),
                Some(source) => self.loaded.lights.push(Light {
                    source,
                    color,
                    intensity,
                }),
            }
        }
        if let Some(camera) = node.camera() {
            match camera.projection() {
                Projection::Perspective(p) => {
                    let name = name_of(camera.name(), "camera", camera.index());
                    self.loaded.cameras.push((name, view(&p, world)));
                }
                Projection::Orthographic(_) => self.missing("orthographic cameras", "", ""),
            }
        }
        Ok(())
    }
}

/// A camera that looks along −z.
fn view(p: &gltf::camera::Perspective<'_>, world: Mat4) -> Camera {
    let direction = |v: Vec3| world.transform_vector3(v).normalize_or_zero();
    let position = world.transform_point3(Vec3::ZERO);
    Camera {
        position,
        target: position + direction(Vec3::NEG_Z),
        up: direction(Vec3::Y),
        fov_y_degrees: p.yfov().to_degrees(),
        near: p.znear(),
        far: p.zfar().unwrap_or(f32::INFINITY),
    }
}
