//! Whole files or none.

use std::io::Write as _;
use std::path::Path;

use crate::error::TrainError;

/// Writes `bytes` to a temporary name in the same folder and renames it.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    let io = |error| TrainError::Io {
        path: path.to_owned(),
        error,
    };
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(io)?;
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a loss curve is not more secret than any other output.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder
        .prefix(".peelnet-train-")
        .tempfile_in(folder)
        .map_err(io)?;
    file.write_all(bytes).map_err(io)?;
    file.persist(path).map_err(|e| io(e.error))?;
    Ok(())
}
