//! What can be wrong with a model file.

use std::io;
use std::path::{Path, PathBuf};

use peelnet_core::mlp::ShapeError;

use crate::metadata::{FORMAT_VERSION, Output};
use crate::recipe::Recipe;

/// An error of loading or saving a model.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        path: PathBuf,
        action: &'static str,
        source: io::Error,
    },
    /// The file, or the model that was to be saved, is not a usable model.
    #[error("{}: {problem}", path.display())]
    Invalid { path: PathBuf, problem: Problem },
    /// A recipe whose network does not ship.
    #[error("no network ships for recipe {0}; train one and name its file")]
    NotShipped(Recipe),
}

impl ModelError {
    pub(crate) fn invalid(path: &Path) -> impl FnOnce(Problem) -> Self {
        |problem| Self::Invalid {
            path: path.to_owned(),
            problem,
        }
    }
}

/// What is wrong with a model.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// Not a safetensors file, or a truncated one.
    #[error(
        "not a readable safetensors file ({0}): it was cut off or is something else; train or copy the model again"
    )]
    NotSafetensors(String),
    /// A safetensors file of another program.
    #[error(
        "no `peelnet` entry in the metadata: the file is not a peelnet model; give one that `peelnet train` wrote"
    )]
    NotOurs,
    /// Another version of the format.
    #[error(
        "model format {0}, but this program reads format {FORMAT_VERSION}; train again with this version"
    )]
    Version(u64),
    /// The metadata cannot be understood.
    #[error("metadata: {0}; train again with this version")]
    Metadata(String),
    /// A metadata number that no arithmetic can use.
    #[error("metadata: {field} is {value}, it must be {allowed}; train again")]
    Value {
        field: String,
        value: String,
        allowed: &'static str,
    },
    /// A tensor is missing.
    #[error(
        "tensor {0:?} is missing; the tensors must be layers.0.weight, layers.0.bias, layers.1.weight, …"
    )]
    MissingTensor(String),
    /// A tensor that is not a layer.
    #[error(
        "tensor {0:?} belongs to no layer; the tensors must be layers.0.weight, layers.0.bias, layers.1.weight, …"
    )]
    UnknownTensor(String),
    /// A tensor of the wrong type or shape.
    #[error("tensor {name:?} is {found}, expected {expected}")]
    Tensor {
        name: String,
        found: String,
        expected: String,
    },
    /// Layers that do not fit one another.
    #[error("the network's shapes are wrong: {0}")]
    Shape(#[from] ShapeError),
    /// A weight that is not a number.
    #[error(
        "tensor {name:?}: value {index} is {value}, all weights must be finite; the training diverged, train again with a lower rate"
    )]
    NotFinite {
        name: String,
        index: usize,
        value: String,
    },
    /// The network does not take the inputs that the metadata lists.
    #[error("the network takes {network} inputs but the metadata lists {listed}")]
    InputCount { network: usize, listed: usize },
    /// The model was made for other features.
    #[error("made for other features: recipe {recipe} takes {expected}, the model lists ({}); train again with this version", found.join(", "))]
    Features {
        recipe: Recipe,
        expected: String,
        found: Vec<String>,
    },
    /// An output that the recipe does not have.
    #[error("recipe {recipe} does not predict {output}")]
    OutputKind { recipe: Recipe, output: Output },
    /// The network does not have as many outputs as the output parametrisation.
    #[error("the network gives {network} outputs where {output} has {expected}")]
    OutputCount {
        network: usize,
        output: Output,
        expected: usize,
    },
}
