//! Everything that can go wrong with a dataset, each with the file, the place and the fix.

use std::io;
use std::path::{Path, PathBuf};

use crate::column::Column;

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
    #[error(
        "{}: no _peelnet/manifest.json here: this is not a dataset, or its extraction was interrupted; run `peelnet extract` again",
        path.display()
    )]
    NoManifest { path: PathBuf },
    /// A manifest or a plan that cannot be understood.
    #[error("{}: {reason}; write the dataset again with `peelnet extract`", path.display())]
    Manifest { path: PathBuf, reason: String },
    #[error(
        "{}: schema version {found}, but this program reads version {}; write the dataset again with this version's `peelnet extract`",
        path.display(),
        crate::SCHEMA_VERSION
    )]
    Schema { path: PathBuf, found: u64 },
    /// A file is not what the manifest says.
    #[error("{}: {reason}; the file was cut or changed after it was written, so write the dataset again", path.display())]
    Changed { path: PathBuf, reason: String },
    /// A file's contents cannot be decoded, or its columns are not the dataset's.
    #[error("{}: {reason}", path.display())]
    Format { path: PathBuf, reason: String },
    /// Parts are missing, or the seal alone.
    #[error("{}: {}", path.display(), unsealed(*missing, *of, *first))]
    Unsealed {
        path: PathBuf,
        missing: usize,
        of: u32,
        first: Option<u32>,
    },
    /// A writer whose rows would not be the dataset's.
    #[error(
        "{}: the dataset there has another plan: {difference}; use the same command, version and adapter, or another folder",
        path.display()
    )]
    PlanDiffers { path: PathBuf, difference: String },
    /// Two writers of one part with different bytes: `worker` came second.
    #[error(
        "{}: part {index}: worker {worker} and worker {other} wrote different bytes for it, so one of the machines computes differently, or a file was changed; the part of {other} stays; extract all parts on machines of one kind",
        path.display()
    )]
    PartConflict {
        path: PathBuf,
        index: u32,
        worker: String,
        other: String,
    },
    /// A file of a part with other contents than `worker` computed, which no record lists.
    #[error(
        "{}: part {index}: worker {worker} computed other bytes than this file has, and no record says whose it is; if no other extraction is running, remove the file and resume",
        path.display()
    )]
    PartInTheWay {
        path: PathBuf,
        index: u32,
        worker: String,
    },
    /// A part's record is not one of this dataset.
    #[error("{}: part {index}: {reason}; remove this record and finish the part with `peelnet extract --resume`", path.display())]
    Record {
        path: PathBuf,
        index: u32,
        reason: String,
    },
    /// A file of a part is gone or was changed.
    #[error(
        "{}: part {index} of worker {worker}: the file {reason}; remove it and write it again with `peelnet extract --resume` and the same command",
        path.display()
    )]
    PartDamaged {
        path: PathBuf,
        index: u32,
        worker: String,
        reason: String,
    },
    /// A file of rows that is no part's.
    #[error(
        "{}: no part of the dataset has this file, and readers of the whole folder would read its rows as well; move it away",
        path.display()
    )]
    Doubled { path: PathBuf },
    /// A value outside its column's range. Rows of a part count from 1, without a CSV header.
    #[error(
        "{}: row {row}, column {column}: {value} is not allowed, {allowed}; fix or remove the whole pixel, or write the dataset again",
        path.display()
    )]
    Value {
        path: PathBuf,
        row: u64,
        column: Column,
        value: String,
        allowed: &'static str,
    },
    #[error("column {column} has {found} values where the others have {rows}")]
    Ragged {
        column: Column,
        found: usize,
        rows: usize,
    },
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
    /// A pixel that does not fit into memory.
    #[error("{}: pixel ({x}, {y}) has more than {most} fragments; leave it out, or write the dataset again", path.display())]
    LargePixel {
        path: PathBuf,
        x: u32,
        y: u32,
        most: usize,
    },
    #[error("{}: another extraction is writing into this folder; wait for it or choose another folder", path.display())]
    Busy { path: PathBuf },
    #[error(
        "shard {text:?}: expected I/N with whole numbers N from 1 to {} and I from 1 to N, for example 2/4",
        crate::MAX_WORK_ITEMS
    )]
    Shard { text: String },
    #[error("dataset format {text:?}: expected csv, parquet or npy")]
    UnknownFormat { text: String },
    #[error(
        "split {validation} for validation and {test} for testing: both must be 0 or more, and together at most 1"
    )]
    Split { validation: f64, test: f64 },
    /// The writer was used in a way that would not give a dataset, or an address is none.
    #[error("{}: {reason}", path.display())]
    Usage { path: PathBuf, reason: String },
}

fn unsealed(missing: usize, of: u32, first: Option<u32>) -> String {
    match first {
        Some(first) => format!(
            "{missing} of {of} parts are missing, the first is {first}; write them with `peelnet extract --resume` and the same command, or with the shards that did not run, then seal the dataset with `peelnet seal`"
        ),
        None => format!(
            "all {of} parts are there, but the dataset is not sealed; run `peelnet seal` on it"
        ),
    }
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

    pub(crate) fn manifest(path: &Path, reason: impl Into<String>) -> Self {
        Self::Manifest {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    pub(crate) fn usage(path: &Path, reason: impl Into<String>) -> Self {
        Self::Usage {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }
}
