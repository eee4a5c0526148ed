//! Whole files or none, and the names of a run's files.

use std::path::{Path, PathBuf};

use crate::error::TrainError;

/// Writes `bytes` whole, or an error with the file's name.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    peelnet_files::write_whole(path, bytes).map_err(|error| TrainError::Io {
        path: path.to_owned(),
        error,
    })
}

/// `<out>.<ending>`. The ending is appended: `exp-0.5` and `exp-0.7` must not share a name.
pub(crate) fn beside(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    name.into()
}
