use crate::{
    argument::{FromFile, load_all},
    failure::{raised, warn, wrong},
};
use peelnet::scene::{SceneError, suite};
use pyo3::prelude::*;
use std::{
    collections::HashMap,
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

/// A perspective camera. Lengths are in scene units, `fov_y_degrees` is the vertical field of view.
#[pyclass(frozen, module = "peelnet")]
pub struct Camera(pub peelnet::Camera);

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (position, target, *, up=[0.0, 1.0, 0.0], fov_y_degrees=45.0, near=0.1, far=100.0))]
    fn new(
        position: [f32; 3],
        target: [f32; 3],
        up: [f32; 3],
        fov_y_degrees: f32,
        near: f32,
        far: f32,
    ) -> PyResult<Self> {
        if !(fov_y_degrees > 0.0 && fov_y_degrees < 180.0) {
            return Err(wrong(format!(
                "fov_y_degrees: {fov_y_degrees} must lie between 0 and 180 degrees"
            )));
        }
        if !(near > 0.0 && near < far && far.is_finite()) {
            return Err(wrong(format!(
                "near {near} and far {far}: near must be above 0 and below far"
            )));
        }
        let numbers = position.iter().chain(&target).chain(&up);
        if !numbers.copied().all(f32::is_finite) || position == target {
            return Err(wrong(
                "position, target and up must be finite, and position other than target",
            ));
        }
        Ok(Self(peelnet::Camera {
            position: position.into(),
            target: target.into(),
            up: up.into(),
            fov_y_degrees,
            near,
            far,
        }))
    }

    /// Eye (x, y, z), scene units.
    #[getter]
    fn position(&self) -> (f32, f32, f32) {
        self.0.position.into()
    }

    /// Point looked at (x, y, z), scene units.
    #[getter]
    fn target(&self) -> (f32, f32, f32) {
        self.0.target.into()
    }

    /// Up direction (x, y, z), any length.
    #[getter]
    fn up(&self) -> (f32, f32, f32) {
        self.0.up.into()
    }

    /// Vertical field of view, degrees.
    #[getter]
    fn fov_y_degrees(&self) -> f32 {
        self.0.fov_y_degrees
    }

    /// Near clip distance, scene units.
    #[getter]
    fn near(&self) -> f32 {
        self.0.near
    }

    /// Far clip distance, scene units.
    #[getter]
    fn far(&self) -> f32 {
        self.0.far
    }

    /// This camera, turned about `up` through its target by an angle in degrees.
    fn orbited(&self, degrees: f32) -> Self {
        Self(self.0.orbited(degrees))
    }

    fn __repr__(&self) -> String {
        let c = &self.0;
        format!(
            "Camera({}, {}, up={}, fov_y_degrees={}, near={}, far={})",
            c.position, c.target, c.up, c.fov_y_degrees, c.near, c.far
        )
    }
}

/// Loads a scene at a time of its timeline.
type Load = dyn Fn(Option<f32>) -> Result<peelnet::Scene, SceneError> + Send + Sync;

/// A scene: triangles, materials, lights and views.
///
/// Args:
///     path: A scene file (.toml), a mesh (.gltf, .glb, .obj, .ply, .stl, .splat, .spz), or the name of a shipped scene (see `samples()`).
///     time: Time in the scene's timeline; material values are interpolated between its states.
///     files_from: Folders in which a mesh file may name textures and buffers, beside its own and the scene's.
///
/// What was repaired or left out while loading is in `warnings` and is reported as `UserWarning`.
#[pyclass(frozen, module = "peelnet")]
#[derive(Clone)]
pub struct Scene {
    pub scene: Arc<peelnet::Scene>,
    load: Arc<Load>,
}

impl Scene {
    fn loaded_by(load: Arc<Load>, py: Python<'_>, time: Option<f32>) -> PyResult<Self> {
        let scene = py.detach(|| load(time)).map_err(raised)?;
        for warning in &scene.warnings {
            warn(py, warning)?;
        }
        Ok(Self {
            scene: Arc::new(scene),
            load,
        })
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (path, *, time=None, files_from=Vec::new()))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        time: Option<f32>,
        files_from: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let load = move |time| suite::open_with(&path, time, &files_from);
        Self::loaded_by(Arc::new(load), py, time)
    }

    /// Reads a scene from bytes.
    ///
    /// Args:
    ///     name: The file's name; its ending says what the bytes are (.toml, .gltf, .glb, .obj, .ply, .stl, .splat, .spz).
    ///     data: The file's bytes.
    ///     files: Bytes of the files that it names, by path relative to the same folder as `name`.
    ///     time: Time in the scene's timeline.
    #[staticmethod]
    #[pyo3(signature = (name, data, *, files=None, time=None))]
    fn from_bytes(
        py: Python<'_>,
        name: PathBuf,
        data: Vec<u8>,
        files: Option<HashMap<PathBuf, Vec<u8>>>,
        time: Option<f32>,
    ) -> PyResult<Self> {
        let folder = name.parent().map(Path::to_owned).unwrap_or_default();
        let others = files.unwrap_or_default().into_iter();
        let mut files: HashMap<PathBuf, Vec<u8>> = others
            .map(|(path, data)| (folder.join(path), data))
            .collect();
        files.insert(name.clone(), data);
        let load = move |time| {
            peelnet::Scene::from_bytes_at(&name, time, |path: &Path| {
                let found = files.get(path).cloned();
                found.ok_or_else(|| io::ErrorKind::NotFound.into())
            })
        };
        Self::loaded_by(Arc::new(load), py, time)
    }

    /// The same scene at a time of its timeline.
    pub fn at(&self, py: Python<'_>, time: f32) -> PyResult<Self> {
        Self::loaded_by(Arc::clone(&self.load), py, Some(time))
    }

    /// The scene's name; rows and results are identified by it.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.name
    }

    /// SHA-256 over the scene file and every file it reads, hexadecimal.
    #[getter]
    fn hash(&self) -> &str {
        &self.scene.hash
    }

    /// The cameras of the scene's views.
    #[getter]
    fn views(&self) -> Vec<Camera> {
        self.scene.views.iter().copied().map(Camera).collect()
    }

    /// Number of triangles.
    #[getter]
    fn triangles(&self) -> usize {
        self.scene.triangles()
    }

    /// Background radiance (red, green, blue), linear.
    #[getter]
    fn background(&self) -> (f32, f32, f32) {
        self.scene.background.into()
    }

    /// Whether the scene is kept out of all training.
    #[getter]
    fn held_out(&self) -> bool {
        self.scene.held_out
    }

    /// What was repaired or left out while loading.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.clone()
    }

    /// Times of the timeline's states; empty without a timeline.
    #[getter]
    fn timeline(&self) -> Vec<f32> {
        self.scene.timeline.iter().map(|state| state.time).collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "Scene({:?}: {} views, {} triangles)",
            self.scene.name,
            self.scene.views.len(),
            self.scene.triangles()
        )
    }
}

impl FromFile for Scene {
    const IS: &str = "a scene is a Scene, a path, or the name of a shipped scene";

    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::new(py, path, None, Vec::new())
    }
}

pub fn loaded(scenes: &Bound<'_, PyAny>) -> PyResult<Vec<peelnet::Scene>> {
    let scenes = load_all::<Scene>(scenes)?.into_iter();
    Ok(scenes.map(|s| Arc::unwrap_or_clone(s.scene)).collect())
}

/// The names of the scenes that ship, which `Scene(name)` loads.
#[pyfunction]
pub fn samples() -> Vec<String> {
    let files = suite::SCENES.iter().chain(suite::EFFECTS);
    files.map(|file| file.name.to_owned()).collect()
}
