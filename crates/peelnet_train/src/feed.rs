//! The examples of a run, window by window.
//!
//! A window is what is in memory at once. Of examples in memory there is one window, all of a part, in the order of the epoch. Streamed
//! examples have windows of about [`Config::buffer_rows`] rows:
//!
//! - The blocks of the scratch file are permuted, from the seed and the epoch's number. A window takes the next ones, and its examples
//!   are permuted, from the seed, the epoch's number and the window's.
//! - All windows of an epoch hold about the same number of rows, so that none is mixed from a few blocks only.
//! - A training window holds a multiple of the batch. What is left over goes into the next window, so that a batch is smaller at the
//!   end of an epoch only, as in memory.
//!
//! Nothing depends on the number of threads, and every example is in one window of an epoch.
//!
//! [`Config::buffer_rows`]: crate::Config::buffer_rows

use burn::tensor::Device;

use crate::config::Config;
use crate::error::TrainError;
use crate::fragment_mse::FragmentMse;
use crate::normalise::Normalisation;
use crate::pixel_share::PixelShare;
use crate::scratch::{Block, decode, encode};
use crate::split::Split;
use crate::streamed::StreamedData;
use crate::streams::Stream;
use crate::task::{Part, Task};
use crate::training_data::TrainingData;

/// Examples, and the tensors of the window of each part.
pub(crate) struct Feed<'a> {
    examples: Examples<'a>,
    tasks: [Box<dyn Task + 'a>; 3],
    seed: u64,
}

/// Where examples come from.
pub(crate) enum Examples<'a> {
    /// All in memory, with the indices of each part.
    Memory {
        data: &'a TrainingData,
        split: Split,
        /// Whether the window of a part is on the device, in the order that the next pass asks for.
        loaded: [bool; 3],
        /// The epoch whose order a pass asks for, and whether the pass begins with the next window.
        epoch: Option<u32>,
        begins: bool,
    },
    /// From a scratch file.
    Streamed(Box<Windows<'a>>),
}

impl<'a> Examples<'a> {
    pub(crate) fn in_memory(data: &'a TrainingData, split: Split) -> Self {
        Self::Memory {
            data,
            split,
            loaded: [false; 3],
            epoch: None,
            begins: false,
        }
    }
}

impl<'a> Feed<'a> {
    pub(crate) fn new(
        config: &Config,
        examples: Examples<'a>,
        normalisation: &'a [Normalisation],
        device: &Device,
    ) -> Self {
        let whole_pixels = match &examples {
            Examples::Memory { data, .. } => data.pixels.is_some(),
            Examples::Streamed(_) => config.recipe.loss.is_some(),
        };
        let task = || -> Box<dyn Task + 'a> {
            if whole_pixels {
                Box::new(PixelShare::new(normalisation, config.loss, device))
            } else {
                Box::new(FragmentMse::new(normalisation, device))
            }
        };
        Self {
            examples,
            tasks: [task(), task(), task()],
            seed: config.seed,
        }
    }

    /// Number of examples of a part.
    pub(crate) fn examples(&self, part: Part) -> u64 {
        match &self.examples {
            Examples::Memory { split, .. } => split.part(part).len() as u64,
            Examples::Streamed(windows) => windows.data.examples(part),
        }
    }

    /// Begins a pass over a part, in the order of an epoch or in any.
    pub(crate) fn begin(&mut self, part: Part, epoch: Option<u32>) {
        match &mut self.examples {
            Examples::Memory {
                epoch: order,
                begins,
                loaded,
                ..
            } => {
                loaded[part as usize] &= epoch.is_none();
                (*order, *begins) = (epoch, true);
            }
            Examples::Streamed(windows) => windows.begin(part, epoch),
        }
    }

    /// Loads the next window of the pass, and returns the number of its examples; none at the end.
    pub(crate) fn next(&mut self, part: Part) -> Result<Option<usize>, TrainError> {
        let seed = self.seed;
        match &mut self.examples {
            Examples::Memory {
                data,
                split,
                loaded,
                epoch,
                begins,
            } => {
                if !std::mem::take(begins) {
                    return Ok(None);
                }
                let examples = split.part(part);
                if !loaded[part as usize] {
                    let task = &mut self.tasks[part as usize];
                    // The old order's tensors go before the new one's come.
                    task.load(data, &[]);
                    match epoch {
                        Some(epoch) => {
                            let order = permuted(examples, Stream::Order(*epoch), seed);
                            task.load(data, &order);
                        }
                        None => task.load(data, examples),
                    }
                    loaded[part as usize] = epoch.is_none();
                }
                Ok((!examples.is_empty()).then_some(examples.len()))
            }
            Examples::Streamed(windows) => {
                // One window is in memory, whichever part it is of.
                for task in &mut self.tasks {
                    task.load(&windows.empty, &[]);
                }
                let Some(order) = windows.next(seed)? else {
                    return Ok(None);
                };
                self.tasks[part as usize].load(&windows.buffer, &order);
                Ok(Some(order.len()))
            }
        }
    }

    /// The task of a part, with the window that was loaded last.
    pub(crate) fn task(&self, part: Part) -> &dyn Task {
        &*self.tasks[part as usize]
    }
}

fn permuted(examples: &[u32], stream: Stream, seed: u64) -> Vec<u32> {
    let order = stream.of(seed).permutation(examples.len() as u32);
    order.into_iter().map(|i| examples[i as usize]).collect()
}

/// The windows of streamed examples.
pub(crate) struct Windows<'a> {
    data: &'a StreamedData,
    /// Rows in memory.
    most: u64,
    batch: usize,
    /// Columns without rows.
    empty: TrainingData,
    /// The rows of the window.
    buffer: TrainingData,
    /// Of the pass.
    part: Part,
    epoch: Option<u32>,
    blocks: Vec<Block>,
    /// Blocks and rows that were read, windows that were made, and windows in all.
    next: usize,
    read: u64,
    window: u64,
    windows: u64,
    rows: u64,
    /// Examples that did not fill a batch: their words and their number.
    left: (Vec<u8>, usize),
    bytes: Vec<u8>,
}

impl<'a> Windows<'a> {
    pub(crate) fn new(data: &'a StreamedData, config: &Config, most: u64) -> Self {
        Self {
            data,
            most: most.max(1),
            batch: config.batch,
            empty: TrainingData::of_recipe(config.recipe),
            buffer: TrainingData::of_recipe(config.recipe),
            part: Part::Train,
            epoch: None,
            blocks: Vec::new(),
            next: 0,
            read: 0,
            window: 0,
            windows: 0,
            rows: 0,
            left: (Vec::new(), 0),
            bytes: Vec::new(),
        }
    }

    fn begin(&mut self, part: Part, epoch: Option<u32>) {
        self.part = part;
        self.epoch = epoch;
        self.blocks.clear();
        self.rows = self.data.scratch.blocks[part as usize]
            .iter()
            .map(|block| u64::from(block.rows))
            .sum();
        self.windows = self.rows.div_ceil(self.most);
        (self.next, self.read, self.window) = (0, 0, 0);
        self.left.0.clear();
        self.left.1 = 0;
    }

    /// Fills the buffer with the examples of the next window and returns their order.
    fn next(&mut self, seed: u64) -> Result<Option<Vec<u32>>, TrainError> {
        let stored = &self.data.scratch.blocks[self.part as usize];
        if self.next == 0 {
            self.blocks = match self.epoch {
                Some(epoch) => {
                    let order = Stream::Blocks(epoch)
                        .of(seed)
                        .permutation(stored.len() as u32);
                    order.into_iter().map(|i| stored[i as usize]).collect()
                }
                None => stored.clone(),
            };
        }
        self.buffer.clear();
        let (bytes, examples) = &mut self.left;
        decode(bytes, *examples, &mut self.buffer);
        bytes.clear();
        *examples = 0;
        self.window += 1;
        let end = (u128::from(self.rows) * u128::from(self.window)
            / u128::from(self.windows.max(1))) as u64;
        // Whole batches to learn from; for judging, something.
        let least = if self.part == Part::Train {
            self.batch
        } else {
            1
        };
        let begin = self.next;
        let (mut rows, mut examples) = (self.buffer.rows(), self.buffer.examples());
        while let Some(&block) = self.blocks.get(self.next)
            && (self.read < end || examples < least)
        {
            self.next += 1;
            self.read += u64::from(block.rows);
            rows += block.rows as usize;
            examples += block.examples as usize;
        }
        // At once: a column that grows while it is filled is in memory twice.
        self.buffer.reserve(examples, rows);
        for &block in &self.blocks[begin..self.next] {
            let before = self.buffer.weights.as_ref().map_or(0, Vec::len);
            self.data
                .scratch
                .read(block, &mut self.bytes, &mut self.buffer)?;
            if let Some(weights) = &mut self.buffer.weights {
                self.data
                    .weights
                    .apply(block.view as usize, &mut weights[before..]);
            }
        }
        let examples = self.buffer.examples() as u32;
        if examples == 0 {
            return Ok(None);
        }
        let mut order = match self.epoch {
            Some(epoch) => Stream::Window(epoch, self.window)
                .of(seed)
                .permutation(examples),
            None => (0..examples).collect(),
        };
        if self.part == Part::Train && self.next < self.blocks.len() {
            let whole = order.len() / self.batch * self.batch;
            let (bytes, left) = &mut self.left;
            encode(&self.buffer, &order[whole..], bytes);
            *left = order.len() - whole;
            order.truncate(whole);
        }
        Ok(Some(order))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use peelnet_core::random::Random;
    use peelnet_dataset::Subset;
    use peelnet_model::Recipe;

    use super::*;
    use crate::scratch::{BLOCK_ROWS, Scratch};
    use crate::training_data::PixelFixed;

    /// Pixels of 1 to 12 rows with their number in every column, a third of them for testing.
    fn view(recipe: Recipe, first: u32, pixels: u32, random: &mut Random) -> TrainingData {
        let mut data = TrainingData::of_recipe(recipe);
        for id in first..first + pixels {
            let (rows, value) = (1 + id % 12, id as f32);
            if let Some(columns) = &mut data.pixels {
                columns.first.push(data.targets[0].len() as u32);
                columns.fixed.push(PixelFixed {
                    left: value,
                    sum: value + 0.25,
                    color: [value + 0.5; 3],
                    exact: [value, value + 1.0, value + 2.0],
                });
                let all = [&mut columns.rest, &mut columns.alpha].into_iter();
                for column in all.chain(&mut columns.color) {
                    column.extend((0..rows).map(|_| value));
                }
            }
            let rows = if data.pixels.is_some() { rows } else { 1 };
            for column in data.inputs.iter_mut().chain(&mut data.targets) {
                column.extend((0..rows).map(|_| value));
            }
            let subset = if random.unit() < 0.33 {
                Subset::Test
            } else {
                Subset::Train
            };
            data.weights.iter_mut().for_each(|w| w.push(value));
            data.subsets.iter_mut().for_each(|s| s.push(subset));
        }
        data
    }

    /// The number of an example of a window, where all that belongs to it is there.
    fn id(data: &TrainingData, example: u32) -> u32 {
        let id = match &data.pixels {
            Some(pixels) => pixels.fixed[example as usize].left as u32,
            None => data.inputs[0][example as usize] as u32,
        };
        let (rows, value) = (data.rows_of(example), id as f32);
        let mut columns: Vec<_> = data.inputs.iter().chain(&data.targets).collect();
        if let Some(pixels) = &data.pixels {
            assert_eq!(rows.len() as u32, 1 + id % 12, "whole pixels");
            columns.extend([&pixels.rest, &pixels.alpha]);
            columns.extend(&pixels.color);
            let fixed = pixels.fixed[example as usize];
            assert_eq!(fixed.sum, value + 0.25);
            assert_eq!(fixed.color, [value + 0.5; 3]);
            assert_eq!(fixed.exact, [value, value + 1.0, value + 2.0]);
        }
        for column in columns {
            let values = &column[rows.start as usize..rows.end as usize];
            assert!(values.iter().all(|&v| v == value));
        }
        // The weights of every view are multiplied by its number and one, in the test's data.
        if let Some(weights) = &data.weights {
            assert_eq!(weights[example as usize], value * (1 + id / 100_000) as f32);
        }
        id
    }

    /// Whatever the buffer and the batch, an epoch has every example of its part once, batches are whole but for the last, a buffer
    /// holds no more than was asked, a block, a batch and what was left over, and epochs have different orders.
    #[test]
    fn every_example_is_in_one_window_of_an_epoch() {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Random::new(3, &[1]);
        for recipe in [Recipe::THESIS, Recipe::NMT, Recipe::MEDIUM] {
            let mut scratch = Scratch::create(folder.path()).unwrap();
            let mut expected: [Vec<u32>; 2] = Default::default();
            let mut total = 0;
            for number in 0..3 {
                let data = view(recipe, number * 100_000, 1 + number * 7000, &mut random);
                for (example, subset) in (0u32..).zip(data.subsets.iter().flatten()) {
                    let part = usize::from(*subset == Subset::Test);
                    expected[part].push(number * 100_000 + example);
                }
                total += data.rows() as u64;
                scratch.write(number, &data, |_, _| {}).unwrap();
            }
            let stored = StreamedData::for_tests(scratch, total);
            for (most, batch) in [(1, 1), (900, 64), (5000, 7), (30_000, 1000), (1 << 20, 96)] {
                let config = Config {
                    batch,
                    ..Config::for_recipe(recipe)
                };
                let mut windows = Windows::new(&stored, &config, most);
                let mut pass = |part, epoch| {
                    windows.begin(part, epoch);
                    let (mut seen, mut whole) = (Vec::new(), true);
                    while let Some(order) = windows.next(5).unwrap() {
                        assert!(whole, "only the last window has a part of a batch");
                        whole = part == Part::Test || order.len().is_multiple_of(batch);
                        let room = most as usize + 2 * BLOCK_ROWS + 24 * batch;
                        assert!(windows.buffer.rows() <= room);
                        seen.extend(order.iter().map(|&e| id(&windows.buffer, e)));
                    }
                    (seen, windows.blocks.clone())
                };
                let (test, _) = pass(Part::Test, None);
                assert_eq!(test, expected[1], "in the order of the views");
                let [first, second] = [1, 2].map(|epoch| pass(Part::Train, Some(epoch)));
                assert_ne!(first.0, second.0);
                assert_ne!(first.1, second.1, "the order of the blocks");
                assert_eq!(pass(Part::Train, Some(1)), first);
                for (mut seen, _) in [first, second] {
                    assert_ne!(seen, expected[0]);
                    seen.sort_unstable();
                    assert!(
                        seen == expected[0],
                        "{recipe}, {most} rows, batches of {batch}"
                    );
                }
            }
        }
    }
}
