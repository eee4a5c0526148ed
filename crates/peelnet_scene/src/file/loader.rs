//! What all parts of a scene file share while it is loaded.

use super::raw::{MapRef, MeshRef, Reference};
use crate::{
    error::{Fault, SceneError, shown},
    files::Files,
    import,
    material::Material,
    mesh::Mesh,
    texture::Texture,
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Loads each mesh and texture of a scene file once.
pub(super) struct Loader<'a> {
    /// The scene file.
    pub path: &'a Path,
    pub files: Files<'a>,
    /// By file, or shape and whether it has UVs.
    meshes: HashMap<String, Arc<Mesh>>,
    /// By file, or pattern and key of a material.
    textures: HashMap<String, Arc<Texture>>,
}

impl<'a> Loader<'a> {
    pub fn new(path: &'a Path, files: Files<'a>) -> Self {
        Self {
            path,
            files,
            meshes: HashMap::new(),
            textures: HashMap::new(),
        }
    }

    pub fn value(&self, field: &str, message: impl Into<String>) -> SceneError {
        SceneError::value(self.path, field, message)
    }

    pub fn fault(&self, table: &str, (key, message): Fault) -> SceneError {
        self.value(&format!("{table}.{key}"), message)
    }

    pub fn beside(&self, name: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).join(name)
    }

    /// A mesh, read or generated once. A generated one has UVs only where `has_uvs` asks for them; a file must have them then.
    pub fn mesh(
        &mut self,
        mesh: &MeshRef,
        has_uvs: bool,
        field: &str,
    ) -> Result<Arc<Mesh>, SceneError> {
        let key = match mesh {
            Reference::Made(shape) => format!("{shape:?}, UVs {has_uvs}"),
            Reference::File(name) => self.files.identity(&self.beside(name)),
        };
        let known = match (self.meshes.get(&key), mesh) {
            (Some(known), _) => Arc::clone(known),
            (None, Reference::Made(shape)) => {
                let triangles = shape.triangles() as u64;
                // No shape has more than two vertices for each triangle.
                let budget = &mut self.files.budget;
                let taken = budget.take_mesh(triangles, triangles.saturating_mul(2));
                let material = Material::default_with(self.files.lighting);
                let made = taken.and_then(|()| shape.build(&material, has_uvs));
                Arc::new(made.map_err(|e| self.value(field, e))?)
            }
            (None, Reference::File(name)) => Arc::new(self.mesh_file(name, field)?),
        };
        self.meshes.insert(key, Arc::clone(&known));
        if has_uvs && known.uvs.is_empty() {
            let message = "has no texture coordinates for its material's maps; export it with them";
            return Err(self.value(field, message));
        }
        Ok(known)
    }

    fn mesh_file(&mut self, name: &Path, field: &str) -> Result<Mesh, SceneError> {
        let file = self.beside(name);
        let Some(load) = import::loader(&file) else {
            let message = format!(
                "{} is neither .obj, .gltf, .glb, .ply, .stl, .splat nor .spz; export the mesh as one of them",
                shown(&file)
            );
            return Err(self.value(field, message));
        };
        // The scene file's lights and cameras replace those of the mesh.
        let loaded = self.files.within(&file, |files| load(&file, files));
        Ok(loaded?.mesh)
    }

    /// The texture of a key of a table: of a file, read once, or of a pattern, made once for each key.
    pub fn map(
        &mut self,
        map: &MapRef,
        key: &str,
        table: &str,
    ) -> Result<Arc<Texture>, SceneError> {
        let name = match map {
            Reference::Made(pattern) => format!("{key} = {pattern:?}"),
            Reference::File(name) => self.files.identity(&self.beside(name)),
        };
        if let Some(known) = self.textures.get(&name) {
            return Ok(Arc::clone(known));
        }
        let texture = match map {
            Reference::Made(pattern) => {
                let taken = pattern.check();
                let taken = taken.and_then(|()| self.files.budget.take_pattern(pattern.size));
                taken.map_err(|e| self.value(&format!("{table}.{key}"), e))?;
                pattern.texture(key)
            }
            Reference::File(name) => {
                let file = self.beside(name);
                self.files.texture(&file)?
            }
        };
        let texture = Arc::new(texture);
        self.textures.insert(name, Arc::clone(&texture));
        Ok(texture)
    }
}
