//! The range that each column's values must keep.

use std::path::Path;

use crate::column::{Column, ColumnSlice};
use crate::error::DatasetError;

/// What is allowed in a float column.
fn float_rule(column: Column) -> (fn(f32) -> bool, &'static str) {
    match column {
        Column::OneMinusAlpha | Column::Transmittance => (
            |v| (0.0..=1.0).contains(&v),
            "it must be a number from 0 to 1",
        ),
        Column::LinearDepth | Column::Near | Column::Far => (
            |v| v > 0.0 && v < f32::INFINITY,
            "it must be a finite number above 0",
        ),
        Column::AlphaSum => (
            |v| (0.0..f32::INFINITY).contains(&v),
            "it must be a finite number not below 0",
        ),
        _ => (f32::is_finite, "it must be a finite number"),
    }
}

/// Finds the first value of a column that is not allowed. `first_row` is the number of the first value's row in its
/// part, counted from 0; `view` is the part's index, which the `view` column must repeat.
///
/// The rule is applied to all values without leaving early, so that it becomes vector instructions; only a failure
/// searches.
pub(crate) fn check_column(
    path: &Path,
    column: Column,
    values: ColumnSlice<'_>,
    first_row: u64,
    view: u32,
) -> Result<(), DatasetError> {
    let error = |i: usize, value: String, allowed| DatasetError::Value {
        path: path.to_owned(),
        row: first_row + i as u64 + 1,
        column,
        value,
        allowed,
    };
    match (values, column) {
        (ColumnSlice::F32(values), _) => {
            let (good, allowed) = float_rule(column);
            // The match outside the loop lets each rule be inlined into its own loop.
            let all_good = match column {
                Column::OneMinusAlpha | Column::Transmittance => {
                    all(values, |v| (0.0..=1.0).contains(&v))
                }
                Column::LinearDepth | Column::Near | Column::Far => {
                    all(values, |v| v > 0.0 && v < f32::INFINITY)
                }
                Column::AlphaSum => all(values, |v| (0.0..f32::INFINITY).contains(&v)),
                _ => all(values, f32::is_finite),
            };
            if all_good {
                return Ok(());
            }
            match values.iter().position(|&v| !good(v)) {
                Some(i) => Err(error(i, values[i].to_string(), allowed)),
                None => Ok(()),
            }
        }
        (ColumnSlice::U32(values), Column::View) => match values.iter().position(|&v| v != view) {
            Some(i) => Err(error(
                i,
                values[i].to_string(),
                "it must be the index of the part",
            )),
            None => Ok(()),
        },
        (ColumnSlice::U32(values), Column::FragmentCount) => {
            match values.iter().position(|&v| v == 0) {
                Some(i) => Err(error(i, "0".to_owned(), "it must be at least 1")),
                None => Ok(()),
            }
        }
        (ColumnSlice::U32(_), _) => Ok(()),
    }
}

fn all(values: &[f32], good: impl Fn(f32) -> bool) -> bool {
    values.iter().fold(true, |all, &v| all & good(v))
}
