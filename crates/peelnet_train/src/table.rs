//! The table that training reads.

use std::ops::Range;
use std::sync::Arc;

use peelnet_dataset::Subset;
use peelnet_model::{DatasetRef, Recipe};

use crate::error::TrainError;
use crate::normalise::{Moments, Normalisation};
use crate::scratch::Scratch;

/// Examples, by column.
///
/// An *example* is what batches count: a row, or a pixel with all of its rows where there are [`TrainingData::pixels`]. All columns of rows
/// are equally long, and so are all of examples. Where the examples are streamed, the columns are empty: they lie in a scratch file.
#[derive(Clone, Debug, Default)]
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
    /// How many of a dataset's rows these examples are made of; none where all are.
    pub used: Option<UsedRows>,
    /// How rows of datasets were set aside; none where they were in memory before.
    pub split: Option<DataSplit>,
    /// Recorded in the model file.
    pub dataset: Option<DatasetRef>,
    pub(crate) scratch: Option<Arc<Scratch>>,
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

/// How many rows of datasets a training uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UsedRows {
    /// Rows of the pixels that are used.
    pub used: u64,
    /// Rows of all scenes that may be trained on.
    pub of: u64,
}

/// What whole pixels have beside inputs and targets. A row is a fragment that the network is asked about.
#[derive(Clone, Debug, Default)]
pub struct PixelColumns {
    /// First row of each pixel.
    pub first: Vec<u32>,
    /// For each row: [`RESIDUAL`], [`ALPHA`], and three of [`COLOR`].
    pub rows: [Vec<f32>; 5],
    /// For each pixel, what its ends contribute without a network: [`LEFT`], [`SUM`], and three each of [`KNOWN`] and [`EXACT`].
    pub fixed: [Vec<f32>; 8],
}

/// Absorbance whose share in front the network predicts.
pub const RESIDUAL: usize = 0;
/// Opacity, times the transmittance of what is known to lie in front.
pub const ALPHA: usize = 1;
/// Radiance.
pub const COLOR: usize = 2;
/// The coverage that is left to distribute.
pub const LEFT: usize = 0;
/// `Σ a`: contributions before normalisation, of ends that are normalised with the rest.
pub const SUM: usize = 1;
/// `Σ a c`.
pub const KNOWN: usize = 2;
/// `Σ y c`, of the exact contributions `y` of the same fragments.
pub const EXACT: usize = 5;

impl TrainingData {
    /// Rows with inputs and targets alone.
    pub fn new(source: &str, inputs: Vec<Vec<f32>>, targets: Vec<Vec<f32>>) -> Self {
        Self {
            source: source.to_owned(),
            inputs,
            targets,
            ..Self::default()
        }
    }

    /// No rows, with the columns of a recipe.
    pub(crate) fn for_recipe(recipe: Recipe) -> Self {
        let weighed = !recipe.inputs.are_columns();
        Self {
            inputs: vec![Vec::new(); recipe.inputs.features().len()],
            targets: vec![Vec::new(); recipe.output.count()],
            weights: weighed.then(Vec::new),
            pixels: recipe.loss.map(|_| PixelColumns::default()),
            subsets: Some(Vec::new()),
            ..Self::default()
        }
    }

    pub(crate) fn row_columns(&self) -> impl Iterator<Item = &Vec<f32>> {
        let pixels = self.pixels.iter().flat_map(|p| &p.rows);
        self.inputs.iter().chain(&self.targets).chain(pixels)
    }

    pub(crate) fn row_columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f32>> {
        let pixels = self.pixels.iter_mut().flat_map(|p| &mut p.rows);
        let columns = self.inputs.iter_mut().chain(&mut self.targets);
        columns.chain(pixels)
    }

    pub(crate) fn example_columns(&self) -> impl Iterator<Item = &Vec<f32>> {
        let pixels = self.pixels.iter().flat_map(|p| &p.fixed);
        pixels.chain(&self.weights)
    }

    pub(crate) fn example_columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f32>> {
        let pixels = self.pixels.iter_mut().flat_map(|p| &mut p.fixed);
        pixels.chain(&mut self.weights)
    }

    pub(crate) fn push_row(
        &mut self,
        inputs: impl IntoIterator<Item = f64>,
        targets: impl IntoIterator<Item = f64>,
    ) {
        let columns = self.inputs.iter_mut().zip(inputs);
        for (column, value) in columns.chain(self.targets.iter_mut().zip(targets)) {
            column.push(value as f32);
        }
    }

    /// The last rows are an example.
    pub(crate) fn end_example(&mut self, weight: f32, subset: Subset) {
        self.weights.iter_mut().for_each(|all| all.push(weight));
        self.subsets.iter_mut().for_each(|all| all.push(subset));
    }

    pub(crate) fn rows_held(&self) -> usize {
        self.targets.first().map_or(0, Vec::len)
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        let held = self.rows_held() as u64;
        self.scratch.as_ref().map_or(held, |scratch| scratch.rows)
    }

    /// Bytes of the scratch file where the examples are streamed.
    pub fn scratch_bytes(&self) -> Option<u64> {
        self.scratch.as_ref().map(|scratch| scratch.bytes)
    }

    pub(crate) fn rows_of(&self, example: u32) -> Range<u32> {
        let Some(PixelColumns { first, .. }) = &self.pixels else {
            return example..example + 1;
        };
        let end = first.get(example as usize + 1);
        first[example as usize]..end.map_or(self.rows_held() as u32, |&row| row)
    }

    pub(crate) fn examples_held(&self) -> usize {
        let pixels = self.pixels.as_ref();
        pixels.map_or(self.rows_held(), |pixels| pixels.first.len())
    }

    /// Number of examples of a subset; where none are set aside yet, all are for training.
    pub fn examples(&self, subset: Subset) -> u64 {
        match (&self.scratch, &self.subsets) {
            (Some(scratch), _) => scratch.examples(subset),
            (None, Some(subsets)) => subsets.iter().filter(|s| **s == subset).count() as u64,
            (None, None) if subset == Subset::Train => self.examples_held() as u64,
            (None, None) => 0,
        }
    }

    /// # Errors
    /// A missing column, columns of different lengths, no rows at all, more rows than 32-bit indices can name, or a
    /// value that is not finite.
    pub(crate) fn check(&self, recipe: Recipe) -> Result<(), TrainError> {
        if self.scratch.is_some() {
            return Ok(());
        }
        let names = recipe.input_names();
        let rows = self.rows_held();
        if rows == 0 && self.inputs.len() == names.len() {
            let of = self.dataset.as_ref().map_or(0, |dataset| dataset.rows);
            return Err(TrainError::no_examples(&self.source, recipe, of));
        }
        let uneven = names.iter().zip(&self.inputs);
        let mut uneven = uneven.map(|(name, values)| (name, values.len()));
        let split = self.subsets.as_ref();
        let problem = if self.inputs.len() != names.len() {
            format!(
                "{} input columns, but the recipe takes {}: {}",
                self.inputs.len(),
                names.len(),
                names.join(", ")
            )
        } else if rows > i32::MAX as usize {
            format!(
                "{rows} rows are more than the {} that one training run can hold; use fewer",
                i32::MAX
            )
        } else if let Some((name, found)) = uneven.find(|(_, found)| *found != rows) {
            format!("column `{name}` has {found} rows, but the target has {rows}")
        } else if let Some(split) = split.filter(|s| s.len() != self.examples_held()) {
            format!(
                "the split has {} examples, but there are {}",
                split.len(),
                self.examples_held()
            )
        } else if self.examples(Subset::Train) == 0 {
            "every row is held out, none is left to train on; hold out a smaller share".to_owned()
        } else {
            return self.check_values(recipe, &self.source, 0);
        };
        Err(TrainError::rows(&self.source, &problem))
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
                let (value, row) = (values[row], before + row as u64);
                return Err(TrainError::Failed(format!(
                    "{source}: row {row}, column `{name}` is {value}; extract the dataset again or leave the row out"
                )));
            }
        }
        Ok(())
    }

    /// Makes room for so many examples and rows in all.
    pub(crate) fn reserve(&mut self, examples: usize, rows: usize) {
        fn to<T>(column: &mut Vec<T>, most: usize) {
            column.reserve_exact(most.saturating_sub(column.len()));
        }
        self.row_columns_mut().for_each(|column| to(column, rows));
        let columns = self.example_columns_mut();
        columns.for_each(|column| to(column, examples));
        let pixels = self.pixels.iter_mut();
        pixels.for_each(|pixels| to(&mut pixels.first, examples));
    }

    /// Removes all rows; the columns keep their room.
    pub(crate) fn clear(&mut self) {
        self.row_columns_mut().for_each(Vec::clear);
        self.example_columns_mut().for_each(Vec::clear);
        self.subsets.iter_mut().for_each(Vec::clear);
        let pixels = self.pixels.iter_mut();
        pixels.for_each(|pixels| pixels.first.clear());
    }

    /// Identifies the rows, so that a checkpoint is continued with the same ones: a 64-bit hash over the bits of every value, or that of the
    /// dataset, which does not know what is held out, with the scenes that are not.
    pub(crate) fn fingerprint(&self) -> String {
        if self.scratch.is_some() {
            let dataset = self.dataset.iter();
            let known = dataset.map(|d| {
                format!(
                    "{}, {} rows of {:?} and {:?}",
                    d.hash, d.rows, d.scenes, d.set_aside
                )
            });
            return format!("dataset {}", known.collect::<String>());
        }
        let columns = self.inputs.iter().chain(&self.targets).chain(&self.weights);
        let words = columns.flat_map(|column| {
            let values = column.iter().map(|v| u64::from(v.to_bits()));
            values.chain([column.len() as u64])
        });
        let subsets = self.subsets.iter().flatten().map(|&s| s as u64);
        let hash = words
            .chain(subsets)
            .fold(0xCBF2_9CE4_8422_2325_u64, |hash, word| {
                (hash ^ word)
                    .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                    .rotate_left(29)
            });
        format!("{hash:016x}")
    }

    /// Of each input, over the examples that train.
    pub(crate) fn normalisation(&self, train: &[u32]) -> Vec<Normalisation> {
        if let Some(scratch) = &self.scratch {
            return scratch
                .moments
                .iter()
                .map(Normalisation::from_moments)
                .collect();
        }
        let rows: Vec<u32> = train.iter().flat_map(|&e| self.rows_of(e)).collect();
        let over = |values: &Vec<f32>| Normalisation::from_moments(&Moments::over(values, &rows));
        self.inputs.iter().map(over).collect()
    }
}
