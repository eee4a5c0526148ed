//! Measures methods: errors against the exact image, times, memory, hard cases and number formats.
//!
//! ```text
//! scenes ─► bench: compare every view ─► rows (method × scene × view) ─► front, ratios, by_scene ─► recommend, family
//! hard cases ─► stress ─► rows (method × case × property)
//! path: every frame of a moving camera and moving objects ─► rows (method × scene, and × frame)
//! designs: fragments of a scene, composited on the CPU with each design of slabs ─► rows (design)
//! effects, scaling, numerics, learning ─► rows of their own
//! ```
//!
//! [`fn@bench`] compares methods and returns a [`Row`] for each method, scene and view. [`compare`] draws every view exactly
//! (`abuffer`) and with each method, and [`metrics`], [`perceptual`] and [`contours`] compute the differences. [`front`], [`ratios`] and [`by_scene`]
//! average the rows. The crate draws no charts and writes no pages: that is `peelnet_report`.
//!
//! A row is never left out because its result looks bad: components that are not finite are counted and enter the
//! error as black.

pub mod bench;
pub mod by_scene;
pub mod compare;
pub mod contours;
pub mod designs;
pub mod effects;
mod error;
pub mod family;
pub mod front;
pub mod learning;
mod machine;
mod mean;
pub mod metrics;
pub mod numerics;
mod partial;
pub mod path;
pub mod perceptual;
pub mod ratios;
pub mod recommend;
mod row;
pub mod scaling;
pub mod stress;
pub mod thesis;
pub mod transmittance;

pub use bench::bench;
pub use error::EvalError;
pub use machine::{Machine, load};
pub use mean::geometric_mean;
pub use partial::{Partial, settings_hash};
pub use row::{Row, methods_of, scenes_of};
