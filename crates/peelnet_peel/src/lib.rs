//! Peels scenes on the GPU and writes every fragment to a dataset.
//!
//! A scene, a varied copy of it and a view make a work item ([`items`]); work items are independent, so shards take
//! them in turn. For each, [`read_back::FragmentReader`] finds all fragments in one of three ways — S-buffer, dual or single
//! peeling — which leave the same thing in GPU storage: per pixel a run of fragments, front to back. A second thread
//! turns runs into rows and writes them ([`extract()`]) or hands them to a program ([`batches()`]) while the GPU
//! works on the next tile. Memory is bounded by the tile's budget, whatever the number of views or fragments.

mod batches;
mod error;
mod extract;
pub mod items;
pub mod read_back;
mod rows;
pub mod synthetic;

pub use batches::{Batches, batches, peel_rows};
pub use error::PeelError;
pub use extract::{ExtractOptions, ExtractReport, Progress, extract};
pub use read_back::Peel;
