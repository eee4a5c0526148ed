//! What each recipe takes, answers and is trained with. A recipe is one entry here and one [`Task`](crate::Task).

use peelnet_core::mlp::Activation;
use peelnet_model::{Output, Recipe};

use crate::config::{Config, PixelLoss, Schedule};
use crate::pixels;

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
    pub features: Vec<Feature>,
    /// What the network's answer means.
    pub output: Output,
    /// Width of the last layer.
    pub outputs: usize,
    /// The published settings.
    pub config: Config,
}

impl Definition {
    /// The definition of a recipe. The networks and the thesis's settings are published; those of our own networks were
    /// chosen on validation pixels.
    pub fn of(recipe: Recipe) -> Self {
        let features = recipe
            .input_names()
            .iter()
            .map(|&name| Feature {
                name,
                unit: pixels::unit(name),
            })
            .collect();
        let thesis = Config {
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
            validation: 0.0,
            patience: None,
            loss: PixelLoss::default(),
        };
        let pixels = |hidden: &[usize]| Config {
            hidden: hidden.to_vec(),
            output_activation: Activation::Sigmoid,
            epochs: 24,
            batch: 1024,
            chunk: 256,
            learning_rate: 4e-3,
            schedule: Schedule::OneCycle { warmup: 0.2 },
            held_out: 0.1,
            validation: 0.1,
            ..thesis.clone()
        };
        // The competitors' batches are rows: as many fragments as ours have on average.
        let rows = |hidden: &[usize]| Config {
            batch: 8192,
            chunk: 2048,
            ..pixels(hidden)
        };
        let (output, config) = match recipe {
            Recipe::Thesis => (Output::Transmittance, thesis),
            Recipe::Small => (Output::AnchoredShare, pixels(&[8])),
            Recipe::Medium => (Output::AnchoredShareSeparateEnds, pixels(&[12])),
            Recipe::Large => (
                Output::AnchoredShareSeparateEnds,
                Config {
                    epochs: 80,
                    ..pixels(&[14, 9])
                },
            ),
            Recipe::Nmt => (Output::Transmittance, rows(&[32, 16])),
            Recipe::Dfaoit => (
                Output::TailColor,
                Config {
                    batch: 1024,
                    ..rows(&[32, 16])
                },
            ),
        };
        Self {
            features,
            output,
            outputs: output.count(),
            config,
        }
    }
}
