//! The files of a scene. All of them are read through one function, so that a folder, an archive, a web page or a test can be the file
//! system.

use crate::error::SceneError;
use sha2::{Digest as _, Sha256};
use std::{
    fs,
    io::{self, Read as _},
    path::{Path, PathBuf},
};

/// What a file is for; each kind has a largest size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileKind {
    /// A scene file (TOML).
    Scene,
    /// OBJ, glTF, GLB, or a buffer of a glTF file.
    Mesh,
    /// MTL.
    Materials,
    /// PNG or JPEG.
    Image,
}

impl FileKind {
    /// Largest size, bytes. In 64 bits: the largest does not fit a 32-bit `usize`.
    const fn max_bytes(self) -> u64 {
        match self {
            Self::Scene | Self::Materials => 64 << 20,
            Self::Image => 512 << 20,
            Self::Mesh => MAX_FILE_BYTES,
        }
    }
}

/// Size of the largest file of any kind that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 4 << 30;

/// Reads a regular file of at most [`MAX_FILE_BYTES`]. A device or a pipe is refused before it is opened: it could block, or never end.
///
/// # Errors
/// A file that is not regular, is too large, or cannot be read.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "not a regular file",
        ));
    }
    check_size(metadata.len(), MAX_FILE_BYTES)?;
    let mut bytes = Vec::new();
    // A file can grow while it is read.
    let mut bounded = fs::File::open(path)?.take(MAX_FILE_BYTES + 1);
    bounded.read_to_end(&mut bytes)?;
    check_size(bytes.len() as u64, MAX_FILE_BYTES)?;
    Ok(bytes)
}

fn check_size(bytes: u64, limit: u64) -> io::Result<()> {
    if bytes <= limit {
        return Ok(());
    }
    Err(io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!("{bytes} bytes, and at most {limit} are read"),
    ))
}

/// Reads files and hashes those that become part of a scene.
pub(crate) struct Files<'a> {
    read: &'a dyn Fn(&Path) -> io::Result<Vec<u8>>,
    hasher: Sha256,
    used: Vec<PathBuf>,
}

impl<'a> Files<'a> {
    pub fn new(read: &'a dyn Fn(&Path) -> io::Result<Vec<u8>>) -> Self {
        Self {
            read,
            hasher: Sha256::new(),
            used: Vec::new(),
        }
    }

    /// A file's bytes.
    pub fn read(&self, path: &Path, kind: FileKind) -> Result<Vec<u8>, SceneError> {
        (self.read)(path)
            .and_then(|bytes| check_size(bytes.len() as u64, kind.max_bytes()).map(|()| bytes))
            .map_err(|source| SceneError::Read {
                path: path.to_owned(),
                source,
            })
    }

    /// Adds a file that was read to the scene's hash and list.
    pub fn record(&mut self, path: &Path, bytes: &[u8]) {
        self.hasher.update(bytes);
        self.used.push(path.to_owned());
    }

    /// Adds bytes that are in no file to the hash.
    pub fn hash_value(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
    }

    /// Every recorded file, in order.
    pub fn used(&self) -> &[PathBuf] {
        &self.used
    }

    /// SHA-256 over every recorded file in order, hexadecimal.
    pub fn hash(self) -> String {
        let hash = self.hasher.finalize();
        hash.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_of_a_bounded_size_are_read() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let e = read_file(folder.path()).expect_err("a folder");
        assert_eq!(e.kind(), io::ErrorKind::IsADirectory);
        let large = folder.path().join("large");
        let file = fs::File::create(&large).expect("creates");
        // Sparse: takes no space.
        file.set_len(MAX_FILE_BYTES + 1).expect("grows");
        let e = read_file(&large).expect_err("too large");
        assert_eq!(e.kind(), io::ErrorKind::FileTooLarge);
        #[cfg(unix)]
        {
            let e = read_file(Path::new("/dev/zero")).expect_err("a device");
            assert!(e.to_string().contains("regular"), "{e}");
        }
    }

    /// The limit of a kind holds whatever the function is that reads.
    #[test]
    fn each_kind_has_a_limit() {
        let read = |_: &Path| Ok(vec![0; (64 << 20) + 1]);
        let files = Files::new(&read);
        let path = Path::new("s.toml");
        assert!(files.read(path, FileKind::Image).is_ok());
        let e = files.read(path, FileKind::Scene).expect_err("too large");
        assert!(e.to_string().contains("s.toml"), "{e}");
    }
}
