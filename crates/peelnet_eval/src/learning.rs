//! What accuracy costs in training: error against the number of parameters, of training examples, and of epochs.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Varied {
    /// Hidden layers.
    Parameters,
    /// The share of the training examples that is used.
    Examples,
    /// Passes over them.
    Epochs,
}

impl Varied {
    /// Everything that is varied.
    pub const ALL: [Self; 3] = [Self::Parameters, Self::Examples, Self::Epochs];
}

impl fmt::Display for Varied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Parameters => "parameters",
            Self::Examples => "examples",
            Self::Epochs => "epochs",
        })
    }
}

/// One trained network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lesson {
    /// What varies.
    pub varied: Varied,
    /// Layers, such as `9-12-1`.
    pub topology: String,
    /// Weights and biases.
    pub parameters: u64,
    /// Examples that it was trained on.
    pub examples: u64,
    /// Passes over them.
    pub epochs: u32,
    /// Seconds of training.
    pub seconds: f64,
    /// Geometric mean of `mse_linear` over scenes and views.
    pub mse_linear: f64,
    /// The same over that of `mboit4`.
    pub to_moments: f64,
}

impl Lesson {
    /// How much there is of what varies.
    pub fn value(&self) -> f64 {
        match self.varied {
            Varied::Parameters => self.parameters as f64,
            Varied::Examples => self.examples as f64,
            Varied::Epochs => f64::from(self.epochs),
        }
    }
}

/// All trained networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learning {
    /// The recipe whose inputs and output form all networks have.
    pub recipe: String,
    /// Every network.
    pub rows: Vec<Lesson>,
}
