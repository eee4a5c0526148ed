//! Files appear whole or not at all.

use crate::EvalError;
use std::path::Path;

/// Writes a file whole, creating its folder if need be.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), EvalError> {
    peelnet_files::write_whole(path, bytes).map_err(EvalError::io(path, "write"))
}
