//! Mesh files: one table of formats, each with one loader.

mod gltf;
mod mtl;
mod obj;
mod ply;
mod ply_elements;
mod polygons;
mod splats;
mod stl;
mod surface;
mod textures;

use crate::{camera::Camera, error::SceneError, files::Files, mesh::Mesh, scene::Light};
use std::path::Path;

#[derive(Clone, Debug, Default)]
pub(crate) struct Imported {
    /// All triangles in the file's space.
    pub mesh: Mesh,
    /// Point and directional lights.
    pub lights: Vec<Light>,
    /// Cameras with a perspective projection and their names; `far` is infinite where the file gives none.
    pub cameras: Vec<(String, Camera)>,
    /// Whether files of its format can hold lights and blended materials.
    pub is_scene: bool,
    /// Whether up is −y: of splats in the axes of COLMAP, which the networks that make them take over.
    pub is_y_down: bool,
}

/// Reads a mesh file. Every file that is read is recorded, and what is missing, repaired or not drawn is a warning.
pub(crate) type Load = fn(&Path, &mut Files<'_>) -> Result<Imported, SceneError>;

/// The loader of a file's format, by its name's ending in letters of any case; `None` of one that is no mesh.
pub(crate) fn loader(path: &Path) -> Option<Load> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    let load: Load = match &*ending {
        "gltf" | "glb" => gltf::load,
        "obj" => obj::load,
        "ply" => |path, files| surface::load(path, files, ply::read),
        "splat" => |path, files| surface::load(path, files, splats::antimatter::read),
        "spz" => |path, files| {
            let loaded = surface::load(path, files, splats::spz::read)?;
            let is_y_down = false;
            Ok(Imported {
                is_y_down,
                ..loaded
            })
        },
        "stl" => |path, files| surface::load(path, files, stl::read),
        _ => return None,
    };
    Some(load)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file would take is compared with the limit before it is taken.
    #[test]
    fn large_files_are_refused() {
        let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 0\n";
        let stl = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
        let binary = [&[0; 80], &1u32.to_le_bytes()[..], &[0; 50]].concat();
        for (name, bytes) in [
            ("a.ply", ply.as_bytes()),
            ("a.stl", stl.as_bytes()),
            ("a.stl", &binary),
        ] {
            let read = |_: &Path, _: u64| Ok(bytes.to_vec());
            let mut files = Files::new(&read);
            let most = crate::budget::MAX_TRIANGLES;
            files.budget.take_mesh(most, 0).expect("fits");
            let path = Path::new(name);
            let load = loader(path).expect("a mesh file");
            let e = load(path, &mut files).expect_err("too large");
            assert!(e.to_string().contains("at most 50000000"), "{e}");
        }
    }
}
