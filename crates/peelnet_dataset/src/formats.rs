//! What a dataset format must do; each format is one file of this folder.

mod csv;
mod npy;
mod parquet;

use std::path::{Path, PathBuf};

use crate::batch::FragmentBatch;
use crate::column::Column;
use crate::error::DatasetError;
use crate::format::Format;
use crate::manifest::FileEntry;

impl Format {
    /// Starts a part of which the files' names begin with `stem`.
    pub(crate) fn sink(
        self,
        folder: &Path,
        stem: &str,
        threads: usize,
    ) -> Result<Box<dyn PartSink>, DatasetError> {
        Ok(match self {
            Self::Csv => Box::new(csv::CsvSink::create(folder, stem, threads)?),
            Self::Parquet => Box::new(parquet::ParquetSink::create(folder, stem, threads)?),
            Self::Npy => Box::new(npy::NpySink::create(folder, stem, threads)?),
        })
    }

    /// Opens a part for reading the given columns, in the columns' order.
    pub(crate) fn source(
        self,
        files: &[PathBuf],
        columns: &[Column],
    ) -> Result<Box<dyn PartSource>, DatasetError> {
        Ok(match self {
            Self::Csv => Box::new(csv::CsvSource::open(files, columns)?),
            Self::Parquet => Box::new(parquet::ParquetSource::open(files, columns)?),
            Self::Npy => Box::new(npy::NpySource::open(files, columns)?),
        })
    }
}

/// Writes one part's rows. What has been given must not depend on the cuts between calls.
pub(crate) trait PartSink: Send {
    /// Appends rows, which are valid and of equal length.
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError>;

    /// Ends the files: rows of each row group, and the files in order.
    fn finish(self: Box<Self>) -> Result<(Vec<u64>, Vec<FileEntry>), DatasetError>;
}

/// Reads one part's rows.
pub(crate) trait PartSource: Send {
    /// Appends up to `max` rows to the asked columns of `rows` and says how many; 0 at the end.
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError>;
}

/// Cuts `0..len` into at most `threads` ranges of nearly equal length.
fn split_range(len: usize, threads: usize) -> Vec<std::ops::Range<usize>> {
    let pieces = threads.clamp(1, len.max(1));
    (0..pieces)
        .map(|k| len * k / pieces..len * (k + 1) / pieces)
        .collect()
}
