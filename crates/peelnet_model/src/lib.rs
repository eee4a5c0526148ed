//! The model file: a trained network with everything that is needed to use it and to know where it comes from.
//!
//! A model is one [safetensors](https://huggingface.co/docs/safetensors) file. Its tensors are the affine layers of
//! a [`peelnet_core::mlp::Mlp`] under PyTorch's names (`layers.0.weight` with shape `[outputs, inputs]`,
//! `layers.0.bias`, …), so that PyTorch loads the file as a state dict. The header's metadata has one entry,
//! `peelnet`: a JSON object with the [`Metadata`] and the network's activations. `docs/model-file.md` describes the
//! file for other programs.
//!
//! ```text
//! raw features ──(raw − offset)·scale──► Mlp ──guard of the output──► prediction
//!   scene units      Metadata::inputs           Metadata::output
//! ```
//!
//! Normalisation and guards belong to the model: [`Model::forward_raw`] takes features in scene units and gives what
//! a renderer may use. The same arithmetic is what an exported shader function contains.
//!
//! [`Model::load`] accepts only what [`Model::check`] accepts: finite weights, layers that fit one another, and
//! exactly the inputs that the recipe knows. The same model always gives the same bytes, so [`Model::hash`] names
//! it. Files are written beside their target and renamed.

mod error;
mod file;
pub mod inputs;
mod metadata;
mod model;
mod output;
mod recipe;

pub use error::{ModelError, Problem};
pub use file::{KIND, MAX_BYTES};
pub use metadata::{DatasetRef, FORMAT_VERSION, Input, Losses, Metadata};
pub use model::{MAX_HIDDEN_LAYERS, Model};
pub use output::{BOUNDS, Output};
pub use recipe::{Budget, Declaration, Network, PixelLoss, Recipe};
