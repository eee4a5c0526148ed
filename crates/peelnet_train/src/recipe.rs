//! What each recipe takes, answers and is trained with. A recipe is one entry here and one [`Task`](crate::Task).

use peelnet_core::mlp::Activation;
use peelnet_model::{Output, Recipe};

use crate::config::{Config, Schedule};
use crate::error::TrainError;

/// An input of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Feature {
    /// Name in the model file and in the exported function; a column of the dataset where the recipe uses columns as
    /// they are.
    pub name: &'static str,
    /// Unit, for readers of the model file.
    pub unit: &'static str,
}

/// A recipe's fixed parts.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Inputs, in order.
    pub features: &'static [Feature],
    /// What the network's answer means.
    pub output: Output,
    /// Width of the last layer.
    pub outputs: usize,
    /// The published settings.
    pub config: Config,
}

const THESIS: &[Feature] = &[
    Feature {
        name: "linear_depth",
        unit: "scene units",
    },
    Feature {
        name: "alpha_sum",
        unit: "1",
    },
    Feature {
        name: "fragment_count",
        unit: "1",
    },
];

/// Looks a recipe up.
pub(crate) fn definition(recipe: Recipe) -> Result<Definition, TrainError> {
    match recipe {
        Recipe::Thesis => Ok(Definition {
            features: THESIS,
            output: Output::Transmittance,
            outputs: 1,
            config: Config {
                recipe,
                seed: 1,
                hidden: vec![10, 8],
                hidden_activation: Activation::Relu,
                output_activation: Activation::Identity,
                epochs: 150,
                batch: 128,
                chunk: 2048,
                learning_rate: 1e-4,
                schedule: Schedule::Constant,
                beta1: 0.9,
                beta2: 0.999,
                epsilon: 1e-8,
                held_out: 1.0 / 3.0,
                patience: None,
            },
        }),
        other => Err(TrainError::Recipe(other)),
    }
}

impl Definition {
    /// The definition of a recipe.
    ///
    /// # Errors
    /// [`TrainError::Recipe`] when the trainer does not know it.
    pub fn of(recipe: Recipe) -> Result<Self, TrainError> {
        definition(recipe)
    }
}
