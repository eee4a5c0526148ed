//! CSV: the header of column names, then one line for each fragment.
//!
//! Numbers are formatted by hand into one large buffer, because a row has fourteen of them and most repeat: a
//! pixel's columns are the same on all its rows, and an object's colour on thousands. So every float column keeps a
//! small table from bits to text, and the groups of columns that change together keep their whole text.

use std::fs::File;
use std::io::{Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::{PartSink, PartSource, split_range};
use crate::batch::FragmentBatch;
use crate::column::{Column, ColumnMut};
use crate::error::DatasetError;
use crate::hashed_file::HashedFile;
use crate::manifest::FileEntry;

/// Rows that are formatted into one buffer before it is written: about 2 MB of text.
const ROWS_A_BUFFER: usize = 1 << 14;

/// Writes a part as CSV.
pub(super) struct CsvSink {
    path: PathBuf,
    name: String,
    file: HashedFile,
    rows: u64,
    lanes: Vec<Lane>,
}

/// What one thread needs to format rows.
struct Lane {
    text: Vec<u8>,
    formatter: RowFormatter,
}

impl CsvSink {
    pub(super) fn create(folder: &Path, stem: &str, threads: usize) -> Result<Self, DatasetError> {
        let name = format!("{stem}.csv");
        let path = folder.join(&name);
        let mut file = HashedFile::create(&path).map_err(DatasetError::io(&path, "create"))?;
        let mut header = csv::Writer::from_writer(Vec::new());
        let header = header
            .write_record(Column::ALL.map(Column::name))
            .map_err(std::io::Error::from)
            .and_then(|()| header.into_inner().map_err(|e| e.into_error()))
            .map_err(DatasetError::io(&path, "write"))?;
        file.write_all(&header)
            .map_err(DatasetError::io(&path, "write"))?;
        Ok(Self {
            path,
            name,
            file,
            rows: 0,
            lanes: (0..threads.max(1))
                .map(|_| Lane {
                    text: Vec::new(),
                    formatter: RowFormatter::new(),
                })
                .collect(),
        })
    }
}

impl PartSink for CsvSink {
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        let stride = ROWS_A_BUFFER * self.lanes.len();
        for start in (0..rows.len()).step_by(stride) {
            let count = stride.min(rows.len() - start);
            let pieces = split_range(count, count.div_ceil(ROWS_A_BUFFER));
            let mut work: Vec<(&mut Lane, Range<usize>)> = self
                .lanes
                .iter_mut()
                .zip(pieces)
                .map(|(lane, p)| (lane, start + p.start..start + p.end))
                .collect();
            std::thread::scope(|scope| {
                let last = work.pop();
                for (lane, piece) in &mut work {
                    scope.spawn(|| lane.format(rows, piece.clone()));
                }
                if let Some((lane, piece)) = last {
                    lane.format(rows, piece);
                }
            });
            for lane in &mut self.lanes {
                self.file
                    .write_all(&lane.text)
                    .map_err(DatasetError::io(&self.path, "write"))?;
                lane.text.clear();
            }
        }
        self.rows += rows.len() as u64;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(Vec<u64>, Vec<FileEntry>), DatasetError> {
        let (bytes, sha256) = self.file.finish();
        let file = FileEntry {
            name: self.name,
            bytes,
            sha256,
        };
        Ok((vec![self.rows], vec![file]))
    }
}

impl Lane {
    fn format(&mut self, rows: &FragmentBatch, range: Range<usize>) {
        for i in range {
            self.formatter.row(rows, i, &mut self.text);
        }
    }
}

/// The longest text of an `f32` (`-1.1754944e-38`) or a `u32`, and a separator.
const TEXT: usize = 24;

/// A text with its separator behind it.
#[derive(Clone, Copy)]
struct Text {
    bytes: [u8; TEXT],
    len: u8,
}

impl Text {
    fn of(float: f32, end: u8) -> Self {
        // Shortest digits that read back to the same bits. `format_finite` may be used: NaN and infinity have been
        // refused before.
        let mut buffer = ryu::Buffer::new();
        Self::copy(buffer.format_finite(float).as_bytes(), end)
    }

    fn copy(text: &[u8], end: u8) -> Self {
        let mut bytes = [0; TEXT];
        bytes[..text.len()].copy_from_slice(text);
        bytes[text.len()] = end;
        Self {
            bytes,
            len: text.len() as u8 + 1,
        }
    }
}

/// Remembers the texts of the floats that were seen last, by the low bits of a hash.
struct FloatTexts {
    end: u8,
    table: Vec<(u32, Text)>,
}

impl FloatTexts {
    const BITS: u32 = 8;

    fn new(end: u8) -> Self {
        // All slots start as the text of zero, so that a slot is never wrong.
        Self {
            end,
            table: vec![(0, Text::of(0.0, end)); 1 << Self::BITS],
        }
    }

    fn get(&mut self, float: f32) -> &Text {
        let bits = float.to_bits();
        let slot = bits.wrapping_mul(0x9e37_79b9) >> (32 - Self::BITS);
        let slot = &mut self.table[slot as usize];
        if slot.0 != bits {
            *slot = (bits, Text::of(float, self.end));
        }
        &slot.1
    }
}

/// Formats rows; remembers texts, never anything that could change them.
struct RowFormatter {
    line: Line,
    one_minus_alpha: FloatTexts,
    linear_depth: FloatTexts,
    pixel: PixelTexts,
    transmittance: FloatTexts,
    color: [FloatTexts; 3],
}

/// The texts that a pixel's rows share.
struct PixelTexts {
    key: Option<[u32; 7]>,
    sums: Vec<u8>,
    place: Vec<u8>,
    clip: Vec<u8>,
}

/// The line that is being put together. Texts are copied with a fixed length, of which only the used part counts:
/// that is one vector move instead of a call.
struct Line {
    bytes: [u8; Line::SIZE],
    len: usize,
}

impl Line {
    /// Fourteen texts, and room for the last fixed-length copy.
    const SIZE: usize = 15 * TEXT;

    fn push(&mut self, text: &Text) {
        self.bytes[self.len..self.len + TEXT].copy_from_slice(&text.bytes);
        self.len += usize::from(text.len);
    }

    fn extend(&mut self, text: &[u8]) {
        self.bytes[self.len..self.len + text.len()].copy_from_slice(text);
        self.len += text.len();
    }
}

impl RowFormatter {
    fn new() -> Self {
        let floats = || FloatTexts::new(b',');
        Self {
            line: Line {
                bytes: [0; Line::SIZE],
                len: 0,
            },
            one_minus_alpha: floats(),
            linear_depth: floats(),
            pixel: PixelTexts {
                key: None,
                sums: Vec::new(),
                place: Vec::new(),
                clip: Vec::new(),
            },
            transmittance: floats(),
            color: [floats(), floats(), floats()],
        }
    }

    fn row(&mut self, rows: &FragmentBatch, i: usize, text: &mut Vec<u8>) {
        self.pixel.update(rows, i);
        let line = &mut self.line;
        line.len = 0;
        line.push(self.one_minus_alpha.get(rows.one_minus_alpha[i]));
        line.push(self.linear_depth.get(rows.linear_depth[i]));
        line.extend(&self.pixel.sums);
        line.push(self.transmittance.get(rows.transmittance[i]));
        line.extend(&self.pixel.place);
        line.push(&Text::copy(
            itoa::Buffer::new().format(rows.layer[i]).as_bytes(),
            b',',
        ));
        line.push(self.color[0].get(rows.r[i]));
        line.push(self.color[1].get(rows.g[i]));
        line.push(self.color[2].get(rows.b[i]));
        line.extend(&self.pixel.clip);
        text.extend_from_slice(&line.bytes[..line.len]);
    }
}

impl PixelTexts {
    fn update(&mut self, rows: &FragmentBatch, i: usize) {
        let key = [
            rows.alpha_sum[i].to_bits(),
            rows.fragment_count[i],
            rows.view[i],
            rows.x[i],
            rows.y[i],
            rows.near[i].to_bits(),
            rows.far[i].to_bits(),
        ];
        if self.key == Some(key) {
            return;
        }
        let mut floats = ryu::Buffer::new();
        let mut integers = itoa::Buffer::new();
        if self.key.is_none_or(|old| old[5..] != key[5..]) {
            self.clip.clear();
            self.clip
                .extend_from_slice(floats.format_finite(rows.near[i]).as_bytes());
            self.clip.push(b',');
            self.clip
                .extend_from_slice(floats.format_finite(rows.far[i]).as_bytes());
            self.clip.push(b'\n');
        }
        self.sums.clear();
        self.sums
            .extend_from_slice(floats.format_finite(rows.alpha_sum[i]).as_bytes());
        self.sums.push(b',');
        self.sums
            .extend_from_slice(integers.format(rows.fragment_count[i]).as_bytes());
        self.sums.push(b',');
        self.place.clear();
        for value in [rows.view[i], rows.x[i], rows.y[i]] {
            self.place
                .extend_from_slice(integers.format(value).as_bytes());
            self.place.push(b',');
        }
        self.key = Some(key);
    }
}

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

/// Reads a part from CSV.
pub(super) struct CsvSource {
    path: PathBuf,
    reader: csv::Reader<Lines>,
    record: csv::ByteRecord,
    columns: Vec<Column>,
}

/// Bytes of a line that are read: the reader keeps a whole line in memory.
const MAX_LINE: usize = 1 << 16;

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
    pub(super) fn open(files: &[PathBuf], columns: &[Column]) -> Result<Self, DatasetError> {
        let path = files[0].clone();
        let file = peelnet_files::open(&path).map_err(DatasetError::io(&path, "open"))?;
        let file = Lines { file, line: 0 };
        let mut reader = csv::ReaderBuilder::new()
            .buffer_capacity(BUFFER)
            .from_reader(file);
        let header: Vec<String> = reader
            .byte_headers()
            .map_err(|e| csv_error(&path, &e))?
            .iter()
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect();
        check_names(&path, "header", &header)?;
        Ok(Self {
            path,
            reader,
            record: csv::ByteRecord::new(),
            columns: columns.to_vec(),
        })
    }
}

/// Compares a file's column names with the schema's.
pub(super) fn check_names(path: &Path, place: &str, found: &[String]) -> Result<(), DatasetError> {
    if let Some(missing) = Column::ALL
        .iter()
        .find(|c| !found.iter().any(|n| n == c.name()))
    {
        return Err(DatasetError::format(
            path,
            format!(
                "{place}: column {missing} is missing; the columns must be {}",
                Column::ALL.map(Column::name).join(", ")
            ),
        ));
    }
    for (k, name) in found.iter().enumerate() {
        let expected = Column::ALL.get(k).map_or("no column", |c| c.name());
        if name != expected {
            return Err(DatasetError::format(
                path,
                format!(
                    "{place}: column {} is {name:?} where {expected} is expected; the columns must be {}, in this order",
                    k + 1,
                    Column::ALL.map(Column::name).join(", ")
                ),
            ));
        }
    }
    Ok(())
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
    DatasetError::format(path, reason)
}

impl PartSource for CsvSource {
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError> {
        let mut count = 0;
        while count < max {
            let more = self
                .reader
                .read_byte_record(&mut self.record)
                .map_err(|e| csv_error(&self.path, &e))?;
            if !more {
                break;
            }
            for &column in &self.columns {
                let field = &self.record[column.index()];
                let text = std::str::from_utf8(field).ok();
                let parsed = match rows.column_mut(column) {
                    ColumnMut::F32(v) => text.and_then(|t| t.parse().ok()).map(|x| v.push(x)),
                    ColumnMut::U32(v) => text.and_then(|t| t.parse().ok()).map(|x| v.push(x)),
                };
                if parsed.is_none() {
                    let line = self.record.position().map_or(0, csv::Position::line);
                    return Err(DatasetError::format(
                        &self.path,
                        format!(
                            "line {line}, column {column}: {:?} is not a number of type {}; fix the line or write the dataset again",
                            peelnet_files::printable(&String::from_utf8_lossy(field)),
                            match column.kind() {
                                crate::ColumnKind::F32 => "f32",
                                crate::ColumnKind::U32 => "u32",
                            }
                        ),
                    ));
                }
            }
            count += 1;
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use peelnet_core::random::Random;

    /// The table must never answer with another float's text: all slots are hit many times.
    #[test]
    fn texts_read_back_to_the_same_bits() {
        let mut texts = FloatTexts::new(b',');
        let mut random = Random::new(1, &[]);
        for k in 0..200_000u32 {
            let float = match k % 4 {
                0 => f32::from_bits(random.bits()),
                1 => (random.bits() >> 20) as f32 * 0.125,
                2 => random.unit(),
                _ => -0.0,
            };
            if !float.is_finite() {
                continue;
            }
            let text = texts.get(float);
            let (number, end) =
                text.bytes[..usize::from(text.len)].split_at(usize::from(text.len) - 1);
            let back: f32 = std::str::from_utf8(number).unwrap().parse().unwrap();
            assert_eq!(end, b",");
            assert_eq!(back.to_bits(), float.to_bits());
        }
    }

    #[test]
    fn the_longest_texts_fit() {
        for float in [
            -f32::MIN_POSITIVE,
            -f32::MAX,
            -1.234_567_9e-30,
            f32::from_bits(1),
        ] {
            assert!(usize::from(Text::of(float, b',').len) <= TEXT);
        }
    }
}
