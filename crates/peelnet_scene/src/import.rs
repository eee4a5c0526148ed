//! Mesh files: one table of formats, each with one loader.

mod gltf;
mod mtl;
mod obj;
mod ply;
mod ply_elements;
mod polygons;
mod stl;
mod surface;
mod textures;

use crate::{error::SceneError, files::Files, material::Lighting, mesh::Mesh, scene::Light};
use glam::Mat4;
use std::path::Path;

/// What a mesh file holds.
#[derive(Clone, Debug)]
pub(crate) struct Imported {
    /// All triangles in the file's space.
    pub mesh: Mesh,
    /// Point and directional lights.
    pub lights: Vec<Light>,
    /// Cameras with a perspective projection.
    pub cameras: Vec<FileCamera>,
    /// What is missing, repaired or not drawn.
    pub warnings: Vec<String>,
}

impl Imported {
    fn mesh(mesh: Mesh, warnings: Vec<String>) -> Self {
        Self {
            mesh,
            lights: Vec::new(),
            cameras: Vec::new(),
            warnings,
        }
    }
}

/// A camera of a file, in its space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FileCamera {
    /// The camera looks along −z.
    pub file_from_camera: Mat4,
    /// Vertical field of view, radians.
    pub fov_y: f32,
    pub near: f32,
    /// Where the file gives one.
    pub far: Option<f32>,
}

/// A format of mesh files.
pub(crate) struct Format {
    /// Endings of file names, in lower case.
    endings: &'static [&'static str],
    /// Whether its files can hold lights and blended materials.
    pub is_scene: bool,
    /// Reads a file; `Lighting` is that of materials which do not say it. Every file that is read is recorded.
    pub load: fn(&Path, Lighting, &mut Files<'_>) -> Result<Imported, SceneError>,
}

const FORMATS: [Format; 4] = [
    Format {
        endings: &["gltf", "glb"],
        is_scene: true,
        load: gltf::load,
    },
    Format {
        endings: &["obj"],
        is_scene: false,
        load: obj::load,
    },
    Format {
        endings: &["ply"],
        is_scene: false,
        load: ply::load,
    },
    Format {
        endings: &["stl"],
        is_scene: false,
        load: stl::load,
    },
];

impl Format {
    /// The format of a file, by its name's ending in letters of any case; `None` of one that is no mesh.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let ending = path.extension()?.to_str()?.to_lowercase();
        FORMATS.iter().find(|f| f.endings.contains(&&*ending))
    }
}

/// Loads files that tests hold in memory, the first by its format.
#[cfg(test)]
fn load_from_memory(
    files: &[(&str, &[u8])],
    lighting: Lighting,
) -> (Result<Imported, SceneError>, usize) {
    let read = |path: &Path, _: u64| {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let bytes = found.map(|(_, bytes)| bytes.to_vec());
        bytes.ok_or_else(|| std::io::ErrorKind::NotFound.into())
    };
    let mut read = Files::new(&read);
    let path = Path::new(files[0].0);
    let format = Format::of(path).expect("a mesh file");
    let loaded = (format.load)(path, lighting, &mut read);
    let used = read.used().len();
    (loaded, used)
}

/// Loads a file of a mesh alone that a test holds in memory.
#[cfg(test)]
fn load_mesh(name: &str, bytes: &[u8]) -> Result<Imported, String> {
    let (loaded, _) = load_from_memory(&[(name, bytes)], Lighting::Phong);
    loaded.map_err(|e| e.to_string())
}

/// The error begins with the name of the file, and `words`, between ` & `, are in it.
#[cfg(test)]
fn assert_refused(loaded: Result<Imported, String>, file: &str, words: &str) {
    let e = loaded.map(|_| ()).expect_err(words);
    assert!(e.starts_with(file), "{e}");
    for word in words.split(" & ") {
        assert!(e.contains(word), "no '{word}' in: {e}");
    }
    assert!(!e.contains(char::is_control), "{e:?}");
}

/// The area of a mesh that faces +z.
#[cfg(test)]
fn area(mesh: &Mesh) -> f32 {
    let triangles = mesh.triangles.iter();
    let areas = triangles.map(|t| crate::mesh::area_of(&mesh.positions, *t).z / 2.0);
    areas.sum()
}
