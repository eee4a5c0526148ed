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

/// Reads files, hashes those that become part of a scene, and makes textures of theirs.
pub(crate) struct Files<'a> {
    read: &'a Read<'a>,
    hasher: Sha256,
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
            hasher: Sha256::new(),
            used: Vec::new(),
            lighting: Lighting::Phong,
            budget: Budget::default(),
            warnings: Warnings::default(),
            made: HashMap::new(),
            sources: Vec::new(),
        }
    }

    /// Reads a file of at most `limit` bytes, which becomes part of the scene's hash and list.
    pub fn read(&mut self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        // A caller's function knows no limit.
        let read = (self.read)(path, limit)
            .and_then(|bytes| check_size(bytes.len() as u64, limit).map(|()| bytes));
        let bytes = read.map_err(|source| SceneError::Read {
            path: path.to_owned(),
            source,
        })?;
        self.hasher.update(&bytes);
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
        self.made(what, sources, || {
            let white = Texture::of("white", [1, 1], |_, _| [255; 4]);
            let [a, b] = sources.map(|t| t.map_or(&white, |t| t.as_ref()));
            Texture::joined(a, b, texel)
        })
    }

    pub fn warn(&mut self, path: &Path, text: &str) {
        self.warnings.add(format!("{}: {text}", shown(path)));
    }

    /// Adds bytes that are in no file to the hash.
    pub fn hash_value(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
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
