//! The fourteen columns: names, order and types, in one table. Everything else in the crate asks this list.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::DatasetError;

/// The type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColumnKind {
    /// 32-bit float.
    F32,
    /// 32-bit unsigned integer.
    U32,
}

/// Makes [`Column`] and [`FragmentBatch`] of rows of documentation, variant, name and type.
macro_rules! columns {
    ($($(#[doc = $doc:literal])+ $variant:ident $name:ident $kind:ident $type:ty,)+) => {
        /// A column of the dataset. The discriminants are the order in every format.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Column {
            $($(#[doc = $doc])+ $variant,)+
        }

        /// Some rows of the dataset as fourteen vectors of equal length.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct FragmentBatch {
            $($(#[doc = $doc])+ pub $name: Vec<$type>,)+
        }

        impl Column {
            /// All columns in the order of the files.
            pub const ALL: [Self; 14] = [$(Self::$variant,)+];

            /// The name in headers and file names.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($name),)+
                }
            }

            /// The type of the values.
            pub const fn kind(self) -> ColumnKind {
                match self {
                    $(Self::$variant => ColumnKind::$kind,)+
                }
            }
        }

        impl FragmentBatch {
            /// The values of a column.
            pub fn column(&self, column: Column) -> ColumnSlice<'_> {
                match column {
                    $(Column::$variant => ColumnSlice::$kind(&self.$name),)+
                }
            }

            pub(crate) fn column_mut(&mut self, column: Column) -> ColumnMut<'_> {
                match column {
                    $(Column::$variant => ColumnMut::$kind(&mut self.$name),)+
                }
            }

            /// An empty batch with room for `rows` rows.
            pub fn with_capacity(rows: usize) -> Self {
                Self {
                    $($name: Vec::with_capacity(rows),)+
                }
            }

            /// Appends some rows of another batch.
            ///
            /// # Panics
            /// If the range is out of bounds.
            pub fn extend_from(&mut self, other: &Self, rows: Range<usize>) {
                $(self.$name.extend_from_slice(&other.$name[rows.clone()]);)+
            }

            /// Appends all values of another batch, of which columns may be empty.
            pub(crate) fn append(&mut self, other: &Self) {
                $(self.$name.extend_from_slice(&other.$name);)+
            }

            /// Drops all rows from `rows` on.
            pub fn truncate(&mut self, rows: usize) {
                $(self.$name.truncate(rows);)+
            }

            /// Checks that all columns have the same length.
            ///
            /// # Errors
            /// Names the first column that differs.
            pub fn check(&self) -> Result<(), DatasetError> {
                let rows = self.len();
                let columns = [$((Column::$variant, self.$name.len()),)+];
                match columns.into_iter().find(|(_, found)| *found != rows) {
                    None => Ok(()),
                    Some((column, found)) => Err(DatasetError::Setting(format!(
                        "column {column} has {found} values where the others have {rows}"
                    ))),
                }
            }
        }
    };
}

columns! {
    /// 1 − α_i of the fragment itself, 0 … 1.
    OneMinusAlpha one_minus_alpha F32 f32,
    /// z_i, distance along the view axis in scene units, positive.
    LinearDepth linear_depth F32 f32,
    /// Σ α over the pixel.
    AlphaSum alpha_sum F32 f32,
    /// n, the number of fragments of the pixel.
    FragmentCount fragment_count U32 u32,
    /// T_i = ∏_{j<i}(1 − α_j), 0 … 1: the target of training.
    Transmittance transmittance F32 f32,
    /// Index of the work item (scene × copy × view) in the whole dataset.
    View view U32 u32,
    /// Pixel column, 0 at the left.
    X x U32 u32,
    /// Pixel row, 0 at the top.
    Y y U32 u32,
    /// Rank of the fragment from the front, 0 for the nearest.
    Layer layer U32 u32,
    /// Red radiance, un-premultiplied, linear.
    R r F32 f32,
    /// Green radiance, un-premultiplied, linear.
    G g F32 f32,
    /// Blue radiance, un-premultiplied, linear.
    B b F32 f32,
    /// Near clip distance of the view, scene units.
    Near near F32 f32,
    /// Far clip distance of the view, scene units.
    Far far F32 f32,
}

impl Column {
    /// Position in [`Column::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The column of a name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// Least and greatest value that a float column may have, and the rule in words.
    pub(crate) const fn float_range(self) -> (f32, f32, &'static str) {
        match self {
            Self::OneMinusAlpha | Self::Transmittance => {
                (0.0, 1.0, "it must be a number from 0 to 1")
            }
            Self::LinearDepth | Self::Near | Self::Far => {
                let least = f32::from_bits(1);
                (least, f32::MAX, "it must be a finite number above 0")
            }
            Self::AlphaSum => (0.0, f32::MAX, "it must be a finite number not below 0"),
            _ => (f32::MIN, f32::MAX, "it must be a finite number"),
        }
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The values of one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColumnSlice<'a> {
    /// Values of a float column.
    F32(&'a [f32]),
    /// Values of an integer column.
    U32(&'a [u32]),
}

pub(crate) enum ColumnMut<'a> {
    F32(&'a mut Vec<f32>),
    U32(&'a mut Vec<u32>),
}

impl FragmentBatch {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.one_minus_alpha.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    pub(crate) fn same_pixel(&self, a: usize, b: usize) -> bool {
        self.x[a] == self.x[b] && self.y[a] == self.y[b] && self.view[a] == self.view[b]
    }

    /// The rows of each pixel, in order.
    pub fn pixels(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut start = 0;
        std::iter::from_fn(move || {
            let mut behind = start + 1..self.len();
            let end = behind.find(|&i| !self.same_pixel(start, i));
            let pixel = start..end.unwrap_or(self.len());
            start = pixel.end;
            (!pixel.is_empty()).then_some(pixel)
        })
    }

    /// Finds the first value of a column, from row `start` on, that is not allowed. `first_row` is the number of that row in its part,
    /// counted from 0; `view` is the part's index, which the `view` column must repeat. `path` is named in the error.
    pub(crate) fn check_column(
        &self,
        path: &Path,
        column: Column,
        start: usize,
        first_row: u64,
        view: u32,
    ) -> Result<(), DatasetError> {
        let (bad, allowed) = match (self.column(column), column) {
            (ColumnSlice::F32(values), _) => {
                let (least, most, allowed) = column.float_range();
                let good = |v| v >= least && v <= most;
                (first_bad(&values[start..], good), allowed)
            }
            (ColumnSlice::U32(values), Column::View) => {
                let allowed = "it must be the index of the part";
                (first_bad(&values[start..], |v| v == view), allowed)
            }
            (ColumnSlice::U32(values), Column::FragmentCount) => {
                let allowed = "it must be at least 1";
                (first_bad(&values[start..], |v| v > 0), allowed)
            }
            (ColumnSlice::U32(_), _) => return Ok(()),
        };
        let Some((i, value)) = bad else { return Ok(()) };
        let row = first_row + i as u64 + 1;
        let reason = format!(
            "row {row}, column {column}: {value} is not allowed, {allowed}; fix or remove the whole pixel, or write the dataset again"
        );
        Err(DatasetError::invalid(path, reason))
    }
}

/// The place and the text of the first value that is not good.
fn first_bad<T: Copy + fmt::Display>(
    values: &[T],
    good: impl Fn(T) -> bool,
) -> Option<(usize, String)> {
    // Without leaving early, so that it becomes vector instructions; only a failure searches.
    if values.iter().fold(true, |all, &v| all & good(v)) {
        return None;
    }
    let i = values.iter().position(|&v| !good(v))?;
    Some((i, values[i].to_string()))
}
