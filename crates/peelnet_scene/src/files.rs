//! The files of a scene. All of them are read through one function, so that a folder, an archive, a web page or a test can be the file
//! system.

use crate::{budget::Budget, error::SceneError, texture::Texture};
use peelnet_files::{check_size, hex};
use sha2::{Digest as _, Sha256};
use std::{
    io,
    path::{Path, PathBuf},
};

/// What a file is for; each kind has a largest size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileKind {
    /// A scene file (TOML).
    Scene,
    /// OBJ, PLY, STL, glTF, GLB, or a buffer of a glTF file.
    Mesh,
    /// MTL.
    Materials,
    /// PNG or JPEG.
    Image,
}

impl FileKind {
    /// Largest size, bytes. In 64 bits: the largest does not fit a 32-bit `usize`.
    pub const fn max_bytes(self) -> u64 {
        match self {
            Self::Scene | Self::Materials => 64 << 20,
            Self::Image => 512 << 20,
            Self::Mesh => MAX_FILE_BYTES,
        }
    }
}

/// Size of the largest file of any kind that is read, bytes.
pub(crate) const MAX_FILE_BYTES: u64 = 4 << 30;

/// Reads the file at a path, if it is not larger than so many bytes.
type Read<'a> = dyn Fn(&Path, u64) -> io::Result<Vec<u8>> + 'a;

/// Reads files and hashes those that become part of a scene.
pub(crate) struct Files<'a> {
    read: &'a Read<'a>,
    hasher: Sha256,
    used: Vec<PathBuf>,
    /// What the scene may take that these files make.
    pub budget: Budget,
}

impl<'a> Files<'a> {
    /// Files that `read` returns, such as [`peelnet_files::read`].
    pub fn new(read: &'a Read<'a>) -> Self {
        Self {
            read,
            hasher: Sha256::new(),
            used: Vec::new(),
            budget: Budget::default(),
        }
    }

    /// Reads a file, which becomes part of the scene's hash and list.
    pub fn read(&mut self, path: &Path, kind: FileKind) -> Result<Vec<u8>, SceneError> {
        let limit = kind.max_bytes();
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

    /// Reads a texture.
    pub fn texture(&mut self, path: &Path) -> Result<Texture, SceneError> {
        let bytes = self.read(path, FileKind::Image)?;
        let name = path.display().to_string();
        Texture::decode_within(&name, &bytes, &mut self.budget)
            .map_err(|message| SceneError::file(path, None, message))
    }

    /// Adds bytes that are in no file to the hash.
    pub fn hash_value(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
    }

    /// Every file that was read, in order.
    pub fn used(&self) -> &[PathBuf] {
        &self.used
    }

    /// SHA-256 over every file that was read in order, hexadecimal.
    pub fn hash(self) -> String {
        hex(&self.hasher.finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit of a kind holds whatever the function is that reads, and that function knows it.
    #[test]
    fn each_kind_has_a_limit() {
        let read = |_: &Path, limit: u64| {
            assert!(limit == 64 << 20 || limit == 512 << 20);
            Ok(vec![0; (64 << 20) + 1])
        };
        let mut files = Files::new(&read);
        let path = Path::new("s.toml");
        assert!(files.read(path, FileKind::Image).is_ok());
        let e = files.read(path, FileKind::Scene).expect_err("too large");
        assert!(e.to_string().contains("s.toml"), "{e}");
    }
}
