//! Files appear whole or not at all.

use crate::EvalError;
use std::io::Write as _;
use std::path::Path;

/// Writes a file under a temporary name in the same folder, then renames it. The folder is created if need be.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), EvalError> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a result has the permissions of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder
        .tempfile_in(folder)
        .map_err(EvalError::io(path, "write"))?;
    file.write_all(bytes)
        .map_err(EvalError::io(path, "write"))?;
    file.persist(path)
        .map_err(|e| EvalError::io(path, "write")(e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    #[test]
    fn replaces_whole_files_and_leaves_no_other() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a/b.txt");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(dir.path().join("a")).unwrap().count(), 1);
    }

    #[test]
    fn an_unwritable_folder_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        std::fs::write(&file, b"x").unwrap();
        let message = write_atomically(&file.join("b.txt"), b"one")
            .unwrap_err()
            .to_string();
        assert!(message.contains("file"), "{message}");
    }
}
