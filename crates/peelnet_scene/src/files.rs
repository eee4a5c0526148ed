//! What the files of a scene share while they are loaded. All of them are read through one function, so that a folder, an archive, a web
//! page or a test can be the file system.

use crate::{
    budget::Budget,
    error::{SceneError, shown},
    material::Lighting,
    texture::Texture,
    warnings::Warnings,
};
use peelnet_core::files::{check_size, hex};
use sha2::{Digest as _, Sha256};
use std::{
    collections::HashMap,
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Size of the largest scene file or MTL file, bytes.
pub(crate) const MAX_TEXT: u64 = 64 << 20;

/// Of the largest PNG or JPEG file.
pub(crate) const MAX_IMAGE: u64 = 512 << 20;

/// Of the largest mesh file, or buffer of a glTF file. In 64 bits: it does not fit a 32-bit `usize`.
pub(crate) const MAX_MESH: u64 = 4 << 30;

/// Reads the file at a path, if it is not larger than so many bytes.
type Read<'a> = dyn Fn(&Path, u64) -> io::Result<Vec<u8>> + 'a;

/// Texels of two textures joined, over those of both and a million: 1x8192 and 8192x1 have 64 million.
const MOST_LARGER: u64 = 2;

/// Reads files, hashes those that become part of a scene, and makes textures of theirs.
pub(crate) struct Files<'a> {
    read: &'a Read<'a>,
    /// Of files on this machine: folders in which those lie that mesh files may name. A mesh file is a stranger's, a scene file the user's own.
    pub allowed: Option<Vec<PathBuf>>,
    /// The mesh file that names files now.
    mesh: Option<PathBuf>,
    /// Those that are read whole, by [`Files::identity`].
    buffers: HashMap<String, Arc<Vec<u8>>>,
    hasher: Sha256,
    /// The same with what a scene shows in place of the scene file's bytes.
    content: Sha256,
    /// Every file that was read, in order.
    pub used: Vec<PathBuf>,
    /// How materials are lit that do not say it.
    pub lighting: Lighting,
    pub budget: Budget,
    pub warnings: Warnings,
    /// By what is made, and the addresses of what of.
    made: HashMap<String, Arc<Texture>>,
    /// What is made of: held, so that its addresses stay its own.
    sources: Vec<Arc<Texture>>,
}

impl<'a> Files<'a> {
    /// Files that `read` returns, such as [`peelnet_core::files::read`].
    pub fn new(read: &'a Read<'a>) -> Self {
        Self {
            read,
            allowed: None,
            mesh: None,
            buffers: HashMap::new(),
            hasher: Sha256::new(),
            content: Sha256::new(),
            used: Vec::new(),
            lighting: Lighting::Phong,
            budget: Budget::default(),
            warnings: Warnings::default(),
            made: HashMap::new(),
            sources: Vec::new(),
        }
    }

    /// Files on this machine, those that mesh files name also from these folders.
    pub fn on_disk(folders: &[PathBuf]) -> Self {
        Self {
            allowed: Some(folders.to_vec()),
            ..Self::new(&peelnet_core::files::read)
        }
    }

    /// A key of a file, the same under all of its names where the system has numbers of files.
    pub fn identity(&self, path: &Path) -> String {
        let on_disk = self.allowed.as_ref();
        match on_disk.and_then(|_| peelnet_core::files::identity(path)) {
            Some(number) => format!("{number:?}"),
            None => path.display().to_string(),
        }
    }

    /// Loads a mesh file, which may name files in its own folder, below it, and in the allowed ones.
    pub fn within<T>(&mut self, mesh: &Path, load: impl FnOnce(&mut Self) -> T) -> T {
        let outer = self.mesh.replace(mesh.to_owned());
        let loaded = load(self);
        self.mesh = outer;
        loaded
    }

    /// An error where a mesh file names a file elsewhere.
    fn check_place(&self, path: &Path) -> io::Result<()> {
        let (Some(allowed), Some(mesh)) = (&self.allowed, &self.mesh) else {
            return Ok(());
        };
        if path == mesh {
            return Ok(());
        }
        // What is not there, or is no file, is not read.
        let file = path.canonicalize().ok().filter(|file| file.is_file());
        let Some(file) = file else {
            return Ok(());
        };
        let folder = |folder: &PathBuf| match folder.as_os_str().is_empty() {
            true => Path::new(".").canonicalize(),
            false => folder.canonicalize(),
        };
        let own = mesh.parent().map(Path::to_owned);
        let allowed = allowed.iter().chain(&own);
        let mut allowed = allowed.filter_map(|f| folder(f).ok());
        if allowed.any(|folder| file.starts_with(folder)) {
            return Ok(());
        }
        Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "lies outside of the folder of the file that names it; copy it there, or allow its folder with --files-from",
        ))
    }

    /// A file whose bytes stay as they are, read once under all of its names.
    pub fn buffer(&mut self, path: &Path, limit: u64) -> Result<Arc<Vec<u8>>, SceneError> {
        let placed = self.check_place(path);
        let key = self.identity(path);
        if let Some(known) = self.buffers.get(&key).filter(|_| placed.is_ok()) {
            return Ok(Arc::clone(known));
        }
        let bytes = Arc::new(self.read(path, limit)?);
        self.buffers.insert(key, Arc::clone(&bytes));
        Ok(bytes)
    }

    /// Reads a file of at most `limit` bytes, which becomes part of the scene's hash and list.
    pub fn read(&mut self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        let place = self.check_place(path);
        // A caller's function knows no limit.
        let read = place
            .and_then(|()| (self.read)(path, limit))
            .and_then(|bytes| check_size(bytes.len() as u64, limit).map(|()| bytes));
        let bytes = read.map_err(|source| SceneError::Read {
            path: path.to_owned(),
            source,
        })?;
        self.hash_value(&bytes);
        self.used.push(path.to_owned());
        Ok(bytes)
    }

    pub fn texture(&mut self, path: &Path) -> Result<Texture, SceneError> {
        let bytes = self.read(path, MAX_IMAGE)?;
        let name = path.display().to_string();
        Texture::decode(&name, &bytes, &mut self.budget)
            .map_err(|message| SceneError::file(path, None, message))
    }

    /// A texture of two others or fewer, whose size is the largest of each side, made once.
    pub fn made(
        &mut self,
        what: &str,
        sources: [Option<&Arc<Texture>>; 2],
        make: impl FnOnce() -> Texture,
    ) -> Result<Arc<Texture>, String> {
        let [a, b] = sources.map(|t| t.map(Arc::as_ptr));
        let key = format!("{what} of {a:?} and {b:?}");
        if let Some(known) = self.made.get(&key) {
            return Ok(Arc::clone(known));
        }
        let sizes = sources.map(|t| t.map_or([1, 1], |t| t.size));
        self.budget
            .take_texels([0, 1].map(|k| sizes[0][k].max(sizes[1][k])))?;
        let made = Arc::new(make());
        self.sources.extend(sources.into_iter().flatten().cloned());
        self.made.insert(key, Arc::clone(&made));
        Ok(made)
    }

    /// Two textures joined texel by texel. White stands for a missing one.
    pub fn joined(
        &mut self,
        what: &str,
        sources: [Option<&Arc<Texture>>; 2],
        texel: impl Fn([u8; 4], [u8; 4]) -> [u8; 4] + Sync,
    ) -> Result<Arc<Texture>, String> {
        let sizes = sources.map(|t| t.map_or([1, 1], |t| t.size));
        let area = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        let [a, b] = sizes;
        let most = MOST_LARGER * (area(a) + area(b) + (1 << 20));
        if area([0, 1].map(|k| a[k].max(b[k]))) > most {
            return Err(format!(
                "maps of {}x{} and {}x{} texels cannot be joined; scale one to the shape of the other",
                a[0], a[1], b[0], b[1]
            ));
        }
        self.made(what, sources, || {
            let white = Texture::of("white", [1, 1], |_, _| [255; 4]);
            let [a, b] = sources.map(|t| t.map_or(&white, |t| t.as_ref()));
            Texture::joined(a, b, texel)
        })
    }

    pub fn warn(&mut self, path: &Path, text: &str) {
        self.warnings.add(format!("{}: {text}", shown(path)));
    }

    /// Adds bytes that are in no file to the hashes.
    pub fn hash_value(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
        self.content.update(bytes);
    }

    /// The scene file was read: this is what it shows.
    pub fn scene_shows(&mut self, text: &str) {
        self.content = Sha256::new_with_prefix(text);
    }

    /// SHA-256 over what the scene shows, whatever it is called and used for, hexadecimal.
    pub fn content(&self) -> String {
        hex(&self.content.clone().finalize())
    }

    /// SHA-256 over every file that was read in order, hexadecimal.
    pub fn hash(&self) -> String {
        hex(&self.hasher.clone().finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit holds whatever the function is that reads, and that function knows it.
    #[test]
    fn limits_hold_for_any_function() {
        let read = |_: &Path, limit: u64| {
            assert!(limit == MAX_TEXT || limit == MAX_IMAGE);
            Ok(vec![0; (64 << 20) + 1])
        };
        let mut files = Files::new(&read);
        let path = Path::new("s.toml");
        assert!(files.read(path, MAX_IMAGE).is_ok());
        let e = files.read(path, MAX_TEXT).expect_err("too large");
        assert!(e.to_string().contains("s.toml"), "{e}");
    }
}
