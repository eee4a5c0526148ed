//! NPY: one one-dimensional array for each column.
//!
//! The columns have two types, and a record array would make every reader skip over columns that it does not want.
//! One array each can be loaded or mapped into memory as it is: `numpy.load("….linear_depth.npy")`. The number of
//! rows stands in the header but is known only at the end, so the header is written again when the part is finished.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read as _, Seek as _, Write as _};
use std::path::PathBuf;

use super::{PartSink, PartSource};
use crate::column::{Column, ColumnKind, ColumnMut, ColumnSlice, FragmentBatch};
use crate::error::DatasetError;
use crate::store::Fetched;

/// Bytes that are gathered before they are written, or read at once.
const BUFFER: usize = 1 << 18;

/// Bytes of a header: of NumPy's for one dimension, and of ours for any number of rows.
const HEADER: usize = 128;

/// The header of version 1.0: magic string, version, length, and a dictionary that spaces pad. Little-endian on every
/// machine, so that the bytes are the same.
fn header(kind: ColumnKind, rows: u64) -> Vec<u8> {
    let descriptor = match kind {
        ColumnKind::F32 => "<f4",
        ColumnKind::U32 => "<u4",
    };
    let mut header = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    header.extend_from_slice(
        format!("{{'descr': '{descriptor}', 'fortran_order': False, 'shape': ({rows},)}}")
            .as_bytes(),
    );
    header.resize(HEADER - 1, b' ');
    header.push(b'\n');
    header
}

pub(super) struct NpySink(Vec<(Column, PathBuf, BufWriter<File>)>);

impl NpySink {
    pub(super) fn new(files: Vec<(PathBuf, File)>) -> Result<Self, DatasetError> {
        let columns = Column::ALL.into_iter().zip(files);
        let columns = columns.map(|(column, (path, file))| {
            let mut file = BufWriter::with_capacity(BUFFER, file);
            file.write_all(&header(column.kind(), 0))
                .map_err(DatasetError::io(&path, "write"))?;
            Ok((column, path, file))
        });
        columns.collect::<Result<_, _>>().map(Self)
    }
}

impl PartSink for NpySink {
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        for (column, path, file) in &mut self.0 {
            let written = match rows.column(*column) {
                ColumnSlice::F32(v) => v.iter().try_for_each(|x| file.write_all(&x.to_le_bytes())),
                ColumnSlice::U32(v) => v.iter().try_for_each(|x| file.write_all(&x.to_le_bytes())),
            };
            written.map_err(DatasetError::io(path, "write"))?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>, rows: u64) -> Result<(), DatasetError> {
        for (column, path, mut file) in self.0 {
            let write = file.rewind();
            write
                .and_then(|()| file.write_all(&header(column.kind(), rows)))
                .and_then(|()| file.flush())
                .map_err(DatasetError::io(&path, "write"))?;
        }
        Ok(())
    }
}

pub(super) struct NpySource {
    columns: Vec<(Column, PathBuf, BufReader<File>)>,
    left: u64,
}

impl NpySource {
    /// Opens arrays of so many rows, which say what length and header a file must have.
    pub(super) fn open(
        files: &[Fetched],
        columns: &[Column],
        rows: u64,
    ) -> Result<Self, DatasetError> {
        let mut open = Vec::new();
        for (file, &column) in files.iter().zip(columns) {
            let path = file.shown.clone();
            let file = file.open()?;
            let length = file.metadata().map_err(DatasetError::io(&path, "read"))?;
            let length = length.len();
            let mut file = BufReader::with_capacity(BUFFER, file);
            let mut found = Vec::new();
            let head = file.by_ref().take(HEADER as u64).read_to_end(&mut found);
            head.map_err(DatasetError::io(&path, "read"))?;
            // NumPy ends the dictionary with a comma and a space.
            let expected = header(column.kind(), rows);
            let text = |header: &[u8]| {
                let text = String::from_utf8_lossy(header);
                text.replace(", }", "}").trim_end().to_owned()
            };
            let needed = rows.saturating_mul(4).saturating_add(HEADER as u64);
            if text(&found) != text(&expected) || length != needed {
                let reason = format!(
                    "not an NPY file of column {column}: {rows} rows need {needed} bytes with the header {:?}, and it has {length} with {:?}; write the dataset again",
                    text(&expected[10..]),
                    peelnet_core::files::printable(&text(found.get(10..).unwrap_or_default())),
                );
                return Err(DatasetError::invalid(&path, reason));
            }
            open.push((column, path, file));
        }
        Ok(Self {
            columns: open,
            left: rows,
        })
    }
}

impl PartSource for NpySource {
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError> {
        let count = usize::try_from(self.left).map_or(max, |left| left.min(max));
        for (column, path, file) in &mut self.columns {
            let mut bytes = vec![0; 4 * count];
            let read = file.read_exact(&mut bytes);
            read.map_err(|e| DatasetError::changed(path, e))?;
            let words = bytes.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
            match rows.column_mut(*column) {
                ColumnMut::F32(v) => v.extend(words.map(f32::from_le_bytes)),
                ColumnMut::U32(v) => v.extend(words.map(u32::from_le_bytes)),
            }
        }
        self.left -= count as u64;
        Ok(count)
    }
}
