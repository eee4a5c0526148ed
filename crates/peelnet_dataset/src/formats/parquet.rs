//! Parquet: one file for each part, row groups of 2²⁰ rows, pages without dictionary, compressed with snappy.
//!
//! A dictionary makes the writer hash every value of columns that hardly repeat; without it, snappy still turns a
//! constant column into next to nothing. The columns of a row group are encoded into memory independently, on
//! several threads, and appended in order, so that the threads do not change the bytes.
//!
//! Every row group and page has its least and greatest value, and the footer has where pages lie: a reader that asks for one view fetches
//! one view.

use std::fmt;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::column::reader::ColumnReader;
use parquet::column::writer::{ColumnCloseResult, ColumnWriter, get_column_writer};
use parquet::errors::ParquetError;
use parquet::file::properties::{
    EnabledStatistics, WriterProperties, WriterPropertiesPtr, WriterVersion,
};
use parquet::file::reader::{ChunkReader as _, FileReader};
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::{SerializedFileWriter, SerializedPageWriter, TrackedWrite};
use parquet::schema::types::{ColumnDescPtr, Type, TypePtr};

use rayon::prelude::*;

use super::{PartSink, PartSource, check_names};
use crate::column::{Column, ColumnKind, ColumnMut, ColumnSlice, FragmentBatch};
use crate::error::DatasetError;
use crate::store::Fetched;

/// Rows of a full row group of Parquet.
pub const ROW_GROUP_ROWS: usize = 1 << 20;

/// Rows of a page: 512 KiB of values, small enough for the caches.
const PAGE_ROWS: usize = 1 << 17;

fn schema() -> TypePtr {
    let fields = Column::ALL.map(|column| {
        let logical = match column.kind() {
            ColumnKind::F32 => None,
            ColumnKind::U32 => Some(LogicalType::integer(32, false)),
        };
        let field = Type::primitive_type_builder(column.name(), physical_type(column))
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build();
        Arc::new(field.expect("a plain field is valid"))
    });
    let group = Type::group_type_builder("fragments").with_fields(fields.into());
    Arc::new(group.build().expect("a flat group is valid"))
}

const fn physical_type(column: Column) -> PhysicalType {
    match column.kind() {
        ColumnKind::F32 => PhysicalType::FLOAT,
        ColumnKind::U32 => PhysicalType::INT32,
    }
}

fn properties() -> WriterPropertiesPtr {
    Arc::new(
        WriterProperties::builder()
            .set_writer_version(WriterVersion::PARQUET_1_0)
            .set_created_by("peelnet".to_owned())
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            // A query for one view, or for a range of rows of the image, skips the other files, row groups and pages.
            .set_statistics_enabled(EnabledStatistics::Page)
            .set_data_page_row_count_limit(PAGE_ROWS)
            .set_write_batch_size(PAGE_ROWS)
            .set_max_row_group_row_count(Some(ROW_GROUP_ROWS))
            .build(),
    )
}

pub(super) struct ParquetSink {
    path: PathBuf,
    writer: SerializedFileWriter<File>,
    /// Rows that do not fill a row group yet.
    pending: FragmentBatch,
}

impl ParquetSink {
    pub(super) fn new((path, file): (PathBuf, File)) -> Result<Self, DatasetError> {
        let writer = SerializedFileWriter::new(file, schema(), properties());
        Ok(Self {
            writer: writer.map_err(|e| write_error(&path, e))?,
            path,
            pending: FragmentBatch::default(),
        })
    }

    /// Encodes and appends the pending rows as one row group.
    fn row_group(&mut self) -> Result<(), DatasetError> {
        let mut rows = std::mem::take(&mut self.pending);
        let descriptors = self.writer.schema_descr().columns().to_vec();
        let properties = self.writer.properties().clone();
        let encoded = Column::ALL.into_par_iter().map(|column| {
            let descriptor = &descriptors[column as usize];
            encode(descriptor, &properties, rows.column(column))
        });
        let append = || -> Result<(), ParquetError> {
            let encoded: Vec<_> = encoded.collect::<Result<_, _>>()?;
            let mut group = self.writer.next_row_group()?;
            for (bytes, close) in encoded {
                group.append_column(&bytes, close)?;
            }
            group.close().map(|_| ())
        };
        append().map_err(|e| write_error(&self.path, e))?;
        rows.clear();
        self.pending = rows;
        Ok(())
    }
}

/// Encodes one column chunk into memory.
fn encode(
    descriptor: &ColumnDescPtr,
    properties: &WriterPropertiesPtr,
    values: ColumnSlice<'_>,
) -> Result<(Bytes, ColumnCloseResult), ParquetError> {
    let mut sink = TrackedWrite::new(Vec::new());
    let pages = Box::new(SerializedPageWriter::new(&mut sink));
    let mut writer = get_column_writer(descriptor.clone(), properties.clone(), pages);
    match (&mut writer, values) {
        (ColumnWriter::FloatColumnWriter(w), ColumnSlice::F32(v)) => {
            w.write_batch(v, None, None)?;
        }
        (ColumnWriter::Int32ColumnWriter(w), ColumnSlice::U32(v)) => {
            // Parquet stores unsigned integers as the signed ones with the same bits.
            w.write_batch(bytemuck::cast_slice(v), None, None)?;
        }
        _ => unreachable!("the schema is made from the columns' types"),
    }
    let close = writer.close()?;
    Ok((Bytes::from(sink.into_inner()?), close))
}

fn write_error(path: &Path, error: ParquetError) -> DatasetError {
    let source = match error {
        ParquetError::External(inner) => match inner.downcast::<std::io::Error>() {
            Ok(source) => *source,
            Err(other) => std::io::Error::other(other),
        },
        other => std::io::Error::other(other),
    };
    DatasetError::io(path, "write")(source)
}

impl PartSink for ParquetSink {
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        // Row groups always have the same number of rows, however the rows come.
        let mut start = 0;
        while start < rows.len() {
            let wanted = ROW_GROUP_ROWS - self.pending.len();
            let count = wanted.min(rows.len() - start);
            self.pending.extend_from(rows, start..start + count);
            if self.pending.len() == ROW_GROUP_ROWS {
                self.row_group()?;
            }
            start += count;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _: u64) -> Result<(), DatasetError> {
        if !self.pending.is_empty() {
            self.row_group()?;
        }
        // Writes the footer and empties the buffers.
        let file = self.writer.into_inner();
        file.map(drop).map_err(|e| write_error(&self.path, e))
    }
}

/// Reads a part from Parquet, only the pages of the asked columns.
pub(super) struct ParquetSource {
    path: PathBuf,
    file: SerializedFileReader<File>,
    columns: Vec<Column>,
    next_group: usize,
    /// Readers of the current row group, parallel to `columns`.
    readers: Vec<ColumnReader>,
    /// Rows left in the current row group.
    left: usize,
    signed: Vec<i32>,
}

impl ParquetSource {
    pub(super) fn open(file: &Fetched, columns: &[Column]) -> Result<Self, DatasetError> {
        let path = file.shown.clone();
        let mut file = file.open()?;
        let length = check_footer(&path, &mut file)?;
        let pages = file.try_clone().map_err(DatasetError::io(&path, "read"))?;
        let file = SerializedFileReader::new(file).map_err(|e| read_error(&path, e))?;
        let found = file.metadata().file_metadata().schema_descr().columns();
        let names: Vec<String> = found.iter().map(|c| c.path().string()).collect();
        check_names(&path, "schema", &names)?;
        for (descriptor, column) in found.iter().zip(Column::ALL) {
            let expected = physical_type(column);
            if descriptor.physical_type() != expected || descriptor.max_def_level() != 0 {
                let reason = format!(
                    "column {column} is {} (definition level {}), expected a required {expected}",
                    descriptor.physical_type(),
                    descriptor.max_def_level()
                );
                return Err(DatasetError::invalid(&path, reason));
            }
        }
        check_places(&path, length, &file)?;
        check_pages(&path, &pages, &file, columns)?;
        Ok(Self {
            path,
            file,
            columns: columns.to_vec(),
            next_group: 0,
            readers: Vec::new(),
            left: 0,
            signed: Vec::new(),
        })
    }
}

/// Bytes of a footer that are read: enough for 10¹⁰ rows. Its lists take a hundred times that in memory.
const MAX_FOOTER: u32 = 1 << 24;

/// Refuses a footer of an absurd length before memory is taken for it; returns the file's length.
fn check_footer(path: &Path, file: &mut File) -> Result<u64, DatasetError> {
    let whole = file.metadata().map_err(DatasetError::io(path, "read"))?;
    let mut end = [0; 8];
    let read = file
        .seek(SeekFrom::End(-8))
        .and_then(|_| file.read_exact(&mut end))
        .and_then(|()| file.rewind());
    // A file without the eight bytes is the reader's to refuse.
    let length = u32::from_le_bytes([end[0], end[1], end[2], end[3]]);
    if read.is_ok() && length > MAX_FOOTER {
        let what = format!("a footer of {length} bytes, and at most {MAX_FOOTER} are read");
        return Err(read_error(path, what));
    }
    Ok(whole.len())
}

/// Every column's pages must lie inside the file: the reader takes their places from the footer, and panics where they are negative.
fn check_places(
    path: &Path,
    length: u64,
    file: &SerializedFileReader<File>,
) -> Result<(), DatasetError> {
    for group in file.metadata().row_groups() {
        for column in group.columns() {
            let first = column.dictionary_page_offset();
            let first = first.unwrap_or_else(|| column.data_page_offset());
            let bytes = column.compressed_size();
            let end = first
                .checked_add(bytes)
                .filter(|_| first >= 0 && bytes >= 0);
            if end.is_none_or(|end| end as u64 > length) {
                let column = column.column_path().string();
                let reason = format!(
                    "the footer says that column {column} lies outside of the file; write the dataset again"
                );
                return Err(DatasetError::invalid(path, reason));
            }
        }
    }
    Ok(())
}

/// Bytes of a page's header that are read; ours have fewer than a hundred.
const MAX_PAGE_HEADER: u64 = 512;

/// Every page of these columns must be one that we write: the reader takes as much memory as a header says, and panics where it names a
/// dictionary that is not there.
fn check_pages(
    path: &Path,
    pages: &File,
    file: &SerializedFileReader<File>,
    columns: &[Column],
) -> Result<(), DatasetError> {
    for group in file.metadata().row_groups() {
        for &column in columns {
            let fail = |what: &str| read_error(path, format!("column {column} has {what}"));
            let (mut at, bytes) = group.column(column as usize).byte_range();
            let (end, mut rows) = (at + bytes, 0);
            while at < end {
                let length = MAX_PAGE_HEADER.min(end - at) as usize;
                let head = pages.get_bytes(at, length);
                let head = head.map_err(|e| read_error(path, e))?;
                let mut header = Thrift(&head);
                let page = header.page().filter(PageHeader::is_ours);
                let page = page.ok_or_else(|| fail("a page that peelnet does not write"))?;
                at += (length - header.0.len()) as u64 + page.compressed as u64;
                rows += page.values;
            }
            if at != end || rows != group.num_rows() {
                return Err(fail("pages of other lengths than the footer says"));
            }
        }
    }
    Ok(())
}

/// Numbers of a page's header.
#[derive(Default)]
struct PageHeader {
    kind: i64,
    uncompressed: i64,
    compressed: i64,
    values: i64,
    encoding: i64,
}

impl PageHeader {
    /// Whether it is a data page of the first version, of plain values of four bytes each.
    fn is_ours(&self) -> bool {
        (self.kind, self.encoding) == (0, 0)
            && (1..=PAGE_ROWS as i64).contains(&self.values)
            && self.uncompressed == 4 * self.values
            && self.compressed >= 0
    }
}

/// Bytes of Thrift's compact protocol.
struct Thrift<'a>(&'a [u8]);

impl Thrift<'_> {
    /// The next bytes.
    fn take(&mut self, count: usize) -> Option<&[u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = u64::from(self.take(1)?[0]);
            number |= (byte & 127) << shift;
            if byte < 128 {
                return Some(number);
            }
        }
        None
    }

    fn signed(&mut self) -> Option<i64> {
        let number = self.unsigned()?;
        Some((number >> 1).cast_signed() ^ -(number & 1).cast_signed())
    }

    fn page(&mut self) -> Option<PageHeader> {
        let mut page = PageHeader::default();
        self.fields(&mut |path, number| {
            let field = match path {
                [1, 0, 0] => &mut page.kind,
                [2, 0, 0] => &mut page.uncompressed,
                [3, 0, 0] => &mut page.compressed,
                // Of a data page.
                [5, 1, 0] => &mut page.values,
                [5, 2, 0] => &mut page.encoding,
                _ => return,
            };
            *field = number;
        })?;
        Some(page)
    }

    /// Hands on every integer of a structure with the numbers of the fields that it lies in, the outermost first; `None` of what page
    /// headers do not have: lists, and structures more than three deep.
    fn fields(&mut self, number_at: &mut dyn FnMut([i64; 3], i64)) -> Option<()> {
        let (mut path, mut depth) = ([0; 3], 0);
        loop {
            let head = self.take(1)?[0];
            if head == 0 {
                // The end of a structure.
                path[depth] = 0;
                match depth.checked_sub(1) {
                    Some(outer) => depth = outer,
                    None => return Some(()),
                }
                continue;
            }
            path[depth] = match head >> 4 {
                0 => self.signed()?,
                more => path[depth].checked_add(i64::from(more))?,
            };
            match head & 15 {
                // True and false.
                1 | 2 => {}
                4..=6 => number_at(path, self.signed()?),
                8 => {
                    let length = self.unsigned()?.try_into().ok()?;
                    self.take(length)?;
                }
                12 if depth < 2 => depth += 1,
                _ => return None,
            }
        }
    }
}

fn read_error(path: &Path, what: impl fmt::Display) -> DatasetError {
    let reason = format!("not a readable Parquet file: {what}; write the dataset again");
    DatasetError::invalid(path, reason)
}

impl PartSource for ParquetSource {
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError> {
        while self.left == 0 {
            if self.next_group == self.file.num_row_groups() {
                return Ok(0);
            }
            let group = self.file.get_row_group(self.next_group);
            let group = group.map_err(|e| read_error(&self.path, e))?;
            let rows = usize::try_from(group.metadata().num_rows());
            self.left = rows.map_err(|_| {
                DatasetError::invalid(&self.path, "a row group has a negative number of rows")
            })?;
            let columns = self.columns.iter();
            let readers = columns.map(|&c| group.get_column_reader(c as usize));
            let readers = readers.collect::<Result<_, _>>();
            self.readers = readers.map_err(|e| read_error(&self.path, e))?;
            self.next_group += 1;
        }
        let count = self.left.min(max);
        for (reader, &column) in self.readers.iter_mut().zip(&self.columns) {
            let read = match (reader, rows.column_mut(column)) {
                (ColumnReader::FloatColumnReader(r), ColumnMut::F32(v)) => {
                    r.read_records(count, None, None, v)
                }
                (ColumnReader::Int32ColumnReader(r), ColumnMut::U32(v)) => {
                    self.signed.clear();
                    let read = r.read_records(count, None, None, &mut self.signed);
                    v.extend(self.signed.iter().map(|x| x.cast_unsigned()));
                    read
                }
                _ => unreachable!("the types were compared when the file was opened"),
            };
            let (read, _, _) = read.map_err(|e| read_error(&self.path, e))?;
            if read != count {
                let missing = count - read;
                let reason =
                    format!("column {column} ends {missing} rows early; write the dataset again");
                return Err(DatasetError::invalid(&self.path, reason));
            }
        }
        self.left -= count;
        Ok(count)
    }
}
