//! Everything that can go wrong with a dataset, each with the file, the place and the fix.

use std::io;
use std::path::{Path, PathBuf};

use crate::column::Column;

/// An error of reading or writing a dataset.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// The folder holds no manifest.
    #[error(
        "{}: no manifest.json here: this is not a dataset, or its extraction was interrupted; run `peelnet extract` again",
        path.display()
    )]
    NoManifest {
        /// The folder.
        path: PathBuf,
    },
    /// The manifest cannot be understood.
    #[error("{}: {reason}; write the dataset again with `peelnet extract`", path.display())]
    Manifest {
        /// The manifest's file.
        path: PathBuf,
        /// What is wrong, with field or line.
        reason: String,
    },
    /// Another schema version.
    #[error(
        "{}: schema version {found}, but this program reads version {}; write the dataset again with this version's `peelnet extract`",
        path.display(),
        crate::SCHEMA_VERSION
    )]
    Schema {
        /// The manifest's file.
        path: PathBuf,
        /// The version found.
        found: u64,
    },
    /// A file is not what the manifest says.
    #[error("{}: {reason}; the file was cut or changed after it was written, so write the dataset again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// What differs.
        reason: String,
    },
    /// A file's contents cannot be decoded, or its columns are not the dataset's.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong and what was expected.
        reason: String,
    },
    /// A value outside its column's range.
    #[error(
        "{}: row {row}, column {column}: {value} is not allowed, {allowed}; fix or remove the whole pixel, or write the dataset again",
        path.display()
    )]
    Value {
        /// The file, or the part that was being written.
        path: PathBuf,
        /// Row in the part, counted from 1; a CSV header is not counted.
        row: u64,
        /// The column.
        column: Column,
        /// The value as text.
        value: String,
        /// The range that is allowed.
        allowed: &'static str,
    },
    /// Columns of different lengths.
    #[error("column {column} has {found} values where the others have {rows}")]
    Ragged {
        /// The first column that differs.
        column: Column,
        /// Its length.
        found: usize,
        /// The length of the first column.
        rows: usize,
    },
    /// The output folder holds something else.
    #[error(
        "{}: the folder is not empty and not a dataset (it holds {found:?}); choose another folder or empty this one",
        path.display()
    )]
    NotOurs {
        /// The folder.
        path: PathBuf,
        /// A file or folder in it.
        found: String,
    },
    /// A whole dataset and shards would mix.
    #[error("{}: {reason}; choose another folder or delete this one", path.display())]
    Mixed {
        /// The folder.
        path: PathBuf,
        /// What the folder holds already.
        reason: &'static str,
    },
    /// Another process is writing here.
    #[error("{}: another extraction is writing into this folder; wait for it or choose another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// Some shards have not been written.
    #[error("{}: {} of {of} shards are missing ({}); extract these as well", path.display(), missing.len(), missing.join(", "))]
    MissingShards {
        /// The folder that holds the shards.
        path: PathBuf,
        /// The missing ones as `I/N`.
        missing: Vec<String>,
        /// How many there should be.
        of: u32,
    },
    /// Shards of different runs.
    #[error("{}: the shard's {field} differs from that of {}; write all shards with the same command", path.display(), other.display())]
    ShardsDiffer {
        /// A shard.
        path: PathBuf,
        /// Another shard.
        other: PathBuf,
        /// What differs.
        field: &'static str,
    },
    /// A shard that is not one.
    #[error(
        "shard {text:?}: expected I/N with whole numbers N ≥ 1 and I from 1 to N, for example 2/4"
    )]
    Shard {
        /// What was given.
        text: String,
    },
    /// A format that does not exist.
    #[error("dataset format {text:?}: expected csv, parquet or npy")]
    UnknownFormat {
        /// What was given.
        text: String,
    },
    /// Fractions that do not make a split.
    #[error(
        "split {validation} for validation and {test} for testing: both must be 0 or more, and together at most 1"
    )]
    Split {
        /// The validation fraction.
        validation: f64,
        /// The test fraction.
        test: f64,
    },
    /// The writer was used in a way that would not give a dataset.
    #[error("{}: {reason}", path.display())]
    Usage {
        /// The dataset's folder.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
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

    pub(crate) fn format(path: &Path, reason: impl Into<String>) -> Self {
        Self::Format {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    pub(crate) fn changed(path: &Path, reason: impl Into<String>) -> Self {
        Self::Changed {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }
}
