//! NPY: one one-dimensional array for each column.
//!
//! The columns have two types, and a record array would make every reader skip over columns that it does not want.
//! One array each can be loaded or mapped into memory as it is: `numpy.load("….linear_depth.npy")`. The number of
//! rows stands in the header but is known only at the end, so the header is written again when the part is finished: padded to a
//! multiple of 64 bytes, it has one length for all numbers of rows.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use ndarray_npy::npy::header::{Header, Layout};
use py_literal::Value;

use super::{PartSink, PartSource, split_range};
use crate::batch::FragmentBatch;
use crate::column::{Column, ColumnKind, ColumnMut, ColumnSlice};
use crate::error::DatasetError;
use crate::hashed_file::hash_file;
use crate::manifest::FileEntry;

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 18;

/// Bytes of a header that are read. NumPy's and ours have 128.
const MAX_HEADER: u32 = 1 << 12;

/// The type descriptor of a column: little-endian on every machine, so that the bytes are the same.
const fn descriptor(kind: ColumnKind) -> &'static str {
    match kind {
        ColumnKind::F32 => "<f4",
        ColumnKind::U32 => "<u4",
    }
}

/// The header for so many rows.
fn header(kind: ColumnKind, rows: u64) -> Vec<u8> {
    let header = Header {
        type_descriptor: Value::String(descriptor(kind).to_owned()),
        layout: Layout::Standard,
        shape: vec![rows as usize],
    };
    header
        .to_bytes()
        .expect("a type and one number are short and ASCII")
}

/// Name of a column's file.
fn file_name(stem: &str, column: Column) -> String {
    format!("{stem}.{column}.npy")
}

/// Writes a part as NPY arrays.
pub(super) struct NpySink {
    rows: u64,
    threads: usize,
    columns: Vec<ColumnFile>,
}

struct ColumnFile {
    column: Column,
    name: String,
    path: PathBuf,
    file: File,
    buffer: Vec<u8>,
}

impl NpySink {
    pub(super) fn create(folder: &Path, stem: &str, threads: usize) -> Result<Self, DatasetError> {
        let columns = Column::ALL
            .into_iter()
            .map(|column| {
                let name = file_name(stem, column);
                let path = folder.join(&name);
                let file = File::create_new(&path).map_err(DatasetError::io(&path, "create"))?;
                Ok(ColumnFile {
                    column,
                    name,
                    path,
                    file,
                    buffer: header(column.kind(), 0),
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            rows: 0,
            threads,
            columns,
        })
    }

    /// Does something to every column, on some threads.
    fn for_each<T: Send>(
        &mut self,
        work: impl Fn(&mut ColumnFile) -> Result<T, DatasetError> + Sync,
    ) -> Result<Vec<T>, DatasetError> {
        let work = &work;
        let mut rest = self.columns.as_mut_slice();
        let results: Vec<Result<Vec<T>, DatasetError>> = std::thread::scope(|scope| {
            let threads: Vec<_> = split_range(rest.len(), self.threads)
                .into_iter()
                .map(|piece| {
                    let (mine, others) = std::mem::take(&mut rest).split_at_mut(piece.len());
                    rest = others;
                    scope.spawn(move || mine.iter_mut().map(work).collect())
                })
                .collect();
            threads
                .into_iter()
                .map(|t| t.join().unwrap_or_else(|e| std::panic::resume_unwind(e)))
                .collect()
        });
        let mut all = Vec::with_capacity(self.columns.len());
        for result in results {
            all.extend(result?);
        }
        Ok(all)
    }
}

impl ColumnFile {
    fn append(&mut self, values: ColumnSlice<'_>) -> Result<(), DatasetError> {
        match values {
            ColumnSlice::F32(v) => self.append_words(v, |x| x.to_le_bytes()),
            ColumnSlice::U32(v) => self.append_words(v, |x| x.to_le_bytes()),
        }
    }

    fn append_words<T: Copy>(
        &mut self,
        values: &[T],
        bytes: impl Fn(T) -> [u8; 4],
    ) -> Result<(), DatasetError> {
        for chunk in values.chunks(BUFFER / 4) {
            let start = self.buffer.len();
            self.buffer.resize(start + 4 * chunk.len(), 0);
            for (to, &value) in self.buffer[start..].chunks_exact_mut(4).zip(chunk) {
                to.copy_from_slice(&bytes(value));
            }
            if self.buffer.len() >= BUFFER {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), DatasetError> {
        self.file
            .write_all(&self.buffer)
            .map_err(DatasetError::io(&self.path, "write"))?;
        self.buffer.clear();
        Ok(())
    }

    fn finish(&mut self, rows: u64) -> Result<FileEntry, DatasetError> {
        self.flush()?;
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(&header(self.column.kind(), rows)))
            .map_err(DatasetError::io(&self.path, "write"))?;
        // The header comes first in the hash but last in time, so the file is read once more, mostly from memory.
        let (bytes, sha256) =
            hash_file(&self.path).map_err(DatasetError::io(&self.path, "read"))?;
        Ok(FileEntry {
            name: self.name.clone(),
            bytes,
            sha256,
        })
    }
}

impl PartSink for NpySink {
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        // Copying is as fast as the memory: one thread does it, two only share the hashing below.
        for file in &mut self.columns {
            file.append(rows.column(file.column))?;
        }
        self.rows += rows.len() as u64;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(Vec<u64>, Vec<FileEntry>), DatasetError> {
        let rows = self.rows;
        let files = self.for_each(|column| column.finish(rows))?;
        Ok((vec![rows], files))
    }
}

/// Reads a part from NPY arrays.
pub(super) struct NpySource {
    columns: Vec<OpenColumn>,
}

struct OpenColumn {
    column: Column,
    path: PathBuf,
    file: BufReader<File>,
    left: u64,
}

impl NpySource {
    pub(super) fn open(files: &[PathBuf], columns: &[Column]) -> Result<Self, DatasetError> {
        let mut open: Vec<OpenColumn> = Vec::with_capacity(columns.len());
        for &column in columns {
            let next = OpenColumn::open(&files[column.index()], column)?;
            if let Some(first) = open.first().filter(|f| f.left != next.left) {
                return Err(DatasetError::format(
                    &next.path,
                    format!(
                        "{} rows, but column {} of the same part has {}; write the dataset again",
                        next.left, first.column, first.left
                    ),
                ));
            }
            open.push(next);
        }
        Ok(Self { columns: open })
    }
}

/// Refuses a header of an absurd length before memory is taken for it.
fn check_header(path: &Path, file: &mut BufReader<File>) -> Result<(), DatasetError> {
    let start = file.fill_buf().map_err(DatasetError::io(path, "read"))?;
    let length = match start {
        // Magic string, version, length: of 16 bits in version 1, of 32 in later ones.
        [_, _, _, _, _, _, 1, _, a, b, ..] => u32::from(u16::from_le_bytes([*a, *b])),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => u32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0,
    };
    if length > MAX_HEADER {
        return Err(DatasetError::format(
            path,
            format!(
                "not an NPY file: a header of {length} bytes, and at most {MAX_HEADER} are read"
            ),
        ));
    }
    Ok(())
}

impl OpenColumn {
    fn open(path: &Path, column: Column) -> Result<Self, DatasetError> {
        let file = peelnet_files::open(path).map_err(DatasetError::io(path, "open"))?;
        let length = file
            .metadata()
            .map_err(DatasetError::io(path, "read"))?
            .len();
        let mut file = BufReader::with_capacity(BUFFER, file);
        check_header(path, &mut file)?;
        let header = Header::from_reader(&mut file)
            .map_err(|e| DatasetError::format(path, format!("not an NPY file: {e}")))?;
        let found = header.type_descriptor.to_string();
        let expected = descriptor(column.kind());
        if found.trim_matches('\'') != expected {
            return Err(DatasetError::format(
                path,
                format!("column {column} has type {found}, expected '{expected}'"),
            ));
        }
        let [rows] = header.shape[..] else {
            return Err(DatasetError::format(
                path,
                format!(
                    "column {column} has shape {:?}, expected one dimension",
                    header.shape
                ),
            ));
        };
        let promised = (rows as u64).checked_mul(4);
        if promised.is_none_or(|bytes| bytes > length) {
            return Err(DatasetError::format(
                path,
                format!(
                    "the header says {rows} rows, which {length} bytes cannot hold; write the dataset again"
                ),
            ));
        }
        Ok(Self {
            column,
            path: path.to_owned(),
            file,
            left: rows as u64,
        })
    }

    fn read(&mut self, rows: usize, to: ColumnMut<'_>) -> Result<(), DatasetError> {
        let mut bytes = vec![0; 4 * rows];
        self.file.read_exact(&mut bytes).map_err(|e| {
            DatasetError::changed(
                &self.path,
                format!("{} more rows were expected: {e}", self.left),
            )
        })?;
        let words = bytes.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
        match to {
            ColumnMut::F32(v) => v.extend(words.map(f32::from_le_bytes)),
            ColumnMut::U32(v) => v.extend(words.map(u32::from_le_bytes)),
        }
        self.left -= rows as u64;
        Ok(())
    }
}

impl PartSource for NpySource {
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError> {
        let left = self.columns.first().map_or(0, |c| c.left);
        let count = usize::try_from(left).map_or(max, |left| left.min(max));
        for column in &mut self.columns {
            column.read(count, rows.column_mut(column.column))?;
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    /// Headers of all numbers of rows have one length, and read back.
    #[test]
    fn headers_have_one_length() {
        for rows in [0, 1, 999, u64::MAX >> 1, u64::MAX] {
            let bytes = header(ColumnKind::U32, rows);
            assert_eq!(bytes.len(), 128);
            let parsed = Header::from_reader(&mut bytes.as_slice()).unwrap();
            assert_eq!(parsed.shape, [rows as usize]);
            assert_eq!(parsed.type_descriptor.to_string(), "'<u4'");
        }
    }
}
