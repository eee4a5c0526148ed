//! Examples on disk, in blocks that are read in any order.
//!
//! A block holds whole examples of one part (training, validation or test) of one view, column after column: for each example that is a
//! pixel its number of rows; the inputs, targets and what pixels have beside them; for each example its weight. All are little-endian
//! 32-bit words. The file has no name, so it is gone when the process ends, however it ends.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use peelnet_dataset::Subset;

use crate::error::TrainError;
use crate::task::Part;
use crate::training_data::{PixelFixed, TrainingData};

/// Rows of a block, more where a single pixel has more. Blocks are read in a random order: a smaller block mixes better, a larger one
/// takes fewer requests.
pub(crate) const BLOCK_ROWS: usize = 4096;

/// Numbers of a [`PixelFixed`].
const FIXED: usize = 8;

/// Where a block lies and what it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    offset: u64,
    /// Words of 32 bits.
    words: u32,
    pub(crate) examples: u32,
    pub(crate) rows: u32,
    pub(crate) view: u32,
}

/// The file, and its blocks by part, in the order of the views.
#[derive(Debug)]
pub(crate) struct Scratch {
    file: Mutex<File>,
    /// Where it lies, for messages.
    folder: PathBuf,
    pub(crate) blocks: [Vec<Block>; 3],
    bytes: u64,
}

/// The part that examples of a subset are for.
const fn part(subset: Subset) -> Option<Part> {
    match subset {
        Subset::Train => Some(Part::Train),
        Subset::Validation => Some(Part::Validation),
        Subset::Test => Some(Part::Test),
        Subset::HeldOut => None,
    }
}

impl Scratch {
    /// An empty file in a folder, which is made if it is not there.
    pub(crate) fn create(folder: &Path) -> Result<Self, TrainError> {
        let file = std::fs::create_dir_all(folder)
            .and_then(|()| tempfile::tempfile_in(folder))
            .map_err(|error| TrainError::Io {
                path: folder.to_owned(),
                error,
            })?;
        Ok(Self {
            file: Mutex::new(file),
            folder: folder.to_owned(),
            blocks: Default::default(),
            bytes: 0,
        })
    }

    /// Bytes that were written.
    pub(crate) const fn bytes(&self) -> u64 {
        self.bytes
    }

    fn io(&self) -> impl Fn(std::io::Error) -> TrainError + '_ {
        |error| TrainError::Scratch {
            folder: self.folder.clone(),
            error,
        }
    }

    /// Writes all examples of a view as blocks of their parts. `each` gets the examples of every block.
    pub(crate) fn write(
        &mut self,
        view: u32,
        data: &TrainingData,
        mut each: impl FnMut(Part, &[u32]),
    ) -> Result<(), TrainError> {
        let mut parts: [Vec<u32>; 3] = Default::default();
        for (example, &subset) in (0u32..).zip(data.subsets.iter().flatten()) {
            if let Some(part) = part(subset) {
                parts[part as usize].push(example);
            }
        }
        let mut bytes = Vec::new();
        for (part, examples) in [Part::Train, Part::Validation, Part::Test]
            .into_iter()
            .zip(&parts)
        {
            let mut left = examples.as_slice();
            while !left.is_empty() {
                let mut rows = 0;
                let fits = left.iter().take_while(|&&example| {
                    rows += data.rows_of(example).len();
                    rows <= BLOCK_ROWS
                });
                let (block, rest) = left.split_at(fits.count().max(1));
                bytes.clear();
                encode(data, block, &mut bytes);
                let rows: usize = block
                    .iter()
                    .map(|&example| data.rows_of(example).len())
                    .sum();
                let file = self.file.get_mut().unwrap_or_else(|e| e.into_inner());
                let written = file.write_all(&bytes);
                written.map_err(self.io())?;
                self.blocks[part as usize].push(Block {
                    offset: self.bytes,
                    words: (bytes.len() / 4) as u32,
                    examples: block.len() as u32,
                    rows: rows as u32,
                    view,
                });
                self.bytes += bytes.len() as u64;
                each(part, block);
                left = rest;
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
        bytes.resize(4 * block.words as usize, 0);
        let mut file = self.file.lock().unwrap_or_else(|e| e.into_inner());
        file.seek(SeekFrom::Start(block.offset))
            .and_then(|_| file.read_exact(bytes))
            .map_err(self.io())?;
        decode(bytes, block.examples as usize, to);
        Ok(())
    }
}

/// Appends examples as the words of a block.
pub(crate) fn encode(data: &TrainingData, examples: &[u32], to: &mut Vec<u8>) {
    let rows = || examples.iter().flat_map(|&e| data.rows_of(e));
    let mut words = |values: &[f32]| {
        for row in rows() {
            to.extend_from_slice(&values[row as usize].to_le_bytes());
        }
    };
    data.inputs
        .iter()
        .chain(&data.targets)
        .for_each(|c| words(c));
    if let Some(pixels) = &data.pixels {
        [&pixels.rest, &pixels.alpha]
            .into_iter()
            .chain(&pixels.color)
            .for_each(|c| words(c));
        for &example in examples {
            let PixelFixed {
                left,
                sum,
                color,
                exact,
            } = pixels.fixed[example as usize];
            for value in [left, sum].into_iter().chain(color).chain(exact) {
                to.extend_from_slice(&value.to_le_bytes());
            }
        }
        for &example in examples {
            let rows = data.rows_of(example).len() as u32;
            to.extend_from_slice(&rows.to_le_bytes());
        }
    }
    if let Some(weights) = &data.weights {
        for &example in examples {
            to.extend_from_slice(&weights[example as usize].to_le_bytes());
        }
    }
}

/// Appends the examples of a block to columns of the same recipe.
pub(crate) fn decode(bytes: &[u8], examples: usize, to: &mut TrainingData) {
    let (mut words, _) = bytes.as_chunks::<4>();
    // Values of examples lie at the end and are taken off first. All before them are values of rows.
    let mut last = |count: usize| {
        let (left, last) = words.split_at(words.len() - count);
        words = left;
        last
    };
    let floats = |words: &[[u8; 4]], to: &mut Vec<f32>| {
        to.extend(words.iter().map(|&word| f32::from_le_bytes(word)));
    };
    if let Some(weights) = &mut to.weights {
        floats(last(examples), weights);
    }
    let mut first = to.targets[0].len() as u32;
    let mut columns: Vec<&mut Vec<f32>> = to.inputs.iter_mut().chain(&mut to.targets).collect();
    if let Some(pixels) = &mut to.pixels {
        for &rows in last(examples) {
            pixels.first.push(first);
            first += u32::from_le_bytes(rows);
        }
        for words in last(FIXED * examples).as_chunks::<FIXED>().0 {
            let [left, sum, r, g, b, er, eg, eb] = words.map(f32::from_le_bytes);
            pixels.fixed.push(PixelFixed {
                left,
                sum,
                color: [r, g, b],
                exact: [er, eg, eb],
            });
        }
        columns.extend([&mut pixels.rest, &mut pixels.alpha]);
        columns.extend(&mut pixels.color);
    }
    let rows = words.len() / columns.len();
    for (column, words) in columns.into_iter().zip(words.chunks_exact(rows.max(1))) {
        floats(words, column);
    }
}
