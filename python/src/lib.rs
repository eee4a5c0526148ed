//! The native half of the Python package `peelnet`: classes and functions over the library of the same name.
//!
//! A file a subject. Long work runs on a thread of its own ([`watch`]), so that Python keeps its GIL and hears Ctrl-C; errors become
//! exceptions in [`failure`], with the texts of the command line.

mod argument;
mod bench;
mod failure;
mod gpu;
mod json;
mod model;
mod render;
mod rows;
mod scene;
mod train;
mod watch;

use pyo3::prelude::*;

/// The native half of `peelnet`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        bench::{Choice, Recommendation, bench, recommend},
        failure::PeelnetError,
        gpu::adapter_name,
        model::{Model, export},
        render::{methods, render},
        rows::{Dataset, Rows, extract_rows, seal},
        scene::{Camera, Scene, samples},
        train::{Epoch, Training, train},
    };
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
