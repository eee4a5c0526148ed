use crate::{Camera, Material, Mesh, Part};
use glam::{Mat4, Vec3};
use std::{path::PathBuf, sync::Arc};

/// A point light without falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Position, scene units.
    pub position: Vec3,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Multiplies the colour.
    pub intensity: f32,
}

/// A mesh in its place.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name, for messages.
    pub name: String,
    /// Its triangles, shared between objects that are alike.
    pub mesh: Arc<Mesh>,
    /// Object to world space.
    pub world_from_object: Mat4,
    /// Layer number; 0 where the file gives none.
    pub layer: u32,
    /// One for each part of the mesh.
    pub materials: Vec<Material>,
}

impl Object {
    /// Triangles in world space, each with its own corners and normal.
    pub fn of_triangles(name: &str, corners: &[[Vec3; 3]], material: Material) -> Self {
        let normal = |[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).normalize_or(Vec3::Z);
        let mesh = Mesh {
            positions: corners.iter().flatten().copied().collect(),
            normals: corners.iter().flat_map(|t| [normal(t); 3]).collect(),
            triangles: (0..corners.len() as u32)
                .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                .collect(),
            parts: vec![Part {
                name: name.to_owned(),
                triangles: 0..corners.len(),
                material: material.clone(),
            }],
        };
        Self {
            name: name.to_owned(),
            mesh: Arc::new(mesh),
            world_from_object: Mat4::IDENTITY,
            layer: 0,
            materials: vec![material],
        }
    }
}

/// Everything that is drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name; rows and reports are told apart by it.
    pub name: String,
    /// The scene file.
    pub source: PathBuf,
    /// SHA-256 over the scene file and every file it reads, in order.
    pub hash: String,
    /// Background radiance, linear RGB.
    pub background: [f32; 3],
    /// Of the resolution that transparency is drawn at, above 0 and at most 1; exact methods keep the full one.
    pub transparency_scale: f32,
    /// Views, at least one.
    pub views: Vec<Camera>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Objects, in the order that decides ties of depth.
    pub objects: Vec<Object>,
    /// Whether it must never be trained on.
    pub held_out: bool,
    /// What was noticed and mended while loading.
    pub warnings: Vec<String>,
}

impl Scene {
    /// A scene that code makes, without lights; `maker` stands in messages where a file's name would.
    pub fn generated(
        name: &str,
        maker: &str,
        background: [f32; 3],
        camera: Camera,
        objects: Vec<Object>,
    ) -> Self {
        Self {
            name: name.to_owned(),
            source: PathBuf::from(format!("{name} (made by {maker})")),
            hash: String::new(),
            background,
            transparency_scale: 1.0,
            views: vec![camera],
            lights: Vec::new(),
            objects,
            held_out: false,
            warnings: Vec::new(),
        }
    }

    /// The same scene with all of its lengths multiplied, the planes of its cameras too.
    pub fn scaled(&self, factor: f32) -> Self {
        let mut scene = self.clone();
        let scaling = Mat4::from_scale(Vec3::splat(factor));
        for object in &mut scene.objects {
            object.world_from_object = scaling * object.world_from_object;
        }
        for light in &mut scene.lights {
            light.position *= factor;
        }
        for view in &mut scene.views {
            view.position *= factor;
            view.target *= factor;
            view.near *= factor;
            view.far *= factor;
        }
        scene
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|o| o.mesh.triangles.len()).sum()
    }

    /// The world-space box around all transparent parts; `None` where nothing is transparent.
    pub fn transparent_bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        for object in &self.objects {
            for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
                if material.is_opaque() {
                    continue;
                }
                for &i in object.mesh.triangles[part.triangles.clone()]
                    .iter()
                    .flatten()
                {
                    let p = object
                        .world_from_object
                        .transform_point3(object.mesh.positions[i as usize]);
                    bounds = Some(bounds.map_or((p, p), |(lo, hi)| (lo.min(p), hi.max(p))));
                }
            }
        }
        bounds
    }
}
