//! How far every method is from the exact image, and the report that says so.
//!
//! ```text
//! scene ─► compare ─► rows (method × scene × view) ─► table ─► findings
//!             │                                         └─────► report: results.json, table.md, report.html
//!             └─► images/<scene>-<method>.png (view 0)
//! ```
//!
//! [`compare`] draws every view of a scene once exactly (`abuffer`) and once with each method, and asks [`metrics`]
//! for the differences: one [`Row`] each, with the names that `results.json` uses. [`table`] averages the rows over
//! the views and sets them beside the figures of the thesis ([`thesis`]), [`findings`] derives from the same numbers
//! whether the learned weight does what it promises, in sentences that no one wrote by hand. [`report`] puts it all
//! into one folder; its page needs no network and no other file.
//!
//! A row is never left out because its result looks bad: components that are not finite are counted and enter the
//! error as black.

mod base64;
pub mod compare;
pub mod effects;
mod error;
mod files;
pub mod findings;
pub mod front;
pub mod learning;
mod lines;
mod machine;
pub mod metrics;
pub mod numerics;
mod partial;
pub mod perceptual;
pub mod ratios;
pub mod recommend;
pub mod report;
mod row;
pub mod scaling;
pub mod stress;
pub mod table;
pub mod thesis;
pub mod transmittance;

pub use error::EvalError;
pub use files::write_atomically;
use files::{write_csv, write_json};
pub use machine::{Machine, load};
pub use partial::Partial;
pub use report::{Record, Stage};
pub use row::Row;
