use crate::{
    camera::Camera,
    error::SceneError,
    material::{Lighting, Material},
    mesh::Mesh,
};
use glam::{Mat4, Vec3};
use peelnet_core::files::printable;
use serde::Deserialize;
use std::{path::PathBuf, sync::Arc};

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A point, scene units. Physically based surfaces see it fall off with the square of the distance, others do not.
    Point(Vec3),
    /// Far away in this direction, a unit vector: the sun.
    Toward(Vec3),
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it comes from.
    pub source: Source,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Multiplies the colour.
    pub intensity: f32,
}

/// The space in which colours of fragments are mixed. Images are linear light in either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Blending {
    /// Linear light, as glTF and engines blend: colours of splats are decoded, each, from what a display shows.
    #[default]
    Linear,
    /// What a display shows (sRGB), as the networks blended that made splats: what surfaces reflect is encoded, each fragment of it.
    Display,
}

/// A mesh in its place. Change `world_from_object` to move it, and `materials` to change its appearance; the mesh may be shared.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name, for messages.
    pub name: String,
    /// Its triangles, shared between objects that are alike.
    pub mesh: Arc<Mesh>,
    /// Object to world space.
    pub world_from_object: Mat4,
    /// Layer number of a nested object, 0 outermost.
    pub layer: Option<u32>,
    /// One for each part of the mesh.
    pub materials: Vec<Material>,
}

impl Blending {
    /// That of a scene that does not say: display space where there are splats, which look as they were made in that alone.
    pub fn of(objects: &[Object]) -> Self {
        match objects.iter().any(|o| o.mesh.splats.is_some()) {
            true => Self::Display,
            false => Self::Linear,
        }
    }
}

impl Object {
    /// An object of triangles in world space, each with its own vertices and normal.
    pub fn of_triangles(name: &str, triangles: &[[Vec3; 3]], material: Material) -> Self {
        let normal = |[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).normalize_or(Vec3::Z);
        let numbers = 0..triangles.len() as u32;
        let mesh = Mesh {
            positions: triangles.iter().flatten().copied().collect(),
            normals: triangles.iter().flat_map(|t| [normal(t); 3]).collect(),
            triangles: numbers.map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect(),
            ..Mesh::default()
        };
        Self {
            name: name.to_owned(),
            mesh: Arc::new(mesh.into_part(name, material.clone())),
            world_from_object: Mat4::IDENTITY,
            layer: None,
            materials: vec![material],
        }
    }
}

/// Everything that is drawn: objects, lights, views and the background. All fields may be changed between frames.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name; rows and reports are identified by it.
    pub name: String,
    /// The scene file.
    pub source: PathBuf,
    /// SHA-256 over the scene file and every file it reads, in order.
    pub hash: String,
    /// SHA-256 over the same files without the scene's name and whether it is held out: equal for scenes that show the same. Empty for a scene
    /// built in code.
    pub content: String,
    /// The scene file and every file it reads, in order, then those that objects name in any state of the timeline; empty for a scene built in code.
    pub files: Vec<PathBuf>,
    /// Background radiance, linear RGB.
    pub background: [f32; 3],
    /// The space that colours are mixed in.
    pub blending: Blending,
    /// Resolution of transparency as a share of the image's, above 0 and at most 1; exact methods keep the full one.
    pub transparency_scale: f32,
    /// Views, at least one.
    pub views: Vec<Camera>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Objects, in the order that decides ties of depth.
    pub objects: Vec<Object>,
    /// Whether it is kept out of all training.
    pub held_out: bool,
    /// What was repaired or left out while loading.
    pub warnings: Vec<String>,
    /// States of the timeline in order of time; empty where there is none.
    pub timeline: Vec<State>,
    /// The time of the timeline that is shown.
    pub time: f32,
}

/// A state of a timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// When, in whatever unit the scene counts.
    pub time: f32,
    /// Its name.
    pub label: String,
}

impl Scene {
    /// A scene built in code, without lights. Messages name `maker` instead of a file.
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
            content: String::new(),
            files: Vec::new(),
            background,
            blending: Blending::of(&objects),
            transparency_scale: 1.0,
            views: vec![camera],
            lights: Vec::new(),
            objects,
            held_out: false,
            warnings: Vec::new(),
            timeline: Vec::new(),
            time: 0.0,
        }
    }

    /// So many of its views, from the first; all where no number is asked for.
    ///
    /// # Errors
    /// Fewer views than that, in words.
    pub fn first_views(&self, asked: Option<usize>) -> Result<&[Camera], String> {
        let asked = asked.unwrap_or(self.views.len());
        self.views.get(..asked).ok_or_else(|| {
            format!(
                "scene {} has {} of the {asked} views that were asked for: ask for fewer, or add [orbit] or [[view]]",
                self.source.display(),
                self.views.len()
            )
        })
    }

    /// Whether some surface is lit in this way.
    pub(crate) fn has_lighting(&self, lighting: Lighting) -> bool {
        let mut materials = self.objects.iter().flat_map(|o| &o.materials);
        materials.any(|m| m.lighting == lighting)
    }

    /// The same scene with all of its lengths multiplied, the planes of its cameras too. Where surfaces are physically based, points of
    /// light are so much brighter that as much arrives; where others are Phong, these are too bright then.
    pub fn scaled(&self, factor: f32) -> Self {
        let mut scene = self.clone();
        let scaling = Mat4::from_scale(Vec3::splat(factor));
        let falls_off = self.has_lighting(Lighting::Pbr);
        for object in &mut scene.objects {
            object.world_from_object = scaling * object.world_from_object;
        }
        for light in &mut scene.lights {
            if let Source::Point(position) = &mut light.source {
                *position *= factor;
                if falls_off {
                    light.intensity = (light.intensity * factor * factor).min(f32::MAX);
                }
            }
        }
        for view in &mut scene.views {
            view.position *= factor;
            view.target *= factor;
            view.near *= factor;
            view.far *= factor;
        }
        scene
    }

    /// Numbers of its layers, outermost first, each once.
    pub fn layers(&self) -> Vec<u32> {
        let all = self.objects.iter().filter_map(|o| o.layer);
        let all: std::collections::BTreeSet<u32> = all.collect();
        all.into_iter().collect()
    }

    /// The scene as the view of layers draws it: every surface of a layer is a fragment. The highlighted layer is shaded by its material; the
    /// others show their base colour alone or, with `shade_all` (to measure what that costs), are shaded too.
    ///
    /// # Errors
    /// A layer that no object has, or a transparent object without a layer.
    pub fn layer_view(&self, highlight: u32, shade_all: bool) -> Result<Self, SceneError> {
        let fail = |message| SceneError::value(&self.source, "layer", message);
        let layers = self.layers();
        if !layers.contains(&highlight) {
            let message = match layers.as_slice() {
                [] => "no object has one: add layer = N to objects, 0 outermost".to_owned(),
                all => format!("{highlight} is none of the layers {all:?}"),
            };
            return Err(fail(message));
        }
        let mut scene = self.clone();
        scene.transparency_scale = 1.0;
        for object in &mut scene.objects {
            let Some(layer) = object.layer else {
                if object.materials.iter().all(Material::is_opaque) {
                    continue;
                }
                let name = printable(&object.name);
                return Err(fail(format!("of '{name}' is missing: it is transparent")));
            };
            for material in &mut object.materials {
                material.blend = true;
                if layer != highlight && !shade_all {
                    material.lighting = Lighting::Unlit;
                    material.emission = [0.0; 3];
                }
            }
        }
        Ok(scene)
    }

    /// The scene with every surface opaque, shaded as before: what shading takes without transparency. Holes of cut-outs stay.
    pub fn opaque(&self) -> Self {
        self.with_materials(|material| {
            (material.alpha, material.blend) = (1.0, false);
            material.transmission = [0.0; 3];
        })
    }

    pub(crate) fn with_materials(&self, change: impl FnMut(&mut Material)) -> Self {
        let mut scene = self.clone();
        let materials = scene.objects.iter_mut().flat_map(|o| &mut o.materials);
        materials.for_each(change);
        scene
    }

    /// The scene with every surface as opaque as before, and unlit: what transparency takes without shading. Colour maps stay, because
    /// they hold opacity.
    pub fn unlit(&self) -> Self {
        self.with_materials(|material| {
            material.lighting = Lighting::Unlit;
            material.emission = [0.0; 3];
        })
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|o| o.mesh.triangles.len()).sum()
    }

    /// The world-space box around all transparent parts; `None` where nothing is transparent.
    pub fn transparent_bounds(&self) -> Option<(Vec3, Vec3)> {
        let points = self.objects.iter().flat_map(|object| {
            let Object { mesh, .. } = object;
            let parts = mesh.parts.iter().zip(&object.materials);
            let parts = parts.filter(|(_, material)| !material.is_opaque());
            let triangles = parts.flat_map(|(part, _)| &mesh.triangles[part.triangles.clone()]);
            let vertices = triangles.flatten().map(|&i| mesh.positions[i as usize]);
            vertices.map(|p| object.world_from_object.transform_point3(p))
        });
        let boxes = points.map(|p| (p, p));
        boxes.reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p)))
    }
}
