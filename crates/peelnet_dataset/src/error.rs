//! Everything that can go wrong with a dataset, each with the file, the place and the fix.

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
    /// The output folder holds something else; the source says why a manifest is not one.
    #[error(
        "{}: the folder is not empty, and {found:?} in it is not a file of a dataset as its manifest lists it; choose another folder, or move that file away",
        path.display()
    )]
    NotOurs {
        path: PathBuf,
        found: String,
        source: Option<Box<DatasetError>>,
    },
    #[error(
        "{items} work items (scenes × copies × views) are too many: at most {}",
        crate::MAX_WORK_ITEMS
    )]
    TooManyItems { items: u64 },
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

    /// A manifest or a plan that cannot be understood.
    pub(crate) fn manifest(path: &Path, reason: impl AsRef<str>) -> Self {
        let reason = reason.as_ref();
        let fix = "write the dataset again with `peelnet extract`";
        Self::invalid(path, format!("{reason}; {fix}"))
    }

    /// A file is not what the manifest says.
    pub(crate) fn changed(path: &Path, reason: impl AsRef<str>) -> Self {
        let reason = reason.as_ref();
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
