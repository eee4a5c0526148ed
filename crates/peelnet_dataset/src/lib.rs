//! The fragment dataset: what peeling writes and training reads.
//!
//! A dataset is a folder. It holds one *part* for every work item (scene × augmentation copy × view), as files that
//! lie flat in the folder, and a `manifest.json` that names them all. Parts are written independently and in any
//! order; the manifest comes last, so a folder without one is a run that did not end.
//!
//! ```text
//! DATASET/
//!   manifest.json                             schema, scenes, cameras, counts, sha256 of every file
//!   fragments-00000-sixteen-050-v0.parquet    work item 0: every row has view = 0
//!   fragments-00001-sixteen-050-v1.parquet    work item 1: every row has view = 1
//! ```
//!
//! A row is one fragment, and its columns are the fourteen of [`Column`], always in that order. The rows of one
//! pixel are adjacent and go from the nearest fragment to the farthest; (`view`, `x`, `y`) is unique in a dataset,
//! because `view` is the index of the work item.
//!
//! **Writing** is streamed. [`DatasetWriter::create`] opens a hidden folder inside the dataset's, parts are written
//! there through [`PartWriter`], and [`DatasetWriter::finish`] moves everything into place; a writer that is dropped
//! before that leaves nothing behind. An older dataset is replaced, but never a file that its manifest does not list. Memory holds one row group (2²⁰ rows, about 60 MB) at most, whatever the
//! number of fragments. The bytes depend on the rows alone: neither the number of threads nor the way the rows were
//! cut into batches changes them.
//!
//! **Formats.** Each is one file in `formats/` behind the traits `PartSink` and `PartSource`: CSV with a header
//! row, Parquet (PLAIN pages, snappy), and NPY as one one-dimensional array per column
//! (`fragments-00000-cups-v0.linear_depth.npy`), which `numpy.load` opens or maps into memory directly.
//!
//! **Reading.** [`Dataset::open`] checks the manifest and the sizes of all files; the hash of a file is checked before its
//! first row is read. [`Dataset::batches`] streams whole pixels, [`Dataset::read_columns`] loads chosen columns. Every value is
//! checked against its column's range on the way in *and* on the way out, so a NaN cannot reach a network.
//!
//! **Shards.** `--shard I/N` writes the work items k with k ≡ I (mod N) into `DIR/shard-I-of-N/`, a dataset of its
//! own. Opening `DIR` merges them: same rows, same order and the same [`Dataset::hash`] as the whole dataset written
//! in one run, because the hash covers (part index, sha256) pairs and nothing of the way they were made.
//!
//! [`summary`] recomputes what the rows claim about one another, and [`split`] says which pixels train and which
//! judge.

mod batch;
mod column;
mod error;
mod folder;
mod format;
mod formats;
mod hashed_file;
mod layout;
mod manifest;
mod old_shards;
mod plan;
mod reader;
mod record;
mod seal;
mod shard;
pub mod split;
mod store;
pub mod summary;
mod validate;
mod worker;
mod writer;

pub use batch::FragmentBatch;
pub use column::{Column, ColumnData, ColumnKind, ColumnSlice};
pub use error::DatasetError;
pub use folder::replaces;
pub use format::{Format, ROW_GROUP_ROWS};
pub use manifest::{
    CameraInfo, ColumnEntry, FileEntry, MAX_WORK_ITEMS, Manifest, Part, SCHEMA_VERSION, SceneEntry,
};
pub use plan::Plan;
pub use reader::{Batches, Dataset};
pub use seal::seal;
pub use shard::Shard;
pub use split::{Split, SplitBy, Subset};
pub use store::is_remote;
pub use summary::Summary;
pub use worker::worker_name;
pub use writer::{DatasetWriter, Header, PartCounts, PartInfo, PartWriter};
