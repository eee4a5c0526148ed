//! Measures methods: errors against the exact image, times, memory and hard cases.
//!
//! ```text
//! scenes ─► bench: compare every view ─► rows (method × scene × view) ─► front, ratios, by_scene ─► recommend
//! hard cases ─► stress ─► rows (method × case × property)
//! path: every frame of a moving camera and moving objects ─► rows (method × scene, and × frame)
//! designs: fragments of a scene, composited on the CPU with each design of slabs ─► rows (design)
//! effects, scaling ─► rows of their own
//! ```
//!
//! [`fn@bench`] compares methods and returns a [`Row`] for each method, scene and view. [`compare`] draws every view exactly
//! (`abuffer`) and with each method, and [`metrics`], [`perceptual`] and [`contours`] compute the differences. [`front`], [`ratios`] and [`by_scene`]
//! average the rows. The crate draws no charts and writes no pages: that is `peelnet_report`.
//!
//! A row is never left out because its result looks bad: components that are not finite are counted and enter the
//! error as black.
//!
//! In a browser, where nothing may wait and no C++ is compiled, there are only [`metrics`] and [`perceptual`] without ꟻLIP.

#[cfg(not(target_arch = "wasm32"))]
pub mod bench;
#[cfg(not(target_arch = "wasm32"))]
pub mod by_scene;
#[cfg(not(target_arch = "wasm32"))]
pub mod compare;
#[cfg(not(target_arch = "wasm32"))]
pub mod contours;
#[cfg(not(target_arch = "wasm32"))]
pub mod designs;
#[cfg(not(target_arch = "wasm32"))]
pub mod effects;
mod error;
#[cfg(not(target_arch = "wasm32"))]
pub mod front;
#[cfg(not(target_arch = "wasm32"))]
mod machine;
#[cfg(not(target_arch = "wasm32"))]
mod mean;
pub mod metrics;
#[cfg(not(target_arch = "wasm32"))]
mod partial;
#[cfg(not(target_arch = "wasm32"))]
pub mod path;
pub mod perceptual;
#[cfg(not(target_arch = "wasm32"))]
pub mod ratios;
#[cfg(not(target_arch = "wasm32"))]
pub mod recommend;
#[cfg(not(target_arch = "wasm32"))]
mod row;
#[cfg(not(target_arch = "wasm32"))]
pub mod scaling;
#[cfg(not(target_arch = "wasm32"))]
pub mod stress;
#[cfg(not(target_arch = "wasm32"))]
pub mod thesis;
#[cfg(not(target_arch = "wasm32"))]
pub mod transmittance;

#[cfg(not(target_arch = "wasm32"))]
pub use bench::bench;
pub use error::EvalError;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use error::check_stop;
#[cfg(not(target_arch = "wasm32"))]
pub use machine::{Machine, load};
#[cfg(not(target_arch = "wasm32"))]
pub use mean::geometric_mean;
#[cfg(not(target_arch = "wasm32"))]
pub use partial::{Partial, settings_hash};
#[cfg(not(target_arch = "wasm32"))]
pub use row::{Row, each_once, methods_of, scenes_of};
