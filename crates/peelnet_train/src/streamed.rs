//! Examples of datasets that are larger than memory.
//!
//! One pass over the datasets makes the examples, in the order of the parts, adds up the moments of the inputs and writes the examples to
//! a scratch file ([`crate::scratch`]). An epoch reads the file's blocks in an order drawn from the seed, see [`crate::feed`].

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use peelnet_dataset::Dataset;
use peelnet_model::DatasetRef;

use crate::config::Config;
use crate::data::Plan;
use crate::error::TrainError;
use crate::gather::{Gather, ViewWeights};
use crate::normalise::{Moments, Normalisation};
use crate::sample::Sample;
use crate::scratch::Scratch;
use crate::task::Part;
use crate::training_data::{DataSplit, TrainingData};

/// Examples in a scratch file, of which [`Config::buffer_rows`] rows are in memory at once.
///
/// All rows are used, whatever [`Config::max_rows`] says. The rows of each subset are those of [`TrainingData::from_datasets`].
#[derive(Debug)]
pub struct StreamedData {
    /// Where the rows are from, for messages: a path.
    pub source: String,
    /// How rows were set aside.
    pub split: Option<DataSplit>,
    /// Recorded in the model file.
    pub dataset: Option<DatasetRef>,
    pub(crate) scratch: Scratch,
    pub(crate) weights: ViewWeights,
    pub(crate) normalisation: Vec<Normalisation>,
    rows: u64,
}

impl StreamedData {
    /// Reads all scenes that are not held out, dataset after dataset, and writes the examples to a file without a name in `folder`,
    /// which is made if it is not there. The file takes [`StreamedData::scratch_bytes`] and is gone when the process ends.
    ///
    /// `stop` ends the reading from anywhere. `on_rows` gets the rows that were read and those of the datasets.
    ///
    /// # Errors
    /// A dataset that cannot be read, a file that cannot be written, no examples for a subset, or [`TrainError::Stopped`].
    pub fn from_datasets(
        config: &Config,
        datasets: &[Dataset],
        folder: &Path,
        stop: &AtomicBool,
        mut on_rows: impl FnMut(u64, u64),
    ) -> Result<Self, TrainError> {
        let plan = Plan::of_datasets(config, datasets)?;
        let mut scratch = Scratch::create(folder)?;
        let mut gather = Gather::new(config.recipe);
        let mut moments = vec![Moments::NONE; config.recipe.inputs.about().len()];
        let (mut rows, mut read) = (0, 0);
        for (view, split) in plan.views() {
            gather.view(view, split, &mut Sample::all(), |number, data| {
                if stop.load(Ordering::Relaxed) {
                    return Err(TrainError::Stopped);
                }
                data.check_values(config.recipe, &plan.source, rows)?;
                rows += data.rows() as u64;
                scratch.write(number as u32, data, |part, examples| {
                    if part == Part::Train {
                        let rows: Vec<u32> =
                            examples.iter().flat_map(|&e| data.rows_of(e)).collect();
                        for (moments, values) in moments.iter_mut().zip(&data.inputs) {
                            *moments = moments.merge(Moments::over(values, &rows));
                        }
                    }
                })?;
                data.clear();
                Ok(())
            })?;
            read += view.rows();
            on_rows(read, plan.dataset.rows);
        }
        let data = Self {
            source: plan.source,
            split: plan.split,
            dataset: Some(plan.dataset),
            scratch,
            weights: gather.weights(),
            normalisation: moments.into_iter().map(Normalisation::of).collect(),
            rows,
        };
        data.check(config)?;
        Ok(data)
    }

    /// Number of rows.
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Number of examples of a part.
    pub fn examples(&self, part: Part) -> u64 {
        let blocks = self.scratch.blocks[part as usize].iter();
        blocks.map(|block| u64::from(block.examples)).sum()
    }

    /// Bytes of the scratch file.
    pub const fn scratch_bytes(&self) -> u64 {
        self.scratch.bytes()
    }

    /// Blocks of three views, whose weights are multiplied by 1, 2 and 3.
    #[cfg(test)]
    pub(crate) fn for_tests(scratch: Scratch, rows: u64) -> Self {
        Self {
            source: "test".to_owned(),
            split: None,
            dataset: None,
            scratch,
            weights: ViewWeights::for_tests(),
            normalisation: Vec::new(),
            rows,
        }
    }

    /// Identifies the rows, so that a checkpoint is continued with the same ones.
    pub(crate) fn fingerprint(&self) -> String {
        let hash = self.dataset.as_ref().map(|dataset| &*dataset.hash);
        format!("dataset {}", hash.unwrap_or_default())
    }

    fn check(&self, config: &Config) -> Result<(), TrainError> {
        if self.rows == 0 {
            return Err(TrainError::no_rows(&self.source));
        }
        let asked = [
            (Part::Train, 1.0, "training"),
            (Part::Validation, config.validation, "validation"),
            (Part::Test, config.held_out, "testing"),
        ];
        for (part, share, name) in asked {
            if share > 0.0 && self.examples(part) == 0 {
                return Err(TrainError::Columns {
                    data: self.source.clone(),
                    problem: format!(
                        "no example is left for {name}: so few rows are trained on in memory, without streaming"
                    ),
                });
            }
        }
        Ok(())
    }
}

/// The examples that a run learns from.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// All in memory.
    Memory(&'a TrainingData),
    /// In a scratch file.
    Streamed(&'a StreamedData),
}

impl<'a> From<&'a TrainingData> for Source<'a> {
    fn from(data: &'a TrainingData) -> Self {
        Self::Memory(data)
    }
}

impl<'a> From<&'a StreamedData> for Source<'a> {
    fn from(data: &'a StreamedData) -> Self {
        Self::Streamed(data)
    }
}
