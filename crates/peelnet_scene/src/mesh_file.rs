//! The formats of mesh files.

use std::path::Path;

/// A format, known by the ending of a file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// glTF 2.0, as text or GLB.
    Gltf,
    /// OBJ with MTL.
    Obj,
    /// PLY, of text or binary.
    Ply,
    /// STL, of text or binary.
    Stl,
}

impl Format {
    /// The format of a file; `None` of one that is no mesh. Letters may be of any case.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_lowercase();
        Some(match ending.as_str() {
            "gltf" | "glb" => Self::Gltf,
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            _ => return None,
        })
    }
}
