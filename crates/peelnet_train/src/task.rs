//! What a recipe is trained on.

use std::ops::Range;

use burn::tensor::Tensor;

use crate::network::Network;
use crate::training_data::TrainingData;

/// What examples are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Those that gradients come from.
    Train,
    /// Those that choices are made by.
    Validation,
    /// Those that are only reported.
    Test,
}

/// Examples on a device and their loss.
///
/// An example is what batches count: a fragment for recipes that learn from rows, a pixel with all of its fragments
/// for recipes that learn from pixels. A task keeps the tensors of one window of examples and hands out ranges of them.
pub trait Task: Send + Sync {
    /// Replaces the examples: number `i` is example `order[i]` of the data.
    fn load(&mut self, data: &TrainingData, order: &[u32]);

    /// The **sum** (not the mean) of the losses of a range of examples, `[1]`. The training loop divides the sum over a
    /// batch by the number of its examples.
    fn loss_sum(&self, network: &Network, range: Range<usize>) -> Tensor<1>;
}
