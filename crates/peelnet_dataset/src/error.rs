//! Everything that can go wrong with a dataset, each with the file, the place and the fix.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

/// An error of reading or writing a dataset. `path` is the dataset or the file in it.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say what the fields are")]
pub enum DatasetError {
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        path: PathBuf,
        action: &'static str,
        source: io::Error,
    },
    /// A dataset, a file of one or an address that is not as it should be, or not what the caller may change. The reason ends with the fix.
    #[error("{}: {reason}", path.display())]
    Invalid { path: PathBuf, reason: String },
    /// An argument that is none, whatever the dataset.
    #[error("{0}")]
    Setting(String),
}

impl DatasetError {
    /// Wraps an input/output error with its place: for `map_err`.
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io {
            path,
            action,
            source,
        }
    }

    pub(crate) fn invalid(path: &Path, reason: impl Into<String>) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    /// A file is not what the manifest says.
    pub(crate) fn changed(path: &Path, reason: impl Display) -> Self {
        let fix = "the file was cut or changed after it was written, so write the dataset again";
        Self::invalid(path, format!("{reason}; {fix}"))
    }

    /// Another writer is in the folder, or takes things away.
    pub(crate) fn busy(path: &Path) -> Self {
        let reason =
            "another extraction is writing into this folder; wait for it or choose another folder";
        Self::invalid(path, reason)
    }
}
