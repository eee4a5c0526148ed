//! Opening a dataset and reading its rows.

use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::batch::FragmentBatch;
use crate::column::{Column, ColumnData, ColumnMut, ColumnSlice};
use crate::error::DatasetError;
use crate::format::Format;
use crate::formats::PartSource;
use crate::hashed_file::hash_file;
use crate::layout::OLD_MANIFEST;
use crate::manifest::{Manifest, Part};
use crate::old_shards;
use crate::plan::Plan;
use crate::record::PartRecord;
use crate::seal::{self, unsealed};
use crate::store::{Fetched, Place, Store};
use crate::validate::check_column;

/// Rows that are read and checked at once.
const CHUNK_ROWS: usize = 1 << 16;

/// Rows of one pixel that are read: a batch holds whole pixels, so this bounds its memory.
const MAX_PIXEL_ROWS: usize = 1 << 22;

/// A dataset that was opened: one folder, or all shards of one.
#[derive(Clone, Debug)]
pub struct Dataset {
    path: PathBuf,
    manifest: Manifest,
    /// Folder of each part, parallel to `manifest.parts`.
    folders: Vec<PathBuf>,
    /// Where it lies; `None` in schema 1.
    store: Option<Arc<dyn Store>>,
    /// For each part, by file: whether its hash was compared with the manifest's.
    verified: Arc<Vec<Vec<AtomicBool>>>,
}

impl Dataset {
    /// Opens a sealed dataset, or one of schema 1: a folder with a `manifest.json`, or one that holds all `shard-I-of-N` folders of one.
    /// Checks the manifest and that every file is there with its right length. A file's contents are checked when its rows are read, or all
    /// at once by [`Dataset::verify`].
    ///
    /// # Errors
    /// [`DatasetError::Unsealed`] if parts or the seal are missing; if the manifest is missing or wrong, a file is missing or has another
    /// length, or, in schema 1, shards are missing or come from different runs.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, DatasetError> {
        let path = path.as_ref();
        let place = Place::of(path)?;
        let store = place.store();
        if let Some(manifest) = Manifest::read_sealed(&*store)? {
            let folders = vec![path.to_owned(); manifest.parts.len()];
            let dataset = Self::new(path, manifest, folders, Some(store));
            dataset.check_sizes()?;
            return Ok(dataset);
        }
        if let Some(plan) = Plan::read(&*store)? {
            return Err(unsealed(path, &plan, &seal::missing(&*store, &plan)?));
        }
        let Place::Folder(folder) = place else {
            return Err(DatasetError::NoManifest {
                path: path.to_owned(),
            });
        };
        let dataset = if folder.join(OLD_MANIFEST).exists() {
            let manifest = Manifest::read_old(&folder)?;
            let folders = vec![folder.clone(); manifest.parts.len()];
            Self::new(&folder, manifest, folders, None)
        } else {
            let (manifest, folders) = old_shards::open(&folder)?;
            Self::new(&folder, manifest, folders, None)
        };
        dataset.check_sizes()?;
        Ok(dataset)
    }

    fn new(
        path: &Path,
        manifest: Manifest,
        folders: Vec<PathBuf>,
        store: Option<Arc<dyn Store>>,
    ) -> Self {
        let files = |part: &Part| part.files.iter().map(|_| AtomicBool::new(false)).collect();
        Self {
            path: path.to_owned(),
            verified: Arc::new(manifest.parts.iter().map(files).collect()),
            manifest,
            folders,
            store,
        }
    }

    fn check_sizes(&self) -> Result<(), DatasetError> {
        let listed: Option<BTreeMap<String, u64>> = match &self.store {
            Some(store) => {
                let entries = store.list("")?.into_iter();
                Some(entries.map(|e| (e.name, e.bytes)).collect())
            }
            None => None,
        };
        for (k, part) in self.manifest.parts.iter().enumerate() {
            for file in &part.files {
                let path = self.folders[k].join(&file.name);
                let found = match &listed {
                    Some(listed) => listed
                        .get(&file.name)
                        .copied()
                        .ok_or_else(|| self.damaged(k, &path, "is missing".to_owned()))?,
                    None => fs::metadata(&path)
                        .map_err(DatasetError::io(&path, "find a file of the manifest"))?
                        .len(),
                };
                if found != file.bytes {
                    let reason = format!("{found} bytes where the manifest says {}", file.bytes);
                    return Err(self.changed(k, &path, reason));
                }
            }
        }
        Ok(())
    }

    /// The error of a file that was changed.
    fn changed(&self, part: usize, path: &Path, reason: String) -> DatasetError {
        if self.store.is_none() {
            return DatasetError::changed(path, reason);
        }
        self.damaged(part, path, format!("was cut or changed: {reason}"))
    }

    /// The error of a part's file, with the worker that wrote it.
    fn damaged(&self, part: usize, path: &Path, reason: String) -> DatasetError {
        let index = self.manifest.parts[part].index;
        let record = self
            .store
            .as_ref()
            .and_then(|store| PartRecord::read(&**store, index, None).ok().flatten());
        DatasetError::PartDamaged {
            path: path.to_owned(),
            index,
            worker: record.map_or_else(|| "unknown".to_owned(), |r| r.worker),
            reason,
        }
    }

    /// Recomputes the sha256 of every file.
    ///
    /// # Errors
    /// [`DatasetError::Changed`] names the first file that differs from the manifest.
    pub fn verify(&self) -> Result<(), DatasetError> {
        for (k, part) in self.manifest.parts.iter().enumerate() {
            (0..part.files.len()).try_for_each(|file| self.verify_file(k, file))?;
        }
        Ok(())
    }

    /// Compares the hash of a part's file with the manifest's.
    fn verify_file(&self, part: usize, file: usize) -> Result<(), DatasetError> {
        let fetched = self.fetch(part, file)?;
        self.verify_fetched(part, file, &fetched)
    }

    /// A part's file on this machine.
    fn fetch(&self, part: usize, file: usize) -> Result<Fetched, DatasetError> {
        let name = &self.manifest.parts[part].files[file].name;
        match &self.store {
            Some(store) => store.fetch(name),
            None => Ok(Fetched::in_place(self.folders[part].join(name))),
        }
    }

    fn verify_fetched(
        &self,
        part: usize,
        file: usize,
        fetched: &Fetched,
    ) -> Result<(), DatasetError> {
        let entry = &self.manifest.parts[part].files[file];
        let path = self.folders[part].join(&entry.name);
        let (_, found) = hash_file(&fetched.path).map_err(DatasetError::io(&path, "read"))?;
        if found != entry.sha256 {
            let reason = format!(
                "sha256 {found} where the manifest says {}",
                peelnet_files::printable(&entry.sha256)
            );
            return Err(self.changed(part, &path, reason));
        }
        self.verified[part][file].store(true, Ordering::Relaxed);
        Ok(())
    }

    /// The files of a part that its columns lie in, on this machine; the others have their names alone.
    fn fetch_columns(&self, part: usize, columns: &[Column]) -> Result<Vec<Fetched>, DatasetError> {
        let files = self.manifest.parts[part].files.iter().enumerate();
        files
            .map(|(file, entry)| match self.manifest.format {
                Format::Npy if columns.iter().all(|c| c.index() != file) => {
                    Ok(Fetched::in_place(self.folders[part].join(&entry.name)))
                }
                _ => self.fetch(part, file),
            })
            .collect()
    }

    /// Compares the hashes of what a part's columns lie in, once for all readers.
    fn verify_columns(
        &self,
        part: usize,
        columns: &[Column],
        fetched: &[Fetched],
    ) -> Result<(), DatasetError> {
        for (file, verified) in self.verified[part].iter().enumerate() {
            let is_read = match self.manifest.format {
                Format::Npy => columns.iter().any(|c| c.index() == file),
                Format::Csv | Format::Parquet => true,
            };
            if is_read && !verified.load(Ordering::Relaxed) {
                self.verify_fetched(part, file, &fetched[file])?;
            }
        }
        Ok(())
    }

    /// The folder that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The manifest; of shards, the manifest that the whole dataset would have (adapters that differ are listed).
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
        let parts = (0..self.manifest.parts.len())
            .filter(|&k| keep(&self.manifest.parts[k]))
            .collect();
        Batches {
            dataset: self,
            rows_per_batch: rows_per_batch.max(1),
            parts,
            current: None,
            held_back: FragmentBatch::default(),
            failed: false,
        }
    }

    /// Calls `each` with pieces of columns, in order; the other columns are empty. Parquet and NPY read these columns only, and memory does
    /// not grow with the dataset.
    ///
    /// # Errors
    /// If a file cannot be read, or a value is out of its column's range.
    pub fn read_pieces(
        &self,
        columns: &[Column],
        mut keep: impl FnMut(&Part) -> bool,
        mut each: impl FnMut(&FragmentBatch),
    ) -> Result<(), DatasetError> {
        let mut columns = columns.to_vec();
        columns.sort();
        columns.dedup();
        let mut table = FragmentBatch::default();
        for k in 0..self.manifest.parts.len() {
            if !keep(&self.manifest.parts[k]) {
                continue;
            }
            let mut part = OpenPart::open(self, k, &columns)?;
            while part.read(CHUNK_ROWS, &mut table)? > 0 {
                each(&table);
                table.clear();
            }
        }
        Ok(())
    }

    /// Reads columns into memory, in the order asked for. Parquet and NPY read these columns only; memory grows with the rows.
    ///
    /// # Errors
    /// If a file cannot be read, or a value is out of its column's range.
    pub fn read_columns(&self, columns: &[Column]) -> Result<Vec<ColumnData>, DatasetError> {
        self.read_columns_where(columns, |_| true)
    }

    /// As [`Dataset::read_columns`], of the parts that the filter keeps.
    ///
    /// # Errors
    /// If a file cannot be read, or a value is out of its column's range.
    pub fn read_columns_where(
        &self,
        columns: &[Column],
        mut keep: impl FnMut(&Part) -> bool,
    ) -> Result<Vec<ColumnData>, DatasetError> {
        if columns.is_empty() {
            return Ok(Vec::new());
        }
        let parts: Vec<usize> = (0..self.manifest.parts.len())
            .filter(|&k| keep(&self.manifest.parts[k]))
            .collect();
        let mut sorted = columns.to_vec();
        sorted.sort();
        sorted.dedup();
        // No room is taken ahead: the manifest can promise any number of rows.
        let mut table = FragmentBatch::default();
        for k in parts {
            let mut part = OpenPart::open(self, k, &sorted)?;
            while part.read(CHUNK_ROWS, &mut table)? > 0 {}
        }
        // Moved out of the table, copied only where a column was asked for twice.
        let mut data: Vec<ColumnData> = Vec::with_capacity(columns.len());
        for (k, &column) in columns.iter().enumerate() {
            data.push(match columns[..k].iter().position(|&c| c == column) {
                Some(before) => data[before].clone(),
                None => match table.column_mut(column) {
                    ColumnMut::F32(v) => ColumnData::F32(std::mem::take(v)),
                    ColumnMut::U32(v) => ColumnData::U32(std::mem::take(v)),
                },
            });
        }
        Ok(data)
    }
}

/// A part that is being read: checks the values and counts the rows.
struct OpenPart {
    index: u32,
    expected: u64,
    path: PathBuf,
    /// Path of each column, for messages.
    files: Vec<PathBuf>,
    columns: Vec<Column>,
    source: Box<dyn PartSource>,
    /// Where the files lie on this machine; copies live as long as this.
    fetched: Vec<Fetched>,
    rows: u64,
}

impl OpenPart {
    fn open(dataset: &Dataset, k: usize, columns: &[Column]) -> Result<Self, DatasetError> {
        let fetched = dataset.fetch_columns(k, columns)?;
        match dataset.verify_columns(k, columns, &fetched) {
            Ok(()) => Self::unverified(dataset, k, columns, fetched),
            // The place of what is wrong says more than a hash.
            Err(changed) => Err(Self::damage(dataset, k, columns, fetched)
                .err()
                .unwrap_or(changed)),
        }
    }

    /// The first place in a part where something is wrong.
    fn damage(
        dataset: &Dataset,
        k: usize,
        columns: &[Column],
        fetched: Vec<Fetched>,
    ) -> Result<(), DatasetError> {
        let mut part = Self::unverified(dataset, k, columns, fetched)?;
        let mut table = FragmentBatch::default();
        while part.read(CHUNK_ROWS, &mut table)? > 0 {
            table.clear();
        }
        Ok(())
    }

    fn unverified(
        dataset: &Dataset,
        k: usize,
        columns: &[Column],
        fetched: Vec<Fetched>,
    ) -> Result<Self, DatasetError> {
        let part = &dataset.manifest.parts[k];
        let names = part.files.iter().map(|f| dataset.folders[k].join(&f.name));
        let names: Vec<PathBuf> = names.collect();
        let files: Vec<PathBuf> = fetched.iter().map(|f| f.path.clone()).collect();
        let source = dataset.manifest.format.source(&files, columns);
        let relocate =
            |e: DatasetError| match fetched.iter().zip(&names).find(|(f, _)| e.is_at(&f.path)) {
                Some((_, name)) => e.moved_to(name),
                None => e,
            };
        Ok(Self {
            index: part.index,
            expected: part.rows,
            path: names[0].clone(),
            source: source.map_err(relocate)?,
            files: match dataset.manifest.format {
                Format::Npy => names,
                Format::Csv | Format::Parquet => vec![names[0].clone(); Column::ALL.len()],
            },
            columns: columns.to_vec(),
            fetched,
            rows: 0,
        })
    }

    /// Appends up to `max` rows and says how many; 0 at the end.
    fn read(&mut self, max: usize, table: &mut FragmentBatch) -> Result<usize, DatasetError> {
        let before = self.columns.first().map_or(0, |&c| table.column(c).len());
        let count = self.source.read(max, table).map_err(|e| {
            let all = self.fetched.iter().enumerate();
            match all.filter(|(_, f)| e.is_at(&f.path)).map(|(k, _)| k).next() {
                Some(k) => e.moved_to(&self.files[k]),
                None => e,
            }
        })?;
        for &column in &self.columns {
            let values = table.column(column);
            check_column(
                &self.files[column.index()],
                column,
                values.range(before..values.len()),
                self.rows,
                self.index,
            )?;
        }
        self.rows += count as u64;
        if (count == 0 && self.rows < self.expected) || self.rows > self.expected {
            return Err(DatasetError::changed(
                &self.path,
                format!(
                    "{} rows where the manifest says {}",
                    self.rows, self.expected
                ),
            ));
        }
        Ok(count)
    }
}

/// Streams a dataset's rows, see [`Dataset::batches`]. Ends after the first error.
pub struct Batches<'a> {
    dataset: &'a Dataset,
    rows_per_batch: usize,
    parts: VecDeque<usize>,
    current: Option<OpenPart>,
    /// Rows of the last pixel that was read, which may go on.
    held_back: FragmentBatch,
    failed: bool,
}

impl Batches<'_> {
    fn next_batch(&mut self) -> Result<Option<FragmentBatch>, DatasetError> {
        let mut batch = std::mem::take(&mut self.held_back);
        loop {
            let part = match &mut self.current {
                Some(part) => part,
                None => match self.parts.pop_front() {
                    Some(k) => self
                        .current
                        .insert(OpenPart::open(self.dataset, k, &Column::ALL)?),
                    None => return Ok((!batch.is_empty()).then_some(batch)),
                },
            };
            let wanted = self
                .rows_per_batch
                .saturating_sub(batch.len())
                .clamp(1, CHUNK_ROWS);
            if part.read(wanted, &mut batch)? == 0 {
                // Parts are views: a pixel never goes on in the next one.
                self.current = None;
                if batch.len() >= self.rows_per_batch {
                    return Ok(Some(batch));
                }
                continue;
            }
            if batch.len() < self.rows_per_batch {
                continue;
            }
            // The last pixel may go on behind the rows that were read.
            let mut end = batch.len() - 1;
            while end > 0 && batch.same_pixel(end - 1, end) {
                end -= 1;
            }
            if end > 0 {
                self.held_back.extend_from(&batch, end..batch.len());
                batch.truncate(end);
                return Ok(Some(batch));
            }
            // A single pixel fills the batch: read on until it ends.
            if batch.len() > MAX_PIXEL_ROWS {
                return Err(DatasetError::LargePixel {
                    path: part.path.clone(),
                    x: batch.x[0],
                    y: batch.y[0],
                    most: MAX_PIXEL_ROWS,
                });
            }
        }
    }
}

impl Iterator for Batches<'_> {
    type Item = Result<FragmentBatch, DatasetError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let next = self.next_batch().transpose();
        self.failed = matches!(next, Some(Err(_)));
        next
    }
}

impl ColumnSlice<'_> {
    /// An owned copy.
    pub fn to_data(self) -> ColumnData {
        match self {
            Self::F32(v) => ColumnData::F32(v.to_vec()),
            Self::U32(v) => ColumnData::U32(v.to_vec()),
        }
    }
}
