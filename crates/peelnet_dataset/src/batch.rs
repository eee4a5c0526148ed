//! A run of rows, column by column.

use std::ops::Range;
use std::path::Path;

use crate::column::{Column, ColumnMut, ColumnSlice, FragmentBatch};
use crate::error::DatasetError;

impl FragmentBatch {
    /// An empty batch with room for `rows` rows.
    pub fn with_capacity(rows: usize) -> Self {
        let mut batch = Self::default();
        for column in Column::ALL {
            match batch.column_mut(column) {
                ColumnMut::F32(v) => v.reserve_exact(rows),
                ColumnMut::U32(v) => v.reserve_exact(rows),
            }
        }
        batch
    }

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

    /// Appends some rows of another batch.
    ///
    /// # Panics
    /// If the range is out of bounds.
    pub fn extend_from(&mut self, other: &Self, rows: Range<usize>) {
        for column in Column::ALL {
            match (self.column_mut(column), other.column(column)) {
                (ColumnMut::F32(to), ColumnSlice::F32(from)) => {
                    to.extend_from_slice(&from[rows.clone()]);
                }
                (ColumnMut::U32(to), ColumnSlice::U32(from)) => {
                    to.extend_from_slice(&from[rows.clone()]);
                }
                _ => unreachable!("a column has one type"),
            }
        }
    }

    /// Drops all rows from `rows` on.
    pub fn truncate(&mut self, rows: usize) {
        for column in Column::ALL {
            match self.column_mut(column) {
                ColumnMut::F32(v) => v.truncate(rows),
                ColumnMut::U32(v) => v.truncate(rows),
            }
        }
    }

    /// Whether row `a` and row `b` belong to the same pixel.
    pub fn same_pixel(&self, a: usize, b: usize) -> bool {
        self.x[a] == self.x[b] && self.y[a] == self.y[b] && self.view[a] == self.view[b]
    }

    /// The rows of each pixel, in order.
    pub fn pixels(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut start = 0;
        std::iter::from_fn(move || {
            if start >= self.len() {
                return None;
            }
            let mut end = start + 1;
            while end < self.len() && self.same_pixel(start, end) {
                end += 1;
            }
            let pixel = start..end;
            start = end;
            Some(pixel)
        })
    }

    /// Checks that all columns have the same length.
    ///
    /// # Errors
    /// [`DatasetError::Ragged`] names the first column that differs.
    pub fn check(&self) -> Result<(), DatasetError> {
        let rows = self.len();
        for column in Column::ALL {
            let found = self.column(column).len();
            if found != rows {
                return Err(DatasetError::Ragged {
                    column,
                    found,
                    rows,
                });
            }
        }
        Ok(())
    }
}

/// Finds the first value of a column that is not allowed. `first_row` is the number of the first value's row in its
/// part, counted from 0; `view` is the part's index, which the `view` column must repeat.
pub(crate) fn check_column(
    path: &Path,
    column: Column,
    values: ColumnSlice<'_>,
    first_row: u64,
    view: u32,
) -> Result<(), DatasetError> {
    let (bad, allowed) = match (values, column) {
        (ColumnSlice::F32(values), _) => {
            let (least, most, allowed) = column.float_range();
            let good = |v: f32| v >= least && v <= most;
            // Without leaving early, so that it becomes vector instructions; only a failure searches.
            let all_good = values.iter().fold(true, |all, &v| all & good(v));
            let bad = || values.iter().position(|&v| !good(v));
            (if all_good { None } else { bad() }, allowed)
        }
        (ColumnSlice::U32(values), Column::View) => (
            values.iter().position(|&v| v != view),
            "it must be the index of the part",
        ),
        (ColumnSlice::U32(values), Column::FragmentCount) => {
            (values.iter().position(|&v| v == 0), "it must be at least 1")
        }
        (ColumnSlice::U32(_), _) => return Ok(()),
    };
    let Some(i) = bad else { return Ok(()) };
    Err(DatasetError::Value {
        path: path.to_owned(),
        row: first_row + i as u64 + 1,
        column,
        value: match values {
            ColumnSlice::F32(v) => v[i].to_string(),
            ColumnSlice::U32(v) => v[i].to_string(),
        },
        allowed,
    })
}
