//! Pages, charts and tables of what `crate` measures.
//!
//! ```text
//! measured rows ─► Results { machine, command, measured } ─► JSON, CSV, Markdown, SVG and a page
//! ```
//!
//! [`Results`] is the one envelope of every kind of measurement. Each kind is a [`Measurement`] with its tables and charts,
//! which [`Results::write`] writes as a folder of files. Pages are one HTML file each, which needs neither network nor any other
//! file. They are built with maud, which escapes all text; charts come from `crate::chart`, which escapes as well.

mod bench;
pub mod dataset;
mod designs;
mod effects;
mod files;
mod page;
mod path;
mod picture;
mod preview;
mod results;
mod scaling;
mod stress;
mod table;
#[cfg(test)]
mod testing;
mod thesis;

pub use dataset::dataset_page;
pub use files::{kind_of, write_file};
pub use results::{Files, Measurement, Results};
pub use table::Table;
pub use thesis::{Stage, ThesisRun};
