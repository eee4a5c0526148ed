//! Whole files or none.

use std::path::Path;

use crate::error::TrainError;

/// Writes `bytes` whole, or an error with the file's name.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    peelnet_files::write_whole(path, bytes).map_err(|error| TrainError::Io {
        path: path.to_owned(),
        error,
    })
}
