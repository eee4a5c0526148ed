//! The formats that a dataset may have.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::column::Column;
use crate::error::DatasetError;

/// Rows of a full row group of Parquet.
pub const ROW_GROUP_ROWS: usize = 1 << 20;

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

    /// How many files a part has.
    pub(crate) const fn files_of_a_part(self) -> usize {
        match self {
            Self::Csv | Self::Parquet => 1,
            Self::Npy => Column::ALL.len(),
        }
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
