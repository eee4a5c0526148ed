//! The scene file: TOML, strict. An unknown key is an error, because a misspelt one would otherwise be silently ignored.
//! A glTF or GLB file is a scene by itself, see [`Scene::load`].

mod looks;
mod timeline;

pub use looks::MapRef;

use crate::{
    Camera, Light, Lighting, Material, Mesh, Object, Scene, SceneError, Source, State, Texture,
    files::{FileKind, Files, read_file},
    gltf, obj,
    scatter::{Scatter, fixed_axes},
    shapes::Shape,
};
use glam::{Mat4, Vec3};
use looks::RawMaterial;
use serde::{Deserialize, Deserializer, de::Error as _};
use std::{
    collections::HashMap,
    io,
    path::{Path, PathBuf},
    sync::Arc,
};
use timeline::{Age, NO_TIMELINE, RawState};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScene {
    name: Option<String>,
    #[serde(default)]
    background: [f32; 3],
    #[serde(default = "one")]
    transparency_scale: f32,
    #[serde(default)]
    held_out: bool,
    camera: Option<RawCamera>,
    #[serde(default)]
    view: Vec<RawCamera>,
    orbit: Option<RawOrbit>,
    #[serde(default)]
    light: Vec<RawLight>,
    #[serde(default)]
    object: Vec<RawObject>,
    #[serde(default)]
    scatter: OneOrMany<Scatter>,
    #[serde(default)]
    timeline: Vec<RawState>,
}

/// `[scatter]` or `[[scatter]]`.
#[derive(Debug)]
struct OneOrMany<T>(Vec<T>);

impl<T> Default for OneOrMany<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Through a value, so that the inner error and not "no variant matched" is told.
        match toml::Value::deserialize(deserializer)? {
            toml::Value::Array(list) => list
                .into_iter()
                .map(|v| T::deserialize(v).map_err(D::Error::custom))
                .collect::<Result<_, _>>()
                .map(Self),
            one => T::deserialize(one)
                .map_err(D::Error::custom)
                .map(|one| Self(vec![one])),
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCamera {
    position: [f32; 3],
    target: [f32; 3],
    #[serde(default = "up")]
    up: [f32; 3],
    #[serde(default = "fov")]
    fov_y: f32,
    near: f32,
    far: f32,
}

const fn up() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

const fn fov() -> f32 {
    45.0
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawOrbit {
    views: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLight {
    position: Option<[f32; 3]>,
    direction: Option<[f32; 3]>,
    #[serde(default = "white")]
    color: [f32; 3],
    #[serde(default = "one")]
    intensity: f32,
}

const fn white() -> [f32; 3] {
    [1.0; 3]
}

const fn one() -> f32 {
    1.0
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawObject {
    name: Option<String>,
    mesh: MeshRef,
    fit: Option<f32>,
    #[serde(default = "one")]
    scale: f32,
    #[serde(default)]
    rotate: [f32; 3],
    #[serde(default)]
    translate: [f32; 3],
    layer: Option<u32>,
    /// Linear RGB and alpha of its lowest and of its highest corner, mixed by height between them.
    vertex_colors: Option<[[f32; 4]; 2]>,
    #[serde(default)]
    material: RawMaterial,
}

/// A mesh in a scene file: a path, or a table with `shape = …`.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshRef {
    /// A file, relative to the scene file.
    File(PathBuf),
    /// A generated shape.
    Shape(Shape),
}

impl<'de> Deserialize<'de> for MeshRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(path) => Ok(Self::File(path.into())),
            table @ toml::Value::Table(_) => Shape::deserialize(table)
                .map(Self::Shape)
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a mesh is a path or a table with shape = …, not {}",
                other.type_str()
            ))),
        }
    }
}

/// Loads meshes once each and keeps what was read for the hash.
struct Loader<'a> {
    path: &'a Path,
    lighting: Lighting,
    files: Files<'a>,
    warnings: Vec<String>,
    meshes: HashMap<PathBuf, Arc<Mesh>>,
    shapes: Vec<(Shape, bool, Arc<Mesh>)>,
    images: HashMap<PathBuf, Arc<Texture>>,
}

impl Loader<'_> {
    fn value(&self, field: &str, message: impl Into<String>) -> SceneError {
        SceneError::Value {
            path: self.path.to_owned(),
            field: field.to_owned(),
            message: message.into(),
        }
    }

    /// A mesh, read or made once; a generated one has places on images only where it is `mapped`.
    fn mesh(&mut self, mesh: &MeshRef, mapped: bool, field: &str) -> Result<Arc<Mesh>, SceneError> {
        match mesh {
            MeshRef::Shape(shape) => {
                let mut known = self.shapes.iter();
                if let Some((_, _, mesh)) = known.find(|(s, m, _)| s == shape && *m == mapped) {
                    return Ok(Arc::clone(mesh));
                }
                let built = shape
                    .build(&Material::default_with(self.lighting), mapped)
                    .map_err(|e| self.value(field, e))?;
                let built = Arc::new(built);
                self.shapes
                    .push((shape.clone(), mapped, Arc::clone(&built)));
                Ok(built)
            }
            MeshRef::File(name) => {
                let file = self.path.parent().unwrap_or(Path::new(".")).join(name);
                if let Some(mesh) = self.meshes.get(&file) {
                    return Ok(Arc::clone(mesh));
                }
                let ending = file
                    .extension()
                    .and_then(|e| e.to_str())
                    .unwrap_or_default()
                    .to_lowercase();
                let (mesh, warnings) = match ending.as_str() {
                    "obj" => {
                        let loaded = obj::load(&file, self.lighting, &mut self.files)?;
                        (loaded.mesh, loaded.warnings)
                    }
                    "gltf" | "glb" => {
                        let loaded = gltf::load(&file, &mut self.files)?;
                        // A scene file has lights and cameras of its own.
                        (loaded.mesh, loaded.warnings)
                    }
                    _ => {
                        return Err(self.value(
                            field,
                            format!(
                                "{} is neither .obj, .gltf nor .glb; export the mesh as one of them",
                                file.display()
                            ),
                        ));
                    }
                };
                self.warnings.extend(warnings);
                let mesh = Arc::new(mesh);
                self.meshes.insert(file, Arc::clone(&mesh));
                Ok(mesh)
            }
        }
    }

    fn camera(&self, raw: &RawCamera, field: &str) -> Result<Camera, SceneError> {
        let at = |key: &str| format!("{field}.{key}");
        for (key, v) in [
            ("position", raw.position),
            ("target", raw.target),
            ("up", raw.up),
        ] {
            if v.iter().any(|x| !x.is_finite()) {
                return Err(self.value(&at(key), "must be finite"));
            }
        }
        let (near, far) = (raw.near, raw.far);
        if !(near > 0.0 && near < far && far.is_finite()) {
            return Err(self.value(
                &at("near"),
                format!("near {near} must be positive and below far {far}"),
            ));
        }
        if !(raw.fov_y > 0.0 && raw.fov_y < 180.0) {
            return Err(self.value(
                &at("fov_y"),
                format!("{} must lie between 0 and 180 degrees", raw.fov_y),
            ));
        }
        let camera = Camera {
            position: raw.position.into(),
            target: raw.target.into(),
            up: raw.up.into(),
            fov_y_degrees: raw.fov_y,
            near,
            far,
        };
        let forward = camera.target - camera.position;
        if forward.length() == 0.0 {
            return Err(self.value(&at("target"), "must differ from position"));
        }
        if forward
            .normalize()
            .cross(camera.up.normalize_or_zero())
            .length()
            < 1e-4
        {
            return Err(self.value(&at("up"), "must not be zero or along the line of sight"));
        }
        Ok(camera)
    }
}

impl Scene {
    /// Reads a scene file and everything it names from the file system, a scene with a timeline in its first state. A glTF or GLB file is a
    /// scene too: with its own lights and cameras; where it has none, with two lights, and a camera that sees all of it.
    ///
    /// # Errors
    /// The first thing that is wrong, with file, line or key, and a hint.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_at(path, None)
    }

    /// The same at a time of the scene's timeline: only the state shown is loaded; numbers of materials lie between its and the next one's.
    ///
    /// # Errors
    /// See [`Scene::load`]; a time outside of the timeline, or of a scene without one.
    pub fn load_at(path: impl AsRef<Path>, time: Option<f32>) -> Result<Self, SceneError> {
        Self::from_bytes_at(path, time, read_file)
    }

    /// Reads the scene file `name` and everything it names through a function that returns a file's bytes, so that an archive, a web page
    /// or a test can be the file system. Names that a file contains are joined to its folder.
    ///
    /// ```
    /// # fn main() -> Result<(), peelnet_scene::SceneError> {
    /// let files = |path: &std::path::Path| match path.to_str() {
    ///     Some("room/scene.toml") => Ok(b"
    ///         [camera]
    ///         position = [0, 0, 6]
    ///         target = [0, 0, 0]
    ///         near = 0.1
    ///         far = 100
    ///         [[object]]
    ///         mesh = 'pane.obj'"
    ///         .to_vec()),
    ///     Some("room/pane.obj") => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".to_vec()),
    ///     _ => Err(std::io::ErrorKind::NotFound.into()),
    /// };
    /// let scene = peelnet_scene::Scene::from_bytes("room/scene.toml", files)?;
    /// assert_eq!(scene.triangles(), 1);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// See [`Scene::load`].
    pub fn from_bytes(
        name: impl AsRef<Path>,
        read: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        Self::from_bytes_at(name, None, read)
    }

    /// The same at a time of the scene's timeline, see [`Scene::load_at`].
    ///
    /// # Errors
    /// See [`Scene::load_at`].
    pub fn from_bytes_at(
        name: impl AsRef<Path>,
        time: Option<f32>,
        read: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        let path = name.as_ref();
        let mut files = Files::new(&read);
        let ending = path.extension().and_then(|e| e.to_str());
        if matches!(
            ending.map(str::to_lowercase).as_deref(),
            Some("gltf" | "glb")
        ) {
            return match time {
                None => of_gltf(path, files),
                Some(_) => Err(SceneError::Value {
                    path: path.to_owned(),
                    field: "timeline".into(),
                    message: NO_TIMELINE.into(),
                }),
            };
        }
        let bytes = files.read(path, FileKind::Scene)?;
        files.record(path, &bytes);
        let text = String::from_utf8(bytes).map_err(|e| SceneError::Read {
            path: path.to_owned(),
            source: io::Error::new(io::ErrorKind::InvalidData, e.utf8_error()),
        })?;
        let raw: RawScene = toml::from_str(&text).map_err(|e| {
            let line = e.span().map_or(1, |s| {
                1 + text[..s.start.min(text.len())].matches('\n').count()
            });
            SceneError::Syntax {
                path: path.to_owned(),
                line,
                message: e.message().trim().replace('\n', "; "),
            }
        })?;
        let lighting = if raw.light.is_empty() {
            Lighting::Unlit
        } else {
            Lighting::Phong
        };
        let mut loader = Loader {
            path,
            lighting,
            files,
            warnings: Vec::new(),
            meshes: HashMap::new(),
            shapes: Vec::new(),
            images: HashMap::new(),
        };
        let age = Age::of(&mut loader, &raw, time)?;
        let views = views(&loader, &raw)?;
        let mut lights = Vec::new();
        for (i, light) in raw.light.iter().enumerate() {
            let source = match (light.position, light.direction) {
                (Some(position), None) => Source::Point(position.into()),
                // It comes from where it does not shine to.
                (None, Some(direction)) => {
                    let toward = (-Vec3::from(direction)).try_normalize();
                    Source::Toward(toward.unwrap_or(Vec3::NAN))
                }
                _ => {
                    return Err(loader.value(
                        &format!("light {}", i + 1),
                        "needs either a position or a direction",
                    ));
                }
            };
            let (Source::Point(place) | Source::Toward(place)) = source;
            let numbers = place
                .as_ref()
                .iter()
                .chain(&light.color)
                .chain([&light.intensity]);
            if numbers.into_iter().any(|x| !x.is_finite())
                || light.color.iter().any(|c| *c < 0.0)
                || light.intensity < 0.0
            {
                return Err(loader.value(
                    &format!("light {}", i + 1),
                    "must be finite, colour and intensity not negative, a direction not zero",
                ));
            }
            lights.push(Light {
                source,
                color: light.color,
                intensity: light.intensity,
            });
        }
        if !(raw.transparency_scale > 0.0 && raw.transparency_scale <= 1.0) {
            return Err(loader.value(
                "transparency_scale",
                format!("{} must be above 0 and at most 1", raw.transparency_scale),
            ));
        }
        if raw.background.iter().any(|c| !c.is_finite() || *c < 0.0) {
            return Err(loader.value("background", "must be finite and not negative"));
        }
        let mut objects = Vec::new();
        for (i, object) in raw.object.iter().enumerate() {
            objects.push(place_object(&mut loader, object, i, &age)?);
        }
        for (i, scatter) in raw.scatter.0.iter().enumerate() {
            scatter_objects(&mut loader, scatter, i, views[0].position, &mut objects)?;
        }
        let name = raw.name.unwrap_or_else(|| {
            path.file_stem()
                .map_or_else(|| "scene".into(), |s| s.to_string_lossy().into_owned())
        });
        if !raw.timeline.is_empty() {
            loader.files.hash_value(&age.time.to_le_bytes());
        }
        Ok(Self {
            name,
            source: path.to_owned(),
            hash: loader.files.hash(),
            background: raw.background,
            transparency_scale: raw.transparency_scale,
            views,
            lights,
            objects,
            held_out: raw.held_out,
            warnings: loader.warnings,
            time: age.time,
            timeline: raw
                .timeline
                .into_iter()
                .map(|s| State {
                    time: s.time,
                    label: s.label,
                })
                .collect(),
        })
    }
}

/// A glTF file as a whole scene: its own lights, its first camera, or one that sees all of it.
fn of_gltf(path: &Path, mut files: Files<'_>) -> Result<Scene, SceneError> {
    let loaded = gltf::load(path, &mut files)?;
    let (low, high) = loaded.mesh.bounds().unwrap_or_default();
    let (middle, radius) = ((low + high) / 2.0, ((high - low).length() / 2.0).max(1e-6));
    let fit = || {
        let towards = Vec3::new(0.5, 0.35, 1.0).normalize();
        Camera {
            position: middle + towards * radius * 2.8,
            target: middle,
            up: Vec3::Y,
            fov_y_degrees: 45.0,
            near: radius * 0.5,
            far: radius * 8.0,
        }
    };
    let views: Vec<Camera> = loaded
        .cameras
        .iter()
        .filter_map(|c| {
            let position = c.file_from_camera.transform_point3(Vec3::ZERO);
            let target = position
                + c.file_from_camera
                    .transform_vector3(Vec3::NEG_Z)
                    .try_normalize()?;
            let far = c.far.unwrap_or((position - middle).length() + 4.0 * radius);
            let camera = Camera {
                position,
                target,
                up: c
                    .file_from_camera
                    .transform_vector3(Vec3::Y)
                    .try_normalize()?,
                fov_y_degrees: c.fov_y.to_degrees(),
                near: c.near,
                far,
            };
            let sound = c.near > 0.0
                && c.near < far
                && far.is_finite()
                && (0.01..179.0).contains(&camera.fov_y_degrees);
            (sound && camera.view_from_world().is_finite()).then_some(camera)
        })
        .collect();
    let mut lights = loaded.lights;
    let mut warnings = loaded.warnings;
    let shaded = |p: &crate::Part| p.material.lighting == Lighting::Pbr;
    if lights.is_empty() && loaded.mesh.parts.iter().any(shaded) {
        warnings.push(format!(
            "{}: has no point light: two are added; put it into a scene file with lights of your own, or none",
            path.display()
        ));
        // Bright enough that a white surface facing them is nearly white.
        for (towards, share) in [([0.6, 0.9, 1.0], 0.8), ([-1.0, 0.1, 0.7], 0.4)] {
            let distance = 4.0 * radius;
            lights.push(Light {
                source: Source::Point(middle + Vec3::from(towards).normalize() * distance),
                color: [1.0; 3],
                intensity: share * std::f32::consts::PI * distance * distance,
            });
        }
    }
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let name = stem.unwrap_or_else(|| "scene".into());
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
        hash: files.hash(),
        background: [1.0; 3],
        transparency_scale: 1.0,
        views: if views.is_empty() { vec![fit()] } else { views },
        lights,
        objects: vec![object],
        held_out: false,
        warnings,
        timeline: Vec::new(),
        time: 0.0,
    })
}

fn views(loader: &Loader<'_>, raw: &RawScene) -> Result<Vec<Camera>, SceneError> {
    let mut views = Vec::new();
    match (&raw.camera, raw.view.as_slice()) {
        (Some(_), [_, ..]) => {
            return Err(loader.value("camera", "give either [camera] or [[view]], not both"));
        }
        (None, []) => {
            return Err(loader.value("camera", "is missing: add a [camera] or some [[view]]"));
        }
        (Some(camera), []) => views.push(loader.camera(camera, "camera")?),
        (None, list) => {
            for (i, view) in list.iter().enumerate() {
                views.push(loader.camera(view, &format!("view {}", i + 1))?);
            }
        }
    }
    if let Some(orbit) = &raw.orbit {
        if views.len() > 1 {
            return Err(loader.value(
                "orbit",
                "turns one camera: give [camera], not several [[view]]",
            ));
        }
        if orbit.views == 0 || orbit.views > 10_000 {
            return Err(loader.value(
                "orbit.views",
                format!("{} must lie in 1 … 10000", orbit.views),
            ));
        }
        let first = views[0];
        views = (0..orbit.views)
            .map(|i| first.orbited(360.0 * i as f32 / orbit.views as f32))
            .collect();
    }
    Ok(views)
}

fn place_object(
    loader: &mut Loader<'_>,
    raw: &RawObject,
    index: usize,
    age: &Age,
) -> Result<Object, SceneError> {
    let field = format!("object {}", index + 1);
    let name = raw.name.as_deref().unwrap_or_default();
    let [now, next] = age.changes.get(name).cloned().unwrap_or_default();
    let looks = now.material.after(&raw.material);
    let mapped = looks.has_maps();
    let mesh = now.mesh.as_ref().unwrap_or(&raw.mesh);
    let mesh = loader.mesh(mesh, mapped, &format!("{field}.mesh"))?;
    if mapped && mesh.uvs.is_empty() {
        let mend = "has no texture coordinates for its material's maps; export it with them";
        return Err(loader.value(&format!("{field}.mesh"), mend));
    }
    let mesh = match raw.vertex_colors {
        None => mesh,
        Some(ends) if ends.iter().flatten().all(|x| (0.0..=1.0).contains(x)) => {
            Arc::new(mesh.colored_by_height(ends))
        }
        Some(_) => {
            return Err(loader.value(
                &format!("{field}.vertex_colors"),
                "must be two of [red, green, blue, alpha], each 0 … 1",
            ));
        }
    };
    let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
    if !(raw.scale.is_finite() && raw.scale != 0.0) {
        return Err(loader.value(&format!("{field}.scale"), "must be finite and not 0"));
    }
    if !finite(&raw.rotate) || !finite(&raw.translate) {
        return Err(loader.value(&field, "rotate and translate must be finite"));
    }
    let mut world = Mat4::from_translation(raw.translate.into())
        * Mat4::from_quat(fixed_axes(raw.rotate))
        * Mat4::from_scale(Vec3::splat(raw.scale));
    if let Some(fit) = raw.fit {
        if !(fit.is_finite() && fit > 0.0) {
            return Err(loader.value(&format!("{field}.fit"), "must be a positive length"));
        }
        if let Some((lo, hi)) = mesh.bounds() {
            let longest = (hi - lo).max_element();
            if longest > 0.0 {
                world = world
                    * Mat4::from_scale(Vec3::splat(fit / longest))
                    * Mat4::from_translation(-(lo + hi) / 2.0);
            }
        }
    }
    let mut materials = Vec::with_capacity(mesh.parts.len());
    for part in &mesh.parts {
        let mut material = loader.material(&part.material, &looks, true, &field)?;
        if age.share > 0.0 {
            let next = next.material.after(&raw.material);
            let next = loader.material(&part.material, &next, false, &field)?;
            material = material.towards(&next, age.share);
        }
        materials.push(material);
    }
    Ok(Object {
        name: raw.name.clone().unwrap_or(field),
        mesh,
        world_from_object: world,
        layer: raw.layer,
        materials,
    })
}

fn scatter_objects(
    loader: &mut Loader<'_>,
    scatter: &Scatter,
    index: usize,
    eye: Vec3,
    objects: &mut Vec<Object>,
) -> Result<(), SceneError> {
    let field = format!("scatter {}", index + 1);
    scatter
        .check()
        .map_err(|(key, message)| loader.value(&format!("{field}.{key}"), message))?;
    let lighting =
        loader.lighting_word(scatter.lighting.as_deref(), &format!("{field}.lighting"))?;
    let mut meshes = Vec::new();
    for mesh in scatter.mesh_list() {
        meshes.push(loader.mesh(mesh, false, &format!("{field}.mesh"))?);
    }
    for (i, placed) in scatter.place(eye).into_iter().enumerate() {
        let mesh = Arc::clone(&meshes[placed.mesh]);
        let materials = mesh
            .parts
            .iter()
            .map(|p| Material {
                color: placed.color.unwrap_or(p.material.color),
                alpha: placed.alpha.unwrap_or(p.material.alpha),
                lighting: lighting.unwrap_or(p.material.lighting),
                // An opacity drawn from a range may come out as 1 and still belongs with the others.
                blend: placed.alpha.is_some(),
                ..p.material.clone()
            })
            .collect();
        objects.push(Object {
            name: format!("{field}, {}", i + 1),
            mesh,
            world_from_object: placed.world_from_object,
            layer: scatter.layer,
            materials,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const CAMERA: &str =
        "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n";

    fn load(text: &str) -> Result<Scene, SceneError> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("s.toml");
        fs::write(&path, text).expect("writes");
        Scene::load(&path)
    }

    #[test]
    fn transforms_apply_in_the_documented_order() {
        let scene = load(&format!(
            "{CAMERA}[[object]]\nmesh = {{ shape = 'box', size = [2, 4, 8] }}\nfit = 1.0\nscale = 2.0\nrotate = [90, 0, 0]\ntranslate = [0, 0, 5]\n"
        ))
        .expect("loads");
        // fit: 0.25 × 0.5 × 1; scale: 0.5 × 1 × 2; turned about x: 0.5 × 2 × 1; moved by 5.
        let o = &scene.objects[0];
        let far = o
            .mesh
            .positions
            .iter()
            .map(|p| o.world_from_object.transform_point3(*p));
        let (lo, hi) = far.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
            (a.min(p), b.max(p))
        });
        assert!((lo - Vec3::new(-0.25, -1.0, 4.5)).length() < 1e-5, "{lo}");
        assert!((hi - Vec3::new(0.25, 1.0, 5.5)).length() < 1e-5, "{hi}");
    }

    #[test]
    fn orbit_lights_and_defaults() {
        let scene = load(&format!(
            "{CAMERA}[orbit]\nviews = 4\n[[light]]\nposition = [4, 6, 4]\n[[object]]\nmesh = {{ shape = 'sphere' }}\n[object.material]\nalpha = 0.5\n"
        ))
        .expect("loads");
        assert_eq!((scene.name.as_str(), scene.views.len()), ("s", 4));
        assert!((scene.views[1].position - Vec3::new(6.0, 0.0, 0.0)).length() < 1e-5);
        let m = &scene.objects[0].materials[0];
        assert_eq!(
            (m.alpha, m.lighting, m.is_opaque()),
            (0.5, Lighting::Phong, false)
        );
        assert_eq!(scene.hash.len(), 64);
        assert!(scene.transparent_bounds().is_some());
    }

    /// A state lies between the numbers of the states around it; images and meshes are those of the state before; what a state does not
    /// name stays as it was.
    #[test]
    fn a_scene_ages() {
        let text = format!(
            "{CAMERA}[[object]]\nname = 'pot'\nmesh = {{ shape = 'sphere' }}\nmaterial = {{ color = [1, 0, 0], alpha = 0.2 }}\n\
             [[timeline]]\ntime = 0\nlabel = 'new'\n\
             [[timeline]]\ntime = 10\n[[timeline.object]]\nname = 'pot'\nmaterial = {{ alpha = 0.6, color_map = {{ pattern = 'noise', size = 8 }} }}\n\
             [[timeline]]\ntime = 30\n[[timeline.object]]\nname = 'pot'\nmesh = {{ shape = 'box' }}\nmaterial = {{ color = [0, 0, 1] }}\n"
        );
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("s.toml");
        fs::write(&path, &text).expect("writes");
        let at = |time: f32| Scene::load_at(&path, Some(time)).expect("loads");
        for (time, alpha, blue, mapped, name) in [
            (0.0, 0.2, 0.0, false, "sphere"),
            (5.0, 0.4, 0.0, false, "sphere"),
            (10.0, 0.6, 0.0, true, "sphere"),
            (20.0, 0.6, 0.5, true, "sphere"),
            (30.0, 0.6, 1.0, true, "box"),
        ] {
            let scene = at(time);
            let (object, m) = (&scene.objects[0], &scene.objects[0].materials[0]);
            assert!((m.alpha - alpha).abs() < 1e-6, "{time}: {}", m.alpha);
            assert!((m.color[2] - blue).abs() < 1e-6, "{time}: {:?}", m.color);
            assert_eq!(m.maps.color.is_some(), mapped, "{time}");
            assert_eq!(object.mesh.parts[0].name, name, "{time}");
            assert_eq!((scene.time, scene.timeline.len()), (time, 3));
        }
        // Without a time it is the first state.
        let first = Scene::load(&path).expect("loads");
        assert_eq!((first.time, first.timeline[0].label.as_str()), (0.0, "new"));
        let e = Scene::load_at(&path, Some(31.0)).expect_err("too late");
        assert!(e.to_string().contains("from 0 to 30"), "{e}");
        fs::write(&path, &text[..text.find("[[timeline]]").expect("states")]).expect("writes");
        let e = Scene::load_at(&path, Some(1.0)).expect_err("no timeline");
        assert!(e.to_string().contains("add [[timeline]]"), "{e}");
    }

    /// Each bad scene gives one error that names the file, the line or key, and the mend.
    #[test]
    fn bad_scenes() {
        let object = |text: &str| format!("{CAMERA}[[object]]\n{text}\n");
        let box_with = |text: &str| object(&format!("mesh = {{ shape = 'box' }}\n{text}"));
        for (text, words) in [
            (format!("colour = 1\n{CAMERA}"), vec!["s.toml:1", "colour"]),
            (box_with("scael = 2.0"), vec!["s.toml:8", "scael", "scale"]),
            (
                CAMERA.replace("near = 0.1", "near = 200"),
                vec!["camera.near", "below far"],
            ),
            (
                CAMERA.replace("near = 0.1", "near = 0"),
                vec!["camera.near", "positive"],
            ),
            (
                CAMERA.replace("[0, 0, 6]", "[0, 0, 0]"),
                vec!["camera.target", "differ"],
            ),
            (
                CAMERA.replace("[0, 0, 6]", "[0, 6, 0]"),
                vec!["camera.up", "line of sight"],
            ),
            (
                CAMERA.replace("[0, 0, 6]", "[0, nan, 6]"),
                vec!["camera.position", "finite"],
            ),
            (
                format!("{CAMERA}fov_y = 180.0"),
                vec!["camera.fov_y", "180"],
            ),
            (String::new(), vec!["camera", "add a [camera]"]),
            (
                format!("{CAMERA}[orbit]\nviews = 0"),
                vec!["orbit.views", "1"],
            ),
            (
                box_with("[object.material]\nalpha = 1.5"),
                vec!["object 1.material.alpha", "0 … 1"],
            ),
            (
                box_with("[object.material]\nlighting = 'toon'"),
                vec!["lighting", "phong"],
            ),
            (box_with("scale = 0.0"), vec!["object 1.scale", "not 0"]),
            (
                object("mesh = { shape = 'sphere', raduis = 2 }"),
                vec!["s.toml:7", "raduis", "radius"],
            ),
            (
                object("mesh = { shape = 'sphere', radius = -2 }"),
                vec!["object 1.mesh", "positive"],
            ),
            (
                object("mesh = 'cow.fbx'"),
                vec!["object 1.mesh", "export the mesh as one of them"],
            ),
            (object("mesh = 'none.obj'"), vec!["none.obj", "cannot read"]),
            (object("mesh = 7"), vec!["s.toml:7", "path or a table"]),
            (
                format!("{CAMERA}[scatter]\ncount = 1\nmin = [0,0,0]\nmax = [1,1,1]"),
                vec!["scatter 1.mesh", "either"],
            ),
            (
                format!(
                    "{CAMERA}[scatter]\ncount = 1\nmesh = {{ shape = 'box' }}\nmin = [0,0,0]\nmax = [1,1,1]\nalpha = [0.5, 1.5]"
                ),
                vec!["scatter 1.alpha", "0 … 1"],
            ),
            (
                box_with("[object.material]\ncolor_map = { pattern = 'noise', size = 1 }"),
                vec!["object 1.material.color_map", "4 … 4096"],
            ),
            (
                box_with("[object.material]\ncolor_map = { pattern = 'wood' }"),
                vec!["wood", "noise"],
            ),
            (
                box_with("[object.material]\ncolor_map = 'none.png'"),
                vec!["none.png", "cannot read"],
            ),
            (
                format!(
                    "{CAMERA}[[light]]\nposition = [1, 1, 1]\n[[object]]\nmesh = {{ shape = 'box' }}\n[object.material]\nmetallic_roughness_map = {{ pattern = 'noise' }}"
                ),
                vec!["metallic_roughness_map", "pbr"],
            ),
            (
                format!("{CAMERA}[[light]]\nposition = [1, 1, 1]\ndirection = [1, 0, 0]"),
                vec!["light 1", "either"],
            ),
            (
                format!("{CAMERA}[[light]]\ndirection = [0, 0, 0]"),
                vec!["light 1", "not zero"],
            ),
            (
                box_with("vertex_colors = [[0, 0, 0, 0], [2, 0, 0, 1]]"),
                vec!["object 1.vertex_colors", "0 … 1"],
            ),
            (
                format!("{CAMERA}[[timeline]]\ntime = 1\n[[timeline]]\ntime = 1"),
                vec!["timeline 2.time", "later"],
            ),
            (
                format!("{CAMERA}[[timeline]]\ntime = 1\n[[timeline.object]]\nname = 'x'"),
                vec!["timeline 1.object.name", "'x'"],
            ),
            ("name = \"x".to_owned(), vec!["s.toml:1"]),
        ] {
            let e = load(&text).expect_err(&text).to_string();
            for word in words {
                assert!(e.contains(word), "{text}\ngives: {e}\nwithout: {word}");
            }
        }
    }
}
