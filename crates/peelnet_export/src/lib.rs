//! Bakes a trained network into one self-contained shader function, and proves that it is the same network.
//!
//! [`wgsl()`] writes the text: straight-line code on `vec4f` and `mat4x4f` literals, normalisation and guards inside, a
//! header that names its source and says how to use it in another engine. [`text()`] translates it into other languages, and [`json()`]
//! says for programs what the header says for people. [`verify()`] runs exactly that text on
//! the GPU over random, extreme and self-test inputs and compares with the trainer's forward pass. [`export()`] does
//! all of it and writes the files only if they agree. The renderer draws with the same text, so that what is measured is
//! what is shipped.

mod description;
mod header;
mod json;
mod language;
mod literal;
mod network;
mod self_test;
mod text;
// A browser has no files, and nothing in it may block.
#[cfg(not(target_arch = "wasm32"))]
mod verify;

pub use description::Description;
pub use json::json;
pub use language::Language;
pub use peelnet_model::inputs::{Blend, Pass, Target, Value, ValueKind};
pub use self_test::{Drawn, Pixel, Point, SelfTest};
pub use text::{text, wgsl};
#[cfg(not(target_arch = "wasm32"))]
pub use verify::{Verification, description_path, evaluate, export, other_described, verify};

use peelnet_core::files::Kind;
/// By what an exported text is known: its first lines.
pub const KIND: Kind = Kind {
    name: "an exported shader",
    is: |head| {
        let start = String::from_utf8_lossy(&head[..head.len().min(512)]);
        start.starts_with("// ") && start.contains(header::EXPORTED_BY)
    },
};

/// By what the description beside an exported text is known.
pub const JSON_KIND: Kind = Kind {
    name: "an exported description",
    is: |head| {
        let start = String::from_utf8_lossy(&head[..head.len().min(512)]);
        let start: String = start.split_whitespace().collect();
        start.starts_with(&format!("{{\"format\":\"{}\"", json::FORMAT))
    },
};

/// How to export.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Into which language.
    pub language: Language,
    /// How the network's layers are computed.
    pub precision: Precision,
}

/// How a network's layers are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// In 32 bits.
    #[default]
    F32,
    /// In 16 bits, but the last one. A text whose answers differ by more than [`EXPORT_F16`](peelnet_core::tolerance::EXPORT_F16) is not written.
    F16,
}

/// What can go wrong while exporting.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A model that does not hold together.
    #[error("the model cannot be exported: {0}")]
    Model(#[from] peelnet_model::Problem),
    /// The text is not valid or does not link: a bug here, or an edited text.
    #[error(transparent)]
    Shader(#[from] peelnet_render::shaders::ShaderError),
    /// The GPU.
    #[error("{0}")]
    Gpu(#[from] peelnet_render::gpu::GpuError),
    /// A text that a language cannot hold, that is not the model's, or that cannot be written.
    #[error("{0}")]
    Refused(String),
}
