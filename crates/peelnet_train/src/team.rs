//! Evaluates a range of examples in chunks on several threads, with a result that does not depend on their number.
//!
//! burn's CPU back end is single-threaded, and one large operation after the other streams every intermediate through
//! memory. A chunk's intermediates fit a core's cache. rayon's threads share the chunks; the results are added in the order of
//! the chunks, because rayon's own reduction adds in an order that depends on which thread was free.

use std::ops::Range;

use burn::tensor::Tensor;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::network::{Network, Shape};
use crate::task::Task;

/// What the threads of a pool evaluate. Its functions run in the pool: to enter it takes longer than a small batch.
pub(crate) struct Team<'a> {
    pub(crate) task: &'a dyn Task,
    pub(crate) shape: &'a Shape,
    /// Examples in a chunk.
    pub(crate) chunk: usize,
}

impl Team<'_> {
    /// Gradient of the summed loss of examples, then that loss: `[Shape::parameters + 1]`.
    pub(crate) fn gradient(&self, parameters: &Tensor<1>, range: Range<usize>) -> Tensor<1> {
        self.chunks(range, |range| {
            let network = Network::tracked(self.shape, parameters);
            let loss = self.task.loss_sum(&network, range);
            network.gradient(loss)
        })
        .into_iter()
        .reduce(|sum, chunk| sum + chunk)
        .expect("a batch holds at least one example")
    }

    /// The summed loss of each chunk of the first examples, in order.
    pub(crate) fn losses(&self, parameters: &Tensor<1>, examples: usize) -> Vec<Tensor<1>> {
        self.chunks(0..examples, |range| {
            let network = Network::new(self.shape, parameters);
            self.task.loss_sum(&network, range)
        })
    }

    /// What `evaluate` makes of each chunk of a range, in the order of the chunks.
    fn chunks(
        &self,
        range: Range<usize>,
        evaluate: impl Fn(Range<usize>) -> Tensor<1> + Sync,
    ) -> Vec<Tensor<1>> {
        (0..range.len().div_ceil(self.chunk))
            .into_par_iter()
            .map(|chunk| {
                let start = range.start + chunk * self.chunk;
                evaluate(start..(start + self.chunk).min(range.end))
            })
            .collect()
    }
}
