//! The columns that training reads.

use std::ops::Range;

use peelnet_dataset::Subset;
use peelnet_model::{DatasetRef, Recipe};

use crate::error::TrainError;
use crate::normalise::Normalisation;
use crate::split::Split;

/// Rows in memory, by column. All columns are equally long.
///
/// An *example* is what batches count: a row, or a pixel with all of its rows where there are [`TrainingData::pixels`].
#[derive(Clone, Debug)]
pub struct TrainingData {
    /// Where the rows are from, for messages: a path.
    pub source: String,
    /// One column per input, in the recipe's order and in raw units (scene units, counts).
    pub inputs: Vec<Vec<f32>>,
    /// What the network should answer, one column per output; for pixels, how much of each fragment is seen (`α T`).
    pub targets: Vec<Vec<f32>>,
    /// Weight of each example's loss; 1 without it.
    pub weights: Option<Vec<f32>>,
    /// Which rows make a pixel, for recipes that learn from whole pixels.
    pub pixels: Option<PixelColumns>,
    /// The subset of each example. Without it, [`Config::held_out`](crate::Config::held_out) of them are drawn from the
    /// seed for testing.
    pub subsets: Option<Vec<Subset>>,
    /// How many of a dataset's rows these examples are made of; none where they were in memory before.
    pub used: Option<UsedRows>,
    /// How rows of datasets were set aside; none where they were in memory before.
    pub split: Option<DataSplit>,
    /// Recorded in the model file.
    pub dataset: Option<DatasetRef>,
}

/// What was set aside for validation and testing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DataSplit {
    /// Whole scenes, by name.
    Scenes {
        /// Those that choices are made by.
        validation: Vec<String>,
        /// Those that are only reported.
        test: Vec<String>,
    },
    /// Pixels of all scenes alike.
    Pixels {
        /// How many scenes there are.
        scenes: usize,
    },
}

impl DataSplit {
    /// Whether a scene was set aside whole.
    pub(crate) fn contains(&self, name: &String) -> bool {
        match self {
            Self::Scenes { validation, test } => validation.contains(name) || test.contains(name),
            Self::Pixels { .. } => false,
        }
    }
}

/// How many rows of datasets a training uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UsedRows {
    /// Rows of the pixels that are used.
    pub used: u64,
    /// Rows of all scenes that may be trained on.
    pub of: u64,
}

/// What whole pixels have beside their rows. A row is a fragment that the network is asked about.
#[derive(Clone, Debug, Default)]
pub struct PixelColumns {
    /// First row of each pixel.
    pub first: Vec<u32>,
    /// Absorbance whose share in front the network predicts, for each row.
    pub rest: Vec<f32>,
    /// Opacity, times the transmittance of what is known to lie in front, for each row.
    pub alpha: Vec<f32>,
    /// Radiance, for each row.
    pub color: [Vec<f32>; 3],
    /// For each pixel, see [`PixelFixed`].
    pub fixed: Vec<PixelFixed>,
}

/// What a pixel's ends contribute without a network.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelFixed {
    /// The coverage that is left to distribute.
    pub left: f32,
    /// `Σ a`: contributions before normalisation, of ends that are normalised with the rest.
    pub sum: f32,
    /// `Σ a c`.
    pub color: [f32; 3],
    /// `Σ y c`, of the exact contributions `y` of the same fragments.
    pub exact: [f32; 3],
}

impl PixelColumns {
    /// The rows of a pixel, of `rows` in all.
    pub(crate) fn rows(&self, pixel: usize, rows: usize) -> Range<u32> {
        let end = self.first.get(pixel + 1).map_or(rows as u32, |&row| row);
        self.first[pixel]..end
    }
}

impl TrainingData {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.targets.first().map_or(0, Vec::len)
    }

    /// The rows of an example.
    pub(crate) fn rows_of(&self, example: u32) -> Range<u32> {
        match &self.pixels {
            Some(pixels) => pixels.rows(example as usize, self.rows()),
            None => example..example + 1,
        }
    }

    /// Number of examples.
    pub fn examples(&self) -> usize {
        self.pixels.as_ref().map_or(self.rows(), |p| p.first.len())
    }

    /// Examples that gradients come from, where the split is given.
    pub fn training_examples(&self) -> usize {
        self.subsets.as_ref().map_or(self.examples(), |subsets| {
            subsets.iter().filter(|s| **s == Subset::Train).count()
        })
    }

    /// The same data with only a share of its training examples, evenly spread, left to train on; the others are for testing.
    pub fn with_share(&self, share: f64) -> Self {
        let mut data = self.clone();
        let mut seen = 0u64;
        for subset in data.subsets.iter_mut().flatten() {
            if *subset == Subset::Train {
                let before = (seen as f64 * share) as u64;
                seen += 1;
                // At every step of the integer part one is kept.
                if (seen as f64 * share) as u64 == before {
                    *subset = Subset::Test;
                }
            }
        }
        data
    }

    /// # Errors
    /// A missing column, columns of different lengths, no rows at all, more rows than 32-bit indices can name, or a
    /// value that is not finite.
    pub(crate) fn check(&self, recipe: Recipe) -> Result<(), TrainError> {
        let names = recipe.input_names();
        let columns = |problem: String| {
            Err(TrainError::Columns {
                data: self.source.clone(),
                problem,
            })
        };
        if self.inputs.len() != names.len() {
            return columns(format!(
                "{} input columns, but the recipe takes {}: {}",
                self.inputs.len(),
                names.len(),
                names.join(", ")
            ));
        }
        if self.rows() == 0 {
            return Err(TrainError::no_rows(&self.source));
        }
        if self.rows() > i32::MAX as usize {
            return columns(format!(
                "{} rows are more than the {} that one training run can hold; use fewer",
                self.rows(),
                i32::MAX
            ));
        }
        for (name, values) in names.iter().zip(&self.inputs) {
            if values.len() != self.rows() {
                return columns(format!(
                    "column `{name}` has {} rows, but the target has {}",
                    values.len(),
                    self.rows()
                ));
            }
        }
        if let Some(subsets) = &self.subsets {
            if subsets.len() != self.examples() {
                return columns(format!(
                    "the split has {} examples, but there are {}",
                    subsets.len(),
                    self.examples()
                ));
            }
            if !subsets.contains(&Subset::Train) {
                return columns(
                    "every row is held out, none is left to train on; hold out a smaller share"
                        .into(),
                );
            }
        }
        self.check_values(recipe, &self.source, 0)
    }

    /// # Errors
    /// A value that is not finite. `before` is the number of the first row.
    pub(crate) fn check_values(
        &self,
        recipe: Recipe,
        source: &str,
        before: u64,
    ) -> Result<(), TrainError> {
        let names = recipe.input_names();
        let named = names.into_iter().chain(std::iter::repeat("target"));
        for (name, values) in named.zip(self.inputs.iter().chain(&self.targets)) {
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                return Err(TrainError::Value {
                    data: source.to_owned(),
                    row: before + row as u64,
                    column: name.to_owned(),
                    value: values[row],
                });
            }
        }
        Ok(())
    }

    /// Makes room for so many examples and rows in all.
    pub(crate) fn reserve(&mut self, examples: usize, rows: usize) {
        fn to<T>(column: &mut Vec<T>, most: usize) {
            column.reserve_exact(most.saturating_sub(column.len()));
        }
        let columns = self.inputs.iter_mut().chain(&mut self.targets);
        columns.for_each(|column| to(column, rows));
        self.weights.iter_mut().for_each(|w| to(w, examples));
        if let Some(pixels) = &mut self.pixels {
            to(&mut pixels.first, examples);
            to(&mut pixels.fixed, examples);
            let columns = [&mut pixels.rest, &mut pixels.alpha].into_iter();
            let columns = columns.chain(&mut pixels.color);
            columns.for_each(|column| to(column, rows));
        }
    }

    /// Removes all rows; the columns keep their room.
    pub(crate) fn clear(&mut self) {
        let columns = self.inputs.iter_mut().chain(&mut self.targets);
        columns.chain(&mut self.weights).for_each(Vec::clear);
        self.subsets.iter_mut().for_each(Vec::clear);
        if let Some(pixels) = &mut self.pixels {
            pixels.first.clear();
            pixels.fixed.clear();
            let rows = [&mut pixels.rest, &mut pixels.alpha].into_iter();
            rows.chain(&mut pixels.color).for_each(Vec::clear);
        }
    }

    /// Identifies the rows, so that a checkpoint is continued with the same ones: a 64-bit hash over the bits of every value.
    pub(crate) fn fingerprint(&self) -> String {
        let mut hash = 0xCBF2_9CE4_8422_2325_u64;
        for column in self.inputs.iter().chain(&self.targets).chain(&self.weights) {
            for word in column
                .iter()
                .map(|v| u64::from(v.to_bits()))
                .chain([column.len() as u64])
            {
                hash = (hash ^ word)
                    .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                    .rotate_left(29);
            }
        }
        for &subset in self.subsets.iter().flatten() {
            hash = (hash ^ subset as u64)
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .rotate_left(29);
        }
        format!("{hash:016x}")
    }

    /// Over the rows that train.
    pub(crate) fn normalisation(&self, split: &Split) -> Vec<Normalisation> {
        let pixel_rows: Option<Vec<u32>> = self.pixels.as_ref().map(|pixels| {
            let examples = split.train.iter();
            examples
                .flat_map(|&p| pixels.rows(p as usize, self.rows()))
                .collect()
        });
        let rows = pixel_rows.as_ref().unwrap_or(&split.train);
        let over = |values: &Vec<f32>| Normalisation::over(values, rows);
        self.inputs.iter().map(over).collect()
    }
}
