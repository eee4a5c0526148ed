//! What a recipe is trained on.

use std::ops::Range;

use burn::tensor::Tensor;

use crate::network::Network;

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
/// for recipes that learn from pixels. A task keeps its tensors in the order of the epoch and hands out ranges of them.
pub trait Task: Send + Sync {
    /// Number of examples of a part.
    fn examples(&self, part: Part) -> usize;

    /// Puts the training examples in the order of an epoch: example `order[i]` of the original order becomes number `i`.
    fn shuffle(&mut self, order: &[u32]);

    /// The **sum** (not the mean) of the losses of a range of examples, `[1]`. The training loop divides the sum over a
    /// batch by the number of its examples.
    fn loss_sum(&self, network: &Network, part: Part, range: Range<usize>) -> Tensor<1>;
}
