//! Measures methods: errors against the exact image, times, memory and stress cases.
//!
//! ```text
//! scenes ─► bench: compare every view ─► rows (method × scene × view) ─► rows, front ─► recommend
//! stress cases ─► stress ─► rows (method × case × property)
//! path: every frame of a moving camera and moving objects ─► rows (method × scene, and × frame)
//! designs: fragments of a scene, composited on the CPU with each design of slabs ─► rows (design)
//! effects, scaling ─► rows of their own
//! preview: what an extraction would write, in figures
//! ```
//!
//! [`fn@bench`] compares methods and returns a [`Row`] for each method, scene and view. [`compare`] draws every view exactly
//! (`abuffer`) and with each method, and [`metrics`], [`perceptual`] and [`contours`] compute the differences. [`front`] and [`rows`]
//! average the rows. [`report`] makes pages, charts and tables of them.
//!
//! A row is never left out because its result looks bad: components that are not finite are counted and enter the
//! error as black.
//!
//! In a browser, where nothing may wait and no C++ is compiled, there are only [`metrics`] and [`perceptual`] without ꟻLIP.
#![allow(missing_docs)]

pub mod metrics;
pub mod perceptual;

cfg_if::cfg_if! {
    if #[cfg(not(target_arch = "wasm32"))] {
        pub mod bench;
        pub mod chart;
        pub mod compare;
        pub mod contours;
        pub mod designs;
        pub mod effects;
        mod error;
        pub mod front;
        mod machine;
        mod partial;
        pub mod path;
        pub mod preview;
        pub mod recommend;
        mod records;
        pub mod report;
        pub mod rows;
        pub mod scaling;
        mod stage;
        pub mod stress;
        mod transmittance;

        pub use bench::bench;
        pub use error::EvalError;
        pub use machine::load;
        pub use partial::{Partial, json_hash};
        pub use records::{Machine, Row};
        pub use rows::{each_once, geometric_mean};
    }
}
