//! Opening a dataset and reading its rows.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::column::{Column, FragmentBatch};
use crate::error::DatasetError;
use crate::formats::{Format, PartSource};
use crate::manifest::{EXTRACT_AGAIN, Manifest, Part};
use crate::parts;
use crate::plan::Plan;
use crate::store::{Fetched, Store, open_store};

/// Rows that are read and checked at once.
const CHUNK_ROWS: usize = 1 << 16;

/// Rows of one pixel that are read: a batch holds whole pixels, so this bounds its memory.
const MAX_PIXEL_ROWS: usize = 1 << 22;

/// A dataset that was opened.
#[derive(Clone, Debug)]
pub struct Dataset {
    path: PathBuf,
    manifest: Manifest,
    store: Arc<dyn Store>,
    /// For each part, by file: whether its hash was compared with the manifest's.
    verified: Arc<Vec<Vec<AtomicBool>>>,
}

impl Dataset {
    /// Opens a sealed dataset. Checks the manifest and that every file is there with its right length. A file's contents are checked when
    /// its rows are read, or all at once by [`Dataset::verify`].
    ///
    /// # Errors
    /// If parts or the seal are missing, the manifest is missing or wrong, or a file is missing or has another length.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, DatasetError> {
        let path = path.as_ref();
        let store = open_store(path)?;
        let plan = Plan::read(&*store)?;
        let Some(manifest) = Manifest::read(&*store)? else {
            return Err(match plan {
                Some(plan) => parts::unsealed(&*store, &plan)?,
                None => parts::no_manifest(path),
            });
        };
        if plan.is_some_and(|plan| !plan.agrees_with(&manifest)) {
            let reason = "the manifest and the plan say different things, one of them was edited; write the dataset again with `peelnet extract`";
            return Err(DatasetError::invalid(path, reason));
        }
        parts::check_files(&*store, &manifest, false)?;
        let files = |part: &Part| part.files.iter().map(|_| AtomicBool::new(false)).collect();
        Ok(Self {
            path: path.to_owned(),
            verified: Arc::new(manifest.parts.iter().map(files).collect()),
            manifest,
            store,
        })
    }

    /// Recomputes the sha256 of every file.
    ///
    /// # Errors
    /// Names the first file that differs from the manifest.
    pub fn verify(&self) -> Result<(), DatasetError> {
        for (k, part) in self.manifest.parts.iter().enumerate() {
            for (file, entry) in part.files.iter().enumerate() {
                self.verify_file(k, file, &self.store.fetch(&entry.name)?)?;
            }
        }
        Ok(())
    }

    /// Compares the hash of a part's file with the manifest's.
    fn verify_file(&self, k: usize, file: usize, fetched: &Fetched) -> Result<(), DatasetError> {
        let part = &self.manifest.parts[k];
        parts::check_hash(&*self.store, part.index, &part.files[file], fetched)?;
        self.verified[k][file].store(true, Ordering::Relaxed);
        Ok(())
    }

    /// The folder that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.manifest.rows
    }

    /// The dataset's hash: the same for the same rows in the same format, sharded or not.
    pub fn hash(&self) -> &str {
        &self.manifest.hash
    }

    /// Whether a part belongs to a scene that must not be trained on.
    pub fn is_held_out(&self, part: &Part) -> bool {
        self.manifest.scenes[part.scene as usize].held_out
    }

    /// All rows in order, as batches of whole pixels with about `rows_per_batch` rows (more where a single pixel has
    /// more). Memory does not grow with the dataset.
    pub fn batches(&self, rows_per_batch: usize) -> Batches<'_> {
        self.batches_where(rows_per_batch, |_| true)
    }

    /// As [`Dataset::batches`], of the parts that the filter keeps.
    pub fn batches_where(
        &self,
        rows_per_batch: usize,
        mut keep: impl FnMut(&Part) -> bool,
    ) -> Batches<'_> {
        let parts = (0..self.manifest.parts.len()).filter(|&k| keep(&self.manifest.parts[k]));
        let parts: Vec<usize> = parts.collect();
        Batches {
            dataset: self,
            rows_per_batch: rows_per_batch.max(1),
            parts: parts.into_iter(),
            current: None,
            held_back: FragmentBatch::default(),
        }
    }

    /// Calls `each` with pieces of columns, in order; the other columns are empty. Parquet and NPY read these columns only, and memory does
    /// not grow with the dataset.
    pub fn read_pieces(
        &self,
        columns: &[Column],
        mut keep: impl FnMut(&Part) -> bool,
        mut each: impl FnMut(&FragmentBatch),
    ) -> Result<(), DatasetError> {
        let mut columns = columns.to_vec();
        columns.sort();
        columns.dedup();
        if columns.is_empty() {
            return Ok(());
        }
        let mut table = FragmentBatch::default();
        for k in (0..self.manifest.parts.len()).filter(|&k| keep(&self.manifest.parts[k])) {
            let mut part = OpenPart::open(self, k, &columns)?;
            while part.read(CHUNK_ROWS, &mut table)? > 0 {
                each(&table);
                table.clear();
            }
        }
        Ok(())
    }

    /// Reads columns into memory; the other columns are empty. Parquet and NPY read these columns only; memory grows with the rows.
    pub fn read_columns(&self, columns: &[Column]) -> Result<FragmentBatch, DatasetError> {
        // No room is taken ahead: the manifest can promise any number of rows.
        let mut all = FragmentBatch::default();
        self.read_pieces(columns, |_| true, |piece| all.append(piece))?;
        Ok(all)
    }
}

/// A part that is being read: checks the values and counts the rows.
struct OpenPart<'a> {
    part: &'a Part,
    columns: Vec<Column>,
    source: Box<dyn PartSource>,
    /// The files of the columns, or the one of all; copies live as long as this.
    files: Vec<Fetched>,
    rows: u64,
    /// Whether the manifest says of it what its writer recorded.
    is_as_recorded: bool,
}

impl<'a> OpenPart<'a> {
    fn open(dataset: &'a Dataset, k: usize, columns: &[Column]) -> Result<Self, DatasetError> {
        let format = dataset.manifest.format;
        let part = &dataset.manifest.parts[k];
        let numbers = format.files_of(columns);
        let fetch = |&file: &usize| dataset.store.fetch(&part.files[file].name);
        let files: Vec<Fetched> = numbers.iter().map(fetch).collect::<Result<_, _>>()?;
        // Once for all readers.
        let is_verified = |file: usize| dataset.verified[k][file].load(Ordering::Relaxed);
        let mut unverified = numbers
            .iter()
            .zip(&files)
            .filter(|(f, _)| !is_verified(**f));
        let verified = unverified.try_for_each(|(&f, file)| dataset.verify_file(k, f, file));
        let verified = match verified {
            // The reader of its pages panics on some that were changed, and takes memory by what they say.
            Err(error) if format == Format::Parquet => return Err(error),
            verified => verified,
        };
        let mut open = Self {
            part,
            columns: columns.to_vec(),
            source: format.source(&files, columns, part.rows)?,
            files,
            rows: 0,
            is_as_recorded: parts::is_as_recorded(&*dataset.store, part)?,
        };
        if verified.is_err() {
            // The place of what is wrong says more than a hash.
            let mut table = FragmentBatch::default();
            while open.read(CHUNK_ROWS, &mut table)? > 0 {
                table.clear();
            }
        }
        verified.map(|()| open)
    }

    /// The path of a column's file, for messages.
    fn shown(&self, k: usize) -> &Path {
        &self.files[k.min(self.files.len() - 1)].shown
    }

    /// Appends up to `max` rows and says how many; 0 at the end.
    fn read(&mut self, max: usize, table: &mut FragmentBatch) -> Result<usize, DatasetError> {
        // Where this part reads some columns only, the table is empty.
        let before = table.len();
        let count = self.source.read(max, table)?;
        for (k, &column) in self.columns.iter().enumerate() {
            table.check_column(self.shown(k), column, before, self.rows, self.part)?;
        }
        self.rows += count as u64;
        if (count == 0 && self.rows < self.part.rows) || self.rows > self.part.rows {
            let (rows, expected) = (self.rows, self.part.rows);
            let reason = format!("{rows} rows where the manifest says {expected}");
            return Err(DatasetError::changed(self.shown(0), reason));
        }
        if count == 0 && !self.is_as_recorded {
            let reason = format!(
                "the manifest and _peelnet/parts say different things of part {}, one of them was edited; {EXTRACT_AGAIN}",
                self.part.index
            );
            return Err(DatasetError::invalid(self.shown(0), reason));
        }
        Ok(count)
    }
}

/// Streams a dataset's rows, see [`Dataset::batches`]. Ends after the first error.
pub struct Batches<'a> {
    dataset: &'a Dataset,
    rows_per_batch: usize,
    parts: std::vec::IntoIter<usize>,
    current: Option<OpenPart<'a>>,
    /// Rows of the last pixel that was read, which may go on.
    held_back: FragmentBatch,
}

impl Batches<'_> {
    fn next_batch(&mut self) -> Result<Option<FragmentBatch>, DatasetError> {
        let mut batch = std::mem::take(&mut self.held_back);
        loop {
            let mut part = match self.current.take() {
                Some(part) => part,
                None => match self.parts.next() {
                    Some(k) => OpenPart::open(self.dataset, k, &Column::ALL)?,
                    None => return Ok((!batch.is_empty()).then_some(batch)),
                },
            };
            // As many again of a pixel that fills the batch: looking for its end takes as long as there are rows.
            let wanted = match self.rows_per_batch.saturating_sub(batch.len()) {
                0 => batch.len(),
                wanted => wanted,
            };
            let ended = part.read(wanted.clamp(1, CHUNK_ROWS), &mut batch)? == 0;
            let is_full = batch.len() >= self.rows_per_batch;
            // Parts are views: a pixel never goes on in the next one. Of a part that goes on, its last pixel may.
            let end = match batch.len() {
                rows if ended || !is_full => rows,
                rows => (1..rows)
                    .rev()
                    .find(|&i| !batch.same_pixel(i - 1, rows - 1))
                    .unwrap_or(0),
            };
            if end == 0 && batch.len() > MAX_PIXEL_ROWS {
                let (x, y) = (batch.x[0], batch.y[0]);
                let reason = format!(
                    "pixel ({x}, {y}) has more than {MAX_PIXEL_ROWS} fragments; leave it out, or write the dataset again"
                );
                return Err(DatasetError::invalid(part.shown(0), reason));
            }
            self.current = (!ended).then_some(part);
            // A single pixel may fill the batch: then it is read on until that ends.
            if is_full && end > 0 {
                self.held_back.extend_from(&batch, end..batch.len());
                batch.truncate(end);
                return Ok(Some(batch));
            }
        }
    }
}

impl Iterator for Batches<'_> {
    type Item = Result<FragmentBatch, DatasetError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_batch();
        if next.is_err() {
            self.parts = Vec::new().into_iter();
        }
        next.transpose()
    }
}
