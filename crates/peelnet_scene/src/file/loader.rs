//! What all parts of a scene file share while it is loaded.

use super::references::MeshRef;
use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    import::Format,
    material::{Lighting, Material},
    mesh::Mesh,
    pattern::Pattern,
    shapes::Shape,
    specular_glossiness::Converter,
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
    /// How materials are lit that do not say it.
    pub lighting: Lighting,
    pub files: Files<'a>,
    pub warnings: Vec<String>,
    meshes: HashMap<PathBuf, Arc<Mesh>>,
    /// Generated meshes, by shape and whether they have UVs.
    shapes: HashMap<(String, bool), Arc<Mesh>>,
    /// Generated textures, by pattern and key.
    patterns: HashMap<(String, &'static str), Arc<Texture>>,
    textures: HashMap<PathBuf, Arc<Texture>>,
    /// For materials of the specular–glossiness workflow.
    pub converter: Converter,
}

impl<'a> Loader<'a> {
    pub fn new(path: &'a Path, lighting: Lighting, files: Files<'a>) -> Self {
        Self {
            path,
            lighting,
            files,
            warnings: Vec::new(),
            meshes: HashMap::new(),
            shapes: HashMap::new(),
            patterns: HashMap::new(),
            textures: HashMap::new(),
            converter: Converter::default(),
        }
    }

    /// The error for a value of a field.
    pub fn value(&self, field: &str, message: impl Into<String>) -> SceneError {
        SceneError::Value {
            path: self.path.to_owned(),
            field: field.to_owned(),
            message: message.into(),
        }
    }

    /// The path of a file that the scene file names.
    fn beside(&self, name: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).join(name)
    }

    /// A mesh, read or generated once. A generated one has UVs only where `has_uvs` asks for them.
    pub fn mesh(
        &mut self,
        mesh: &MeshRef,
        has_uvs: bool,
        field: &str,
    ) -> Result<Arc<Mesh>, SceneError> {
        match mesh {
            MeshRef::Shape(shape) => {
                let key = (format!("{shape:?}"), has_uvs);
                if let Some(mesh) = self.shapes.get(&key) {
                    return Ok(Arc::clone(mesh));
                }
                let built = self.shape(shape, has_uvs);
                let built = Arc::new(built.map_err(|e| self.value(field, e))?);
                self.shapes.insert(key, Arc::clone(&built));
                Ok(built)
            }
            MeshRef::File(name) => {
                let file = self.beside(name);
                if let Some(mesh) = self.meshes.get(&file) {
                    return Ok(Arc::clone(mesh));
                }
                let mesh = Arc::new(self.mesh_file(&file, field)?);
                self.meshes.insert(file, Arc::clone(&mesh));
                Ok(mesh)
            }
        }
    }

    fn shape(&mut self, shape: &Shape, has_uvs: bool) -> Result<Mesh, String> {
        let triangles = shape.triangles() as u64;
        // No shape has more than two vertices for each triangle.
        let vertices = triangles.saturating_mul(2);
        self.files.budget.take_mesh(triangles, vertices)?;
        shape.build(&Material::default_with(self.lighting), has_uvs)
    }

    /// A generated texture, made once for each pattern and key of a material.
    pub fn pattern(
        &mut self,
        pattern: &Pattern,
        make: fn(&Pattern) -> Result<Texture, String>,
        key: &'static str,
    ) -> Result<Arc<Texture>, String> {
        let name = (format!("{pattern:?}"), key);
        if let Some(known) = self.patterns.get(&name) {
            return Ok(Arc::clone(known));
        }
        pattern.check()?;
        self.files.budget.take_texels([pattern.size; 2])?;
        let made = Arc::new(make(pattern)?);
        self.patterns.insert(name, Arc::clone(&made));
        Ok(made)
    }

    fn mesh_file(&mut self, file: &Path, field: &str) -> Result<Mesh, SceneError> {
        let Some(format) = Format::of(file) else {
            let message = format!(
                "{} is neither .obj, .gltf, .glb, .ply nor .stl; export the mesh as one of them",
                shown(file)
            );
            return Err(self.value(field, message));
        };
        // The scene file's lights and cameras replace those of the mesh.
        let loaded = format.load(file, self.lighting, &mut self.files)?;
        self.warnings.extend(loaded.warnings);
        Ok(loaded.mesh)
    }

    /// A texture of a file, read once.
    pub fn texture(&mut self, name: &Path) -> Result<Arc<Texture>, SceneError> {
        let file = self.beside(name);
        if let Some(known) = self.textures.get(&file) {
            return Ok(Arc::clone(known));
        }
        let bytes = self.files.read(&file, FileKind::Image)?;
        let name = file.display().to_string();
        let texture = Texture::decode_within(&name, &bytes, &mut self.files.budget);
        let texture = Arc::new(texture.map_err(|message| SceneError::Mesh {
            path: file.clone(),
            line: None,
            message,
        })?);
        self.files.record(&file, &bytes);
        self.textures.insert(file, Arc::clone(&texture));
        Ok(texture)
    }
}
