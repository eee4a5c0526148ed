//! Which examples are used, what for, and in which order.
//!
//! A run sees its examples in windows: what is on the device at once. Of examples in memory there is one window, all of a subset, in the order
//! of the epoch. Streamed examples have windows of about [`Config::buffer_rows`] rows:
//!
//! - The blocks of the scratch file are permuted, from the seed and the epoch's number. A window takes the next ones, and its examples
//!   are permuted, from the seed, the epoch's number and the window's.
//! - All windows of an epoch hold about the same number of rows, so that none is mixed from a few blocks only.
//! - A training window holds a multiple of the batch. What is left over goes into the next window, so that a batch is smaller at the
//!   end of an epoch only, as in memory.
//!
//! Nothing depends on the number of threads, and every example is in one window of an epoch.

use std::sync::OnceLock;

use burn::tensor::Device;
use peelnet_dataset::Subset;

use crate::config::{Config, DEFAULT_BUFFER_ROWS};
use crate::draws::Stream;
use crate::error::TrainError;
use crate::loss::Window;
use crate::normalise::Normalisation;
use crate::scratch::{SUBSETS, Scratch, decode, encode};
use crate::table::TrainingData;

/// Indices of the examples in memory, ascending, by subset. Where the data have no split, `⌊n · held_out⌋` are drawn for testing; at least one is
/// left for training.
pub(crate) fn by_subset(data: &TrainingData, config: &Config) -> [Vec<u32>; 3] {
    let drawn = || {
        let n = data.examples_held();
        let held_out = ((n as f64 * config.held_out) as usize).min(n.saturating_sub(1));
        let order = Stream::Split.random(config.seed).permutation(n as u32);
        let mut subsets = vec![Subset::Train; n];
        for &example in &order[..held_out] {
            subsets[example as usize] = Subset::Test;
        }
        subsets
    };
    let subsets = data.subsets.clone().unwrap_or_else(drawn);
    SUBSETS.map(|wanted| {
        let examples = (0u32..).zip(&subsets).filter(|(_, s)| **s == wanted);
        examples.map(|(example, _)| example).collect()
    })
}

pub(crate) struct Feed<'a> {
    pub(crate) config: &'a Config,
    pub(crate) data: &'a TrainingData,
    pub(crate) device: &'a Device,
    pub(crate) normalisation: Vec<Normalisation>,
    /// Those in memory.
    pub(crate) examples: [Vec<u32>; 3],
    /// Of subsets in memory whose order never changes.
    pub(crate) loaded: [OnceLock<Window>; 3],
}

impl Feed<'_> {
    pub(crate) fn examples(&self, subset: Subset) -> u64 {
        match &self.data.scratch {
            Some(scratch) => scratch.examples(subset),
            None => self.examples[subset as usize].len() as u64,
        }
    }

    /// Calls `each` with the windows of a pass over a subset, in the order of an epoch or in any.
    pub(crate) fn pass(
        &self,
        subset: Subset,
        epoch: Option<u32>,
        mut each: impl FnMut(&Window) -> Result<(), TrainError>,
    ) -> Result<(), TrainError> {
        let window = |data: &TrainingData, order: &[u32]| {
            Window::new(data, order, &self.normalisation, self.device)
        };
        if let Some(scratch) = &self.data.scratch {
            let pass = (subset, epoch);
            return windows(scratch, self.config, pass, |data, order| {
                each(&window(data, order))
            });
        }
        let examples = &self.examples[subset as usize];
        match epoch {
            _ if examples.is_empty() => Ok(()),
            Some(epoch) => {
                let order = Stream::Order(epoch).permuted(self.config.seed, examples);
                each(&window(self.data, &order))
            }
            None => {
                let loaded = &self.loaded[subset as usize];
                each(loaded.get_or_init(|| window(self.data, examples)))
            }
        }
    }
}

/// Calls `each` with the rows and the order of the examples of each window of a pass over a subset of streamed examples.
fn windows(
    scratch: &Scratch,
    config: &Config,
    (subset, epoch): (Subset, Option<u32>),
    mut each: impl FnMut(&TrainingData, &[u32]) -> Result<(), TrainError>,
) -> Result<(), TrainError> {
    let most = config.buffer_rows.unwrap_or(DEFAULT_BUFFER_ROWS).max(1);
    let stored = &scratch.blocks[subset as usize];
    let blocks = match epoch {
        Some(epoch) => Stream::Blocks(epoch).permuted(config.seed, stored),
        None => stored.clone(),
    };
    let total: u64 = blocks.iter().map(|block| u64::from(block.rows)).sum();
    let windows = total.div_ceil(most).max(1);
    // Whole batches to learn from; for judging, something.
    let is_training = subset == Subset::Train;
    let least = if is_training { config.batch } else { 1 };
    let mut buffer = TrainingData::for_recipe(config.recipe);
    let mut bytes = Vec::new();
    // Examples that did not fill a batch: their words and their number.
    let (mut left, mut left_examples) = (Vec::new(), 0);
    let (mut next, mut read) = (0, 0);
    for number in 1.. {
        buffer.clear();
        decode(&left, left_examples, &mut buffer);
        let end = (u128::from(total) * number / u128::from(windows)) as u64;
        let first = next;
        let (mut rows, mut examples) = (buffer.rows_held(), buffer.examples_held());
        while let Some(block) = blocks.get(next)
            && (read < end || examples < least)
        {
            next += 1;
            read += u64::from(block.rows);
            rows += block.rows as usize;
            examples += block.examples as usize;
        }
        if examples == 0 {
            break;
        }
        // At once: a column that grows while it is filled is in memory twice.
        buffer.reserve(examples, rows);
        for &block in &blocks[first..next] {
            scratch.read(block, &mut bytes, &mut buffer)?;
        }
        let mut order: Vec<u32> = (0..examples as u32).collect();
        if let Some(epoch) = epoch {
            order = Stream::Window(epoch, number as u64).permuted(config.seed, &order);
        }
        left.clear();
        left_examples = 0;
        if is_training && next < blocks.len() {
            let rest = order.split_off(order.len() / config.batch * config.batch);
            encode(&buffer, &rest, &mut left);
            left_examples = rest.len();
        }
        each(&buffer, &order)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use peelnet_core::random::Random;
    use peelnet_model::Recipe;

    use super::*;
    use crate::examples::ViewWeights;
    use crate::scratch::BLOCK_ROWS;

    #[test]
    fn a_third_is_held_out_and_no_row_is_lost() {
        let config = Config::for_recipe(Recipe::THESIS);
        let rows = |n: usize| TrainingData::new("test", Vec::new(), vec![vec![0.0; n]]);
        let [train, validation, test] = by_subset(&rows(3000), &config);
        let counts = [train.len(), validation.len(), test.len()];
        assert_eq!(counts, [2000, 0, 1000]);
        assert!(train.is_sorted() && test.is_sorted());
        let all: BTreeSet<u32> = train.into_iter().chain(test).collect();
        assert!(all.into_iter().eq(0..3000));
        let mut given = rows(4);
        let [train, validation, test] = SUBSETS;
        given.subsets = Some(vec![train, test, validation, train]);
        assert_eq!(by_subset(&given, &config), [vec![0, 3], vec![2], vec![1]]);
    }

    /// Pixels of 1 to 12 rows with their number in every column, a third of them for testing.
    fn view(recipe: Recipe, first: u32, pixels: u32, random: &mut Random) -> TrainingData {
        let mut data = TrainingData::for_recipe(recipe);
        for id in first..first + pixels {
            let first_row = data.rows_held() as u32;
            let mut rows = 1;
            if let Some(pixels) = &mut data.pixels {
                rows = 1 + id as usize % 12;
                pixels.first.push(first_row);
                pixels.fixed.iter_mut().for_each(|c| c.push(id as f32));
            }
            for column in data.row_columns_mut() {
                column.resize(first_row as usize + rows, id as f32);
            }
            let is_test = random.unit() < 0.33;
            data.end_example(id as f32, SUBSETS[if is_test { 2 } else { 0 }]);
        }
        data
    }

    /// The number of an example of a window, where all that belongs to it is there.
    fn id(data: &TrainingData, example: u32) -> u32 {
        let rows = data.rows_of(example);
        let value = data.inputs[0][rows.start as usize];
        let id = value as u32;
        if data.pixels.is_some() {
            assert_eq!(rows.len() as u32, 1 + id % 12, "whole pixels");
        }
        for column in data.row_columns() {
            let values = &column[rows.start as usize..rows.end as usize];
            assert!(values.iter().all(|&v| v == value));
        }
        let fixed = data.pixels.iter().flat_map(|pixels| &pixels.fixed);
        fixed.for_each(|column| assert_eq!(column[example as usize], value));
        // The weights of every view are multiplied by its number and one.
        let weights = data.weights.iter();
        let factor = (1 + id / 100_000) as f32;
        weights.for_each(|weights| assert_eq!(weights[example as usize], value * factor));
        id
    }

    /// Whatever the buffer and the batch, an epoch has every example of its part once, batches are whole but for the last, a buffer
    /// holds no more than was asked, a block, a batch and what was left over, and epochs have different orders.
    #[test]
    fn every_example_is_in_one_window_of_an_epoch() {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Random::new(3, &[1]);
        for recipe in [Recipe::THESIS, Recipe::NMT, Recipe::MEDIUM] {
            let mut scratch = Scratch::create(folder.path(), 0).unwrap();
            scratch.weights = ViewWeights {
                overall: 6.0,
                views: vec![6.0, 3.0, 2.0],
            };
            let mut expected: [Vec<u32>; 3] = Default::default();
            for number in 0..3 {
                let first = number * 100_000;
                let data = view(recipe, first, 1 + number * 7000, &mut random);
                for (id, subset) in (first..).zip(data.subsets.iter().flatten()) {
                    expected[*subset as usize].push(id);
                }
                scratch.write(number as usize, &data).unwrap();
            }
            for (most, batch) in [(1, 1), (900, 64), (5000, 7), (30_000, 1000), (1 << 20, 96)] {
                let config = Config {
                    seed: 5,
                    batch,
                    buffer_rows: Some(most),
                    ..Config::for_recipe(recipe)
                };
                // All examples in order, and those of the first window.
                let pass = |subset, epoch| {
                    let (mut all, mut first, mut is_whole) = (Vec::new(), BTreeSet::new(), true);
                    windows(&scratch, &config, (subset, epoch), |buffer, order| {
                        assert!(is_whole, "only the last window has a part of a batch");
                        is_whole = subset != Subset::Train || order.len().is_multiple_of(batch);
                        let room = most as usize + 2 * BLOCK_ROWS + 24 * batch;
                        assert!(buffer.rows_held() <= room);
                        all.extend(order.iter().map(|&e| id(buffer, e)));
                        if first.is_empty() {
                            first.extend(all.iter().copied());
                        }
                        Ok(())
                    })
                    .unwrap();
                    (all, first)
                };
                let (test, _) = pass(Subset::Test, None);
                assert_eq!(test, expected[2], "in the order of the views");
                let [first, second] = [1, 2].map(|epoch| pass(Subset::Train, Some(epoch)));
                assert_ne!(first.0, second.0);
                let has_several = first.1.len() < first.0.len();
                assert!(
                    !has_several || first.1 != second.1,
                    "the order of the blocks"
                );
                assert_eq!(pass(Subset::Train, Some(1)), first);
                for (mut all, _) in [first, second] {
                    assert_ne!(all, expected[0]);
                    all.sort_unstable();
                    assert!(
                        all == expected[0],
                        "{recipe}, {most} rows, batches of {batch}"
                    );
                }
            }
        }
    }
}
