//! Examples on disk, in blocks that are read in any order.
//!
//! A block holds whole examples of one subset of one view, column after column: those of rows, those of examples, and for each example that is
//! a pixel its number of rows. All are little-endian 32-bit words. The file has no name, so it is gone when the process ends, however it ends.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use peelnet_dataset::Subset;

use crate::error::{TrainError, io};
use crate::examples::ViewWeights;
use crate::normalise::Moments;
use crate::table::TrainingData;

/// Rows of a block, more where a single pixel has more. Blocks are read in a random order: a smaller block mixes better, a larger one
/// takes fewer requests.
pub(crate) const BLOCK_ROWS: usize = 4096;

/// What examples are for, in the order of [`Subset`].
pub(crate) const SUBSETS: [Subset; 3] = [Subset::Train, Subset::Validation, Subset::Test];

/// Where a block lies and what it holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    offset: u64,
    bytes: u32,
    pub(crate) examples: u32,
    pub(crate) rows: u32,
    view: u32,
}

/// The file, and what is known of all examples in it.
#[derive(Debug)]
pub(crate) struct Scratch {
    file: Mutex<File>,
    /// Where it lies, for messages.
    folder: PathBuf,
    /// By subset, in the order of the views.
    pub(crate) blocks: [Vec<Block>; 3],
    pub(crate) bytes: u64,
    pub(crate) rows: u64,
    /// Of each input, over the examples that train, merged block by block.
    pub(crate) moments: Vec<Moments>,
    pub(crate) weights: ViewWeights,
}

impl Scratch {
    /// An empty file for examples with so many inputs, in a folder, which is made if it is not there.
    pub(crate) fn create(folder: &Path, inputs: usize) -> Result<Self, TrainError> {
        let file = std::fs::create_dir_all(folder)
            .and_then(|()| tempfile::tempfile_in(folder))
            .map_err(io(folder))?;
        Ok(Self {
            file: Mutex::new(file),
            folder: folder.to_owned(),
            blocks: Default::default(),
            bytes: 0,
            rows: 0,
            moments: vec![Moments::NONE; inputs],
            weights: ViewWeights::default(),
        })
    }

    pub(crate) fn examples(&self, subset: Subset) -> u64 {
        let blocks = self.blocks.get(subset as usize).into_iter().flatten();
        blocks.map(|block| u64::from(block.examples)).sum()
    }

    fn failed(&self) -> impl Fn(std::io::Error) -> TrainError + '_ {
        |error| {
            TrainError::Failed(format!(
                "the scratch file of streamed training in {}: {error}; it needs room for all examples",
                self.folder.display()
            ))
        }
    }

    /// Writes all examples of a view as blocks of their subsets.
    pub(crate) fn write(&mut self, view: usize, data: &TrainingData) -> Result<(), TrainError> {
        let mut bytes = Vec::new();
        self.rows += data.rows_held() as u64;
        for subset in SUBSETS {
            let examples = (0u32..).zip(data.subsets.iter().flatten());
            let examples = examples.filter(|(_, s)| **s == subset);
            let examples: Vec<u32> = examples.map(|(example, _)| example).collect();
            let mut left = examples.as_slice();
            while !left.is_empty() {
                let mut rows = 0;
                let fits = left.iter().take_while(|&&example| {
                    rows += data.rows_of(example).len();
                    rows <= BLOCK_ROWS
                });
                let (block, rest) = left.split_at(fits.count().max(1));
                left = rest;
                bytes.clear();
                encode(data, block, &mut bytes);
                let file = self.file.get_mut().unwrap_or_else(|e| e.into_inner());
                let written = file.write_all(&bytes);
                written.map_err(self.failed())?;
                let rows: Vec<u32> = block.iter().flat_map(|&e| data.rows_of(e)).collect();
                self.blocks[subset as usize].push(Block {
                    offset: self.bytes,
                    bytes: bytes.len() as u32,
                    examples: block.len() as u32,
                    rows: rows.len() as u32,
                    view: view as u32,
                });
                self.bytes += bytes.len() as u64;
                if subset == Subset::Train {
                    for (moments, values) in self.moments.iter_mut().zip(&data.inputs) {
                        *moments = moments.merge(Moments::over(values, &rows));
                    }
                }
            }
        }
        Ok(())
    }

    /// Appends the examples of a block. `bytes` is room that is used again.
    pub(crate) fn read(
        &self,
        block: Block,
        bytes: &mut Vec<u8>,
        to: &mut TrainingData,
    ) -> Result<(), TrainError> {
        bytes.resize(block.bytes as usize, 0);
        let mut file = self.file.lock().unwrap_or_else(|e| e.into_inner());
        file.seek(SeekFrom::Start(block.offset))
            .and_then(|_| file.read_exact(bytes))
            .map_err(self.failed())?;
        let before = to.weights.as_ref().map_or(0, Vec::len);
        decode(bytes, block.examples as usize, to);
        if let Some(weights) = &mut to.weights {
            self.weights
                .apply(block.view as usize, &mut weights[before..]);
        }
        Ok(())
    }
}

/// Appends examples as the words of a block.
pub(crate) fn encode(data: &TrainingData, examples: &[u32], to: &mut Vec<u8>) {
    let rows: Vec<u32> = examples.iter().flat_map(|&e| data.rows_of(e)).collect();
    let mut words = |column: &[f32], at: &[u32]| {
        let values = at.iter().map(|&i| column[i as usize]);
        values.for_each(|value| to.extend_from_slice(&value.to_le_bytes()));
    };
    data.row_columns().for_each(|column| words(column, &rows));
    data.example_columns()
        .for_each(|column| words(column, examples));
    if data.pixels.is_some() {
        for &example in examples {
            let rows = data.rows_of(example).len() as u32;
            to.extend_from_slice(&rows.to_le_bytes());
        }
    }
}

/// Appends the examples of a block to columns of the same recipe.
pub(crate) fn decode(bytes: &[u8], examples: usize, to: &mut TrainingData) {
    let (mut words, _) = bytes.as_chunks::<4>();
    // Words of examples lie at the end. All before them are of rows.
    let mut first = to.rows_held() as u32;
    if let Some(pixels) = &mut to.pixels {
        let (left, counts) = words.split_at(words.len() - examples);
        words = left;
        for &rows in counts {
            pixels.first.push(first);
            first += u32::from_le_bytes(rows);
        }
    }
    let of_examples = to.example_columns().count() * examples;
    let (of_rows, of_examples) = words.split_at(words.len() - of_examples);
    let rows = of_rows.len() / to.row_columns().count();
    let fill = |(column, words): (&mut Vec<f32>, &[[u8; 4]])| {
        column.extend(words.iter().map(|&word| f32::from_le_bytes(word)));
    };
    let words = of_rows.chunks_exact(rows.max(1));
    to.row_columns_mut().zip(words).for_each(fill);
    let words = of_examples.chunks_exact(examples.max(1));
    to.example_columns_mut().zip(words).for_each(fill);
}
