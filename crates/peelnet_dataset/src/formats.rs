//! The formats that a dataset may have; each is one file of this folder.

mod csv;
mod npy;
mod parquet;

use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::column::{Column, FragmentBatch};
use crate::error::DatasetError;
use crate::store::Fetched;

pub use parquet::ROW_GROUP_ROWS;

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

    /// Bytes that a row takes at least in each file of a part; 0 where rows are compressed.
    pub(crate) const fn least_row_bytes(self) -> u64 {
        match self {
            // A digit and a separator for each column.
            Self::Csv => 2 * Column::ALL.len() as u64,
            Self::Parquet => 0,
            Self::Npy => 4,
        }
    }

    /// The files of a part that columns lie in, in the columns' order.
    pub(crate) fn files_of(self, columns: &[Column]) -> Vec<usize> {
        match self {
            Self::Csv | Self::Parquet => vec![0],
            Self::Npy => columns.iter().map(|&c| c as usize).collect(),
        }
    }

    pub(crate) fn files_of_a_part(self) -> usize {
        self.files_of(&Column::ALL).len()
    }

    pub(crate) fn file_names(self, stem: &str) -> Vec<String> {
        match self {
            Self::Csv | Self::Parquet => vec![format!("{stem}.{self}")],
            Self::Npy => Column::ALL.map(|c| format!("{stem}.{c}.{self}")).to_vec(),
        }
    }

    /// Rows of each row group of a part.
    pub(crate) fn row_groups(self, rows: u64) -> Vec<u64> {
        match self {
            Self::Csv | Self::Npy => vec![rows],
            Self::Parquet => {
                let starts = (0..rows).step_by(ROW_GROUP_ROWS);
                let groups = starts.map(|start| (rows - start).min(ROW_GROUP_ROWS as u64));
                groups.collect()
            }
        }
    }

    /// Starts a part in these files, which do not exist.
    pub(crate) fn sink(self, files: Vec<PathBuf>) -> Result<Box<dyn PartSink>, DatasetError> {
        let create = |path: PathBuf| match File::create_new(&path) {
            Ok(file) => Ok((path, file)),
            Err(e) => Err(DatasetError::io(&path, "create")(e)),
        };
        let files = files.into_iter().map(create);
        let mut files = files.collect::<Result<Vec<_>, _>>()?;
        Ok(match self {
            Self::Csv => Box::new(csv::CsvSink::new(files.remove(0))?),
            Self::Parquet => Box::new(parquet::ParquetSink::new(files.remove(0))?),
            Self::Npy => Box::new(npy::NpySink::new(files)?),
        })
    }

    /// Bytes of the files of a part that has these rows alone. They are written into a temporary folder.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn bytes_of(self, rows: &FragmentBatch) -> Result<u64, DatasetError> {
        let folder = tempfile::tempdir();
        let folder = folder.map_err(DatasetError::io(&std::env::temp_dir(), "write into"))?;
        let files = self.file_names("part").into_iter();
        let files: Vec<PathBuf> = files.map(|name| folder.path().join(name)).collect();
        let mut sink = self.sink(files.clone())?;
        sink.write(rows)?;
        sink.finish(rows.len() as u64)?;
        files.iter().try_fold(0, |sum, file| {
            let found = file.metadata().map_err(DatasetError::io(file, "look at"))?;
            Ok(sum + found.len())
        })
    }

    /// Opens a part of so many rows for reading the given columns, from [`Format::files_of`] them.
    pub(crate) fn source(
        self,
        files: &[Fetched],
        columns: &[Column],
        rows: u64,
    ) -> Result<Box<dyn PartSource>, DatasetError> {
        Ok(match self {
            Self::Csv => Box::new(csv::CsvSource::open(&files[0], columns)?),
            Self::Parquet => Box::new(parquet::ParquetSource::open(&files[0], columns)?),
            Self::Npy => Box::new(npy::NpySource::open(files, columns, rows)?),
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
        let found = Self::ALL.into_iter().find(|f| f.name() == text);
        found.ok_or_else(|| {
            DatasetError::Setting(format!(
                "dataset format {text:?}: expected csv, parquet or npy"
            ))
        })
    }
}

/// Writes one part's rows. What has been given must not depend on the cuts between calls.
pub(crate) trait PartSink: Send {
    /// Appends rows, which are valid and of equal length.
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError>;

    /// Ends the files, which have so many rows.
    fn finish(self: Box<Self>, rows: u64) -> Result<(), DatasetError>;
}

/// Reads one part's rows.
pub(crate) trait PartSource: Send {
    /// Appends up to `max` rows to the chosen columns of `rows` and says how many; 0 at the end.
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError>;
}

/// Compares a file's column names with the schema's.
fn check_names(path: &Path, place: &str, found: &[String]) -> Result<(), DatasetError> {
    let expected = Column::ALL.map(Column::name);
    let missing = expected.iter().find(|c| !found.iter().any(|n| n == *c));
    let wanted = |k: usize| expected.get(k).copied().unwrap_or("no column");
    let problem = if let Some(missing) = missing {
        format!("column {missing} is missing")
    } else if let Some(k) = (0..found.len()).find(|&k| found[k] != wanted(k)) {
        let (number, name, wanted) = (k + 1, &found[k], wanted(k));
        format!("column {number} is {name:?} where {wanted} is expected")
    } else {
        return Ok(());
    };
    let expected = expected.join(", ");
    let reason = format!("{place}: {problem}; the columns must be {expected}, in this order");
    Err(DatasetError::invalid(path, reason))
}
