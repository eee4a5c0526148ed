//! Hashes of files.

use std::io::{self, Read as _};
use std::path::Path;

use peelnet_core::files::hex;
use sha2::{Digest, Sha256};

/// Hexadecimal sha256 of some bytes.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Length and hexadecimal sha256 of an existing file.
pub(crate) fn hash_file(path: &Path) -> io::Result<(u64, String)> {
    let mut file = peelnet_core::files::open(path)?;
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
