//! A run of rows, column by column.

use std::ops::Range;

use crate::column::{Column, ColumnMut, ColumnSlice};
use crate::error::DatasetError;

/// Some rows of the dataset as fourteen vectors of equal length. See [`Column`] for meanings and units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FragmentBatch {
    /// 1 − α_i.
    pub one_minus_alpha: Vec<f32>,
    /// z_i, scene units.
    pub linear_depth: Vec<f32>,
    /// Σ α of the pixel.
    pub alpha_sum: Vec<f32>,
    /// n of the pixel.
    pub fragment_count: Vec<u32>,
    /// T_i.
    pub transmittance: Vec<f32>,
    /// Index of the work item.
    pub view: Vec<u32>,
    /// Pixel column.
    pub x: Vec<u32>,
    /// Pixel row.
    pub y: Vec<u32>,
    /// Rank from the front.
    pub layer: Vec<u32>,
    /// Red radiance.
    pub r: Vec<f32>,
    /// Green radiance.
    pub g: Vec<f32>,
    /// Blue radiance.
    pub b: Vec<f32>,
    /// Near clip distance.
    pub near: Vec<f32>,
    /// Far clip distance.
    pub far: Vec<f32>,
}

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
        for column in Column::ALL {
            match self.column_mut(column) {
                ColumnMut::F32(v) => v.clear(),
                ColumnMut::U32(v) => v.clear(),
            }
        }
    }

    /// The values of a column.
    pub fn column(&self, column: Column) -> ColumnSlice<'_> {
        match column {
            Column::OneMinusAlpha => ColumnSlice::F32(&self.one_minus_alpha),
            Column::LinearDepth => ColumnSlice::F32(&self.linear_depth),
            Column::AlphaSum => ColumnSlice::F32(&self.alpha_sum),
            Column::FragmentCount => ColumnSlice::U32(&self.fragment_count),
            Column::Transmittance => ColumnSlice::F32(&self.transmittance),
            Column::View => ColumnSlice::U32(&self.view),
            Column::X => ColumnSlice::U32(&self.x),
            Column::Y => ColumnSlice::U32(&self.y),
            Column::Layer => ColumnSlice::U32(&self.layer),
            Column::R => ColumnSlice::F32(&self.r),
            Column::G => ColumnSlice::F32(&self.g),
            Column::B => ColumnSlice::F32(&self.b),
            Column::Near => ColumnSlice::F32(&self.near),
            Column::Far => ColumnSlice::F32(&self.far),
        }
    }

    pub(crate) fn column_mut(&mut self, column: Column) -> ColumnMut<'_> {
        match column {
            Column::OneMinusAlpha => ColumnMut::F32(&mut self.one_minus_alpha),
            Column::LinearDepth => ColumnMut::F32(&mut self.linear_depth),
            Column::AlphaSum => ColumnMut::F32(&mut self.alpha_sum),
            Column::FragmentCount => ColumnMut::U32(&mut self.fragment_count),
            Column::Transmittance => ColumnMut::F32(&mut self.transmittance),
            Column::View => ColumnMut::U32(&mut self.view),
            Column::X => ColumnMut::U32(&mut self.x),
            Column::Y => ColumnMut::U32(&mut self.y),
            Column::Layer => ColumnMut::U32(&mut self.layer),
            Column::R => ColumnMut::F32(&mut self.r),
            Column::G => ColumnMut::F32(&mut self.g),
            Column::B => ColumnMut::F32(&mut self.b),
            Column::Near => ColumnMut::F32(&mut self.near),
            Column::Far => ColumnMut::F32(&mut self.far),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ragged_batches_are_named() {
        let mut batch = FragmentBatch::with_capacity(2);
        assert!(batch.check().is_ok() && batch.is_empty());
        batch.one_minus_alpha.push(0.5);
        let message = batch.check().expect_err("ragged").to_string();
        assert!(message.contains("linear_depth"), "{message}");
    }
}
