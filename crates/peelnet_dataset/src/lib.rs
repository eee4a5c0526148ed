//! The fragment dataset: what peeling writes and training reads.
//!
//! A dataset is a folder, or a prefix of a bucket. It holds one *part* for every work item (scene × augmentation copy × view), as files
//! that lie flat in the folder, with a card beside them once it is sealed. Everything else lies in `_peelnet/`. DuckDB, Polars, pyarrow,
//! Ray Data and Hugging Face `datasets` read a sealed folder as one table.
//!
//! ```text
//! DATASET/
//!   fragments-00000-sixteen-050-v0.parquet    work item 0: every row has view = 0
//!   fragments-00001-sixteen-050-v1.parquet    work item 1: every row has view = 1
//!   _peelnet/plan.json                        what all writers agree on, and its hash
//!   _peelnet/parts/00000.json                 work item 0 is finished: counts, sha256 of its files, its writer
//!   _peelnet/parts/00001.json
//!   README.md                                 the card: what this is, for people and for the Hugging Face hub
//!   croissant.json                            the same for programs (Croissant 1.1): files with hashes, columns, provenance
//!   picture-00000.png                         a picture of each scene for the card
//!   _peelnet/manifest.json                    the seal: scenes, cameras, counts, statistics by column, sha256 of every file
//! ```
//!
//! A row is one fragment, and its columns are those of [`Column`], always in that order. The rows of one
//! pixel are adjacent and go from the nearest fragment to the farthest; (`view`, `x`, `y`) is unique in a dataset,
//! because `view` is the index of the work item.
//!
//! **Writing** is streamed: [`DatasetWriter::create`], [`PartWriter::write`], [`PartWriter::finish`], [`DatasetWriter::finish`]. Parts are
//! written in a hidden folder; finishing one moves its files into place and then creates its record, from when on it is the dataset's,
//! whatever happens to its writer. Memory holds one row group (2²⁰ rows, about 60 MB) at most. The bytes depend on the rows alone, not on
//! the number of threads or the batches.
//!
//! **Many writers** need no coordinator, no lock and no clock: a record is created only where there is none, by one operation of
//! the file system or the object store. A second writer of a part compares the hashes: equal ones are no error, and different ones name the
//! part and both workers. The plan has a hash over everything that shapes the rows: scenes by their contents, the frame size, seed, flags,
//! format, cameras, peelnet's version and the class of the adapter. A writer with another plan is refused before its first row.
//! [`Header::shard`] takes every N-th work item, [`Header::resume`] whatever is missing. Whoever finishes the last part seals the dataset,
//! and [`seal`](fn@seal) does it afterwards; the manifest's bytes do not depend on who does.
//!
//! **Statistics** of every column (see [`ColumnStatistics`]) are gathered while rows are written, kept in a part's record, and merged by the
//! seal, in the parts' order. **The card** follows from plan and manifest. It is written once, with the seal, and never replaced: an edited
//! card is the user's, see [`foreign_card`]. Nothing that reads rows reads it.
//!
//! **Reading.** [`Dataset::open`] checks the manifest and the sizes of all files; the hash of a file is checked before its
//! first row is read. [`Dataset::batches`] streams whole pixels, [`Dataset::read_columns`] loads chosen columns. Every value is
//! checked against its column's range on the way in *and* on the way out, so a NaN cannot reach a network. [`summary`] recomputes what the
//! rows claim about one another, and [`split`] says which pixels train and which judge.
//!
//! **Object stores.** With the feature `object-store`, `s3://bucket/prefix`, `gs://…` and `az://…` stand wherever a folder does, as
//! `file:///…` does always. Settings and credentials come from the environment (`AWS_…`, `GOOGLE_…`, `AZURE_…`). A part is written on this
//! machine and sent by one conditional request for each file; a part that is read is fetched whole. Datasets there are never replaced.

mod card;
mod column;
mod error;
mod folder;
mod formats;
mod hash;
mod manifest;
mod parts;
mod picture;
mod plan;
mod reader;
pub mod split;
mod statistics;
mod store;
pub mod summary;
mod writer;

pub use card::rounded;
pub use column::{
    Column, ColumnKind, ColumnSlice, ColumnValues, FragmentBatch, PeeledFragment, Typed,
};
pub use error::DatasetError;
pub use folder::replaces;
pub use formats::{Format, ROW_GROUP_ROWS};
pub use hash::sha256;
pub use manifest::{
    CameraInfo, ColumnEntry, FileEntry, MAX_WORK_ITEMS, Manifest, Part, SCHEMA_VERSION, SceneEntry,
};
pub use parts::{FOREIGN_CARD, foreign_card, seal, unsealed_parts};
pub use peelnet_core::files::is_remote;
pub use plan::{Header, Shard, worker_name};
pub use reader::{Batches, Dataset};
pub use split::{Split, SplitBy, Subset};
pub use statistics::ColumnStatistics;
pub use store::{create_object, read_object};
pub use summary::{Summary, check_rows};
pub use writer::{DatasetWriter, PartWriter};
