//! Bakes a trained network into one self-contained shader function, and proves that it is the same network.
//!
//! [`wgsl()`] writes the text: straight-line code on `vec4f` and `mat4x4f` literals, normalisation and guards inside, a
//! header that names its source and says how to use it in another engine. [`verify()`] runs exactly that text on
//! the GPU over random, extreme and self-test inputs and compares with the trainer's forward pass. [`export()`] does
//! both and writes the file only if they agree. The renderer draws with the same text, so that what is measured is
//! what is shipped.

mod description;
mod header;
mod literal;
mod network;
mod verify;
mod wgsl;
// A browser has no files.
#[cfg(not(target_arch = "wasm32"))]
mod write;

pub use description::{Blend, Description, Pass, Target};
pub use verify::{Verification, evaluate_async, verify_async};
#[cfg(not(target_arch = "wasm32"))]
pub use verify::{evaluate, verify};
pub use wgsl::{multiply_adds, wgsl};
#[cfg(not(target_arch = "wasm32"))]
pub use write::export;

use peelnet_files::Kind;
use std::path::PathBuf;

/// By what an exported text is known: its first lines.
pub const KIND: Kind = Kind {
    name: "an exported shader",
    is: |head| {
        let start = String::from_utf8_lossy(&head[..head.len().min(512)]);
        start.starts_with("// ") && start.contains(header::EXPORTED_BY)
    },
};

/// How to export. Languages and precisions other than WGSL in 32 bits will add fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Options {}

/// What can go wrong while exporting.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A model that does not hold together.
    #[error("the model cannot be exported: {0}")]
    Model(#[from] peelnet_model::Problem),
    /// The text is not valid or does not link: a bug here, or an edited text.
    #[error(transparent)]
    Shader(#[from] peelnet_shaders::ShaderError),
    /// The text declares something else than the functions that are exported with the model: an edited text.
    #[error(
        "the exported text holds other declarations than the model's: {found}; nothing was written"
    )]
    Declares {
        /// What it declares.
        found: String,
    },
    /// The GPU.
    #[error(transparent)]
    Gpu(#[from] peelnet_gpu::GpuError),
    /// The text computes something else than the model.
    #[error(
        "the exported function differs from the model: inputs {inputs:?} give {found} instead of {expected} (allowed difference {tolerance:e}); nothing was written"
    )]
    Differs {
        /// Raw inputs of the worst sample.
        inputs: Vec<f32>,
        /// What the GPU answered.
        found: f32,
        /// What the model answers in 64 bits.
        expected: f64,
        /// Allowed difference there.
        tolerance: f64,
    },
    /// The file could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
}
