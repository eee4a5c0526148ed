//! What a dataset format must do; each format is one file of this folder.

mod csv;
mod npy;
mod parquet;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::batch::FragmentBatch;
use crate::column::Column;
use crate::error::DatasetError;
use crate::manifest::FileEntry;

/// The file format of a dataset's parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Text with a header row; numbers as the shortest text that reads back to the same value.
    Csv,
    /// Apache Parquet, snappy, row groups of 2²⁰ rows. Small, fast, and read by column.
    #[default]
    Parquet,
    /// One one-dimensional NumPy array for each column.
    Npy,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Parquet, Self::Npy];

    /// The name, which is also the files' ending.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Npy => "npy",
        }
    }

    /// How many files a part has.
    pub(crate) const fn files_of_a_part(self) -> usize {
        match self {
            Self::Csv | Self::Parquet => 1,
            Self::Npy => Column::ALL.len(),
        }
    }

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

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Format {
    type Err = DatasetError;

    fn from_str(text: &str) -> Result<Self, DatasetError> {
        Self::ALL
            .into_iter()
            .find(|f| f.name() == text)
            .ok_or_else(|| DatasetError::UnknownFormat {
                text: text.to_owned(),
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
