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
    /// The folder holds no dataset.
    #[error(
        "{}: no _peelnet/manifest.json and no manifest.json here: this is not a dataset, or its extraction was interrupted; run `peelnet extract` again",
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
        "{}: schema version {found}, but this program reads versions 1 to {}; write the dataset again with this version's `peelnet extract`",
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
    /// Parts are missing, or the seal alone.
    #[error("{}: {}", path.display(), unsealed(*missing, *of, *first))]
    Unsealed {
        /// The dataset.
        path: PathBuf,
        /// How many parts are missing.
        missing: usize,
        /// How many there should be.
        of: u32,
        /// The first missing one.
        first: Option<u32>,
    },
    /// A writer whose rows would not be the dataset's.
    #[error(
        "{}: the dataset there has another plan: {difference}; use the same command, version and adapter, or another folder",
        path.display()
    )]
    PlanDiffers {
        /// The dataset.
        path: PathBuf,
        /// What differs first, with both values and both workers.
        difference: String,
    },
    /// Two writers of one part with different bytes.
    #[error(
        "{}: part {index}: worker {worker} and worker {other} wrote different bytes for it, so one of the machines computes differently, or a file was changed; the part of {other} stays; extract all parts on machines of one kind",
        path.display()
    )]
    PartConflict {
        /// The dataset.
        path: PathBuf,
        /// The part.
        index: u32,
        /// The writer that came second.
        worker: String,
        /// The writer whose part stays.
        other: String,
    },
    /// A file of a part lies there with other contents, and no record says whose it is.
    #[error(
        "{}: part {index}: worker {worker} computed other bytes than this file has, and no record says whose it is; if no other extraction is running, remove the file and resume",
        path.display()
    )]
    PartInTheWay {
        /// The file.
        path: PathBuf,
        /// The part.
        index: u32,
        /// The writer.
        worker: String,
    },
    /// A part's record is not one of this dataset.
    #[error("{}: part {index}: {reason}; remove this record and finish the part with `peelnet extract --resume`", path.display())]
    Record {
        /// The record.
        path: PathBuf,
        /// The part.
        index: u32,
        /// What is wrong, with the worker where it is known.
        reason: String,
    },
    /// A file of a part is gone or was changed.
    #[error(
        "{}: part {index} of worker {worker}: the file {reason}; remove it and write it again with `peelnet extract --resume` and the same command",
        path.display()
    )]
    PartDamaged {
        /// The file.
        path: PathBuf,
        /// The part.
        index: u32,
        /// Who wrote it.
        worker: String,
        /// What is wrong.
        reason: String,
    },
    /// A file of rows that is no part's.
    #[error(
        "{}: no part of the dataset has this file, and readers of the whole folder would read its rows as well; move it away",
        path.display()
    )]
    Doubled {
        /// The file.
        path: PathBuf,
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
        "{}: the folder is not empty, and {found:?} in it is not a file of a dataset as its manifest lists it; choose another folder, or move that file away",
        path.display()
    )]
    NotOurs {
        /// The folder.
        path: PathBuf,
        /// A file or folder in it.
        found: String,
        /// Why a manifest is not one.
        source: Option<Box<DatasetError>>,
    },
    /// More parts than a dataset can have.
    #[error(
        "{items} work items (scenes × copies × views) are too many: at most {}",
        crate::MAX_WORK_ITEMS
    )]
    TooManyItems {
        /// How many there would be.
        items: u64,
    },
    /// A pixel that does not fit into memory.
    #[error("{}: pixel ({x}, {y}) has more than {most} fragments; leave it out, or write the dataset again", path.display())]
    LargePixel {
        /// The part's first file.
        path: PathBuf,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// The limit.
        most: usize,
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
    #[error("{}: {} of {of} shards are missing ({}); extract these as well", path.display(), missing.len(), list(missing))]
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
        "shard {text:?}: expected I/N with whole numbers N from 1 to {} and I from 1 to N, for example 2/4",
        crate::MAX_WORK_ITEMS
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

/// The first few of some names.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 10;
    let more = if names.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
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

    /// Whether the error is of this file.
    pub(crate) fn is_at(&self, file: &Path) -> bool {
        match self {
            Self::Io { path, .. }
            | Self::Changed { path, .. }
            | Self::Format { path, .. }
            | Self::Value { path, .. } => path == file,
            _ => false,
        }
    }

    /// The same error of a file of another name: that of which the first is a copy.
    pub(crate) fn moved_to(mut self, file: &Path) -> Self {
        if let Self::Io { path, .. }
        | Self::Changed { path, .. }
        | Self::Format { path, .. }
        | Self::Value { path, .. } = &mut self
        {
            file.clone_into(path);
        }
        self
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
