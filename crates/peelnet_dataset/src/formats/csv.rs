//! CSV: the header of column names, then one line for each fragment.

use std::fs::File;
use std::io::{Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{PartSink, PartSource, check_names};
use crate::column::{Column, ColumnMut, ColumnSlice, FragmentBatch};
use crate::error::DatasetError;
use crate::store::Fetched;

/// Rows that are formatted into one buffer before it is written: about 2 MB of text.
const ROWS_A_BUFFER: usize = 1 << 14;

pub(super) struct CsvSink {
    path: PathBuf,
    file: File,
}

impl CsvSink {
    pub(super) fn new((path, file): (PathBuf, File)) -> Result<Self, DatasetError> {
        let header = Column::ALL.map(Column::name).join(",") + "\n";
        let mut sink = Self { path, file };
        sink.append(header.as_bytes())?;
        Ok(sink)
    }

    fn append(&mut self, text: &[u8]) -> Result<(), DatasetError> {
        let written = self.file.write_all(text);
        written.map_err(DatasetError::io(&self.path, "write"))
    }
}

impl PartSink for CsvSink {
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        let starts: Vec<usize> = (0..rows.len()).step_by(ROWS_A_BUFFER).collect();
        // As many buffers as threads are in memory.
        for starts in starts.chunks(rayon::current_num_threads()) {
            let ends = |start: usize| rows.len().min(start + ROWS_A_BUFFER);
            let texts = starts
                .par_iter()
                .map(|&start| lines(rows, start..ends(start)));
            let texts: Vec<Vec<u8>> = texts.collect();
            texts.iter().try_for_each(|text| self.append(text))?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>, _: u64) -> Result<(), DatasetError> {
        Ok(())
    }
}

/// Numbers whose text is remembered while rows are formatted.
const KNOWN: usize = 1 << 12;

/// The text of some rows. Values repeat, within a pixel and between pixels: their text is copied from where it was written last, which is
/// quicker than finding the shortest digits again.
fn lines(rows: &FragmentBatch, range: Range<usize>) -> Vec<u8> {
    let columns = Column::ALL.map(|column| rows.column(column));
    let mut known: Vec<Option<(u64, Range<usize>)>> = vec![None; KNOWN];
    let (mut floats, mut integers) = (ryu::Buffer::new(), itoa::Buffer::new());
    let mut text = Vec::with_capacity(128 * range.len());
    for i in range {
        for column in &columns {
            let number = match column {
                ColumnSlice::F32(v) => u64::from(v[i].to_bits()),
                ColumnSlice::U32(v) => 1 << 32 | u64::from(v[i]),
            };
            // The upper bits of a product with the golden ratio depend on all bits of the number.
            let place = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - KNOWN.ilog2());
            let (known, start) = (&mut known[place as usize], text.len());
            match known {
                Some((other, written)) if *other == number => {
                    text.extend_from_within(written.clone());
                }
                // Shortest digits that read back to the same bits. `format_finite` may be used: NaN and infinity have
                // been refused before.
                _ => text.extend_from_slice(match column {
                    ColumnSlice::F32(v) => floats.format_finite(v[i]).as_bytes(),
                    ColumnSlice::U32(v) => integers.format(v[i]).as_bytes(),
                }),
            }
            *known = Some((number, start..text.len()));
            text.push(b',');
        }
        text.pop();
        text.push(b'\n');
    }
    text
}

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

/// Bytes of a line that are read: the reader keeps a whole line in memory.
const MAX_LINE: usize = 1 << 16;

pub(super) struct CsvSource {
    path: PathBuf,
    reader: csv::Reader<Lines>,
    record: csv::ByteRecord,
    columns: Vec<Column>,
}

/// A file that ends with an error where a line does not end.
struct Lines {
    file: File,
    /// Bytes since the last line's end.
    line: usize,
}

impl Read for Lines {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let n = self.file.read(bytes)?;
        self.line = match bytes[..n].iter().rposition(|b| *b == b'\n') {
            Some(end) => n - 1 - end,
            None => self.line + n,
        };
        // A piece that is read can hold the end of a line that is allowed.
        if self.line > MAX_LINE + BUFFER {
            return Err(std::io::Error::new(
                std::io::ErrorKind::InvalidData,
                format!("a line has more than {MAX_LINE} bytes"),
            ));
        }
        Ok(n)
    }
}

impl CsvSource {
    pub(super) fn open(file: &Fetched, columns: &[Column]) -> Result<Self, DatasetError> {
        let path = file.shown.clone();
        let file = Lines {
            file: file.open()?,
            line: 0,
        };
        let mut reader = csv::ReaderBuilder::new()
            .buffer_capacity(BUFFER)
            .from_reader(file);
        let header = reader.byte_headers().map_err(|e| csv_error(&path, &e))?;
        let header = header.iter();
        let names: Vec<String> = header
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect();
        check_names(&path, "header", &names)?;
        Ok(Self {
            path,
            reader,
            record: csv::ByteRecord::new(),
            columns: columns.to_vec(),
        })
    }
}

fn csv_error(path: &Path, error: &csv::Error) -> DatasetError {
    let reason = match error.kind() {
        csv::ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!(
                "line {line}: {len} fields where {expected_len} are expected; fix the line or write the dataset again"
            )
        }
        _ => error.to_string(),
    };
    DatasetError::invalid(path, reason)
}

impl PartSource for CsvSource {
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError> {
        let mut count = 0;
        while count < max {
            let more = self.reader.read_byte_record(&mut self.record);
            if !more.map_err(|e| csv_error(&self.path, &e))? {
                break;
            }
            for &column in &self.columns {
                let field = &self.record[column as usize];
                let text = std::str::from_utf8(field).ok();
                let parsed = match rows.column_mut(column) {
                    ColumnMut::F32(v) => text.and_then(|t| t.parse().ok()).map(|x| v.push(x)),
                    ColumnMut::U32(v) => text.and_then(|t| t.parse().ok()).map(|x| v.push(x)),
                };
                if parsed.is_none() {
                    let line = self.record.position().map_or(0, csv::Position::line);
                    let kind = format!("{:?}", column.kind()).to_lowercase();
                    let text = String::from_utf8_lossy(field);
                    let text = peelnet_core::files::printable(&text);
                    let reason = format!(
                        "line {line}, column {column}: {text:?} is not a number of type {kind}; fix the line or write the dataset again"
                    );
                    return Err(DatasetError::invalid(&self.path, reason));
                }
            }
            count += 1;
        }
        Ok(count)
    }
}
