//! A file that knows its length and sha256 when it is done.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use peelnet_files::hex;
use sha2::{Digest, Sha256};

/// Writes to a file and hashes the bytes on the way. Give it large slices: it does not buffer.
pub(crate) struct HashedFile {
    file: File,
    hasher: Sha256,
    bytes: u64,
}

impl HashedFile {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        Ok(Self {
            file: File::create_new(path)?,
            hasher: Sha256::new(),
            bytes: 0,
        })
    }

    /// Length and hexadecimal hash of everything written.
    pub(crate) fn finish(self) -> (u64, String) {
        (self.bytes, hex(&self.hasher.finalize()))
    }
}

impl Write for HashedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.hasher.update(&bytes[..n]);
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Hexadecimal sha256 of some bytes.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Length and hexadecimal sha256 of an existing file.
pub(crate) fn hash_file(path: &Path) -> io::Result<(u64, String)> {
    let mut file = peelnet_files::open(path)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 18];
    let mut bytes = 0;
    loop {
        let n = file.read(&mut buffer)?;
        if n == 0 {
            return Ok((bytes, hex(&hasher.finalize())));
        }
        hasher.update(&buffer[..n]);
        bytes += n as u64;
    }
}
