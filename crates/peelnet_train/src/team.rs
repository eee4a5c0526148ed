//! Evaluates a range of examples in chunks on several threads, with a result that does not depend on their number.
//!
//! burn's CPU back end is single-threaded, and one large operation after the other streams every intermediate through
//! memory. A chunk's intermediates fit a core's cache. Threads take the next chunk when they are done with one; the
//! results are put back in the order of the chunks before they are added.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use burn::tensor::Tensor;

use crate::network::{Network, Shape};
use crate::task::{Part, Task};

/// What to compute.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// `[Shape::parameters + 1]`: gradient of the summed loss, and that loss.
    Gradient,
    /// `[1]`: the summed loss.
    Loss,
}

struct Job {
    parameters: Tensor<1>,
    wanted: Wanted,
    part: Part,
    range: Range<usize>,
    chunks: usize,
    /// The next chunk that nobody has taken.
    next: AtomicUsize,
}

type Results = Vec<(usize, Tensor<1>)>;

/// The threads of a scope, and what they work on.
pub(crate) struct Team<'a> {
    task: &'a dyn Task,
    shape: &'a Shape,
    chunk: usize,
    helpers: Vec<Sender<Arc<Job>>>,
    done: Receiver<Results>,
}

impl<'a> Team<'a> {
    /// Runs `work` with `threads − 1` helpers beside the calling thread.
    pub(crate) fn with<R>(
        threads: usize,
        task: &'a dyn Task,
        shape: &'a Shape,
        chunk: usize,
        work: impl FnOnce(&Self) -> R,
    ) -> R {
        std::thread::scope(|scope| {
            let (finished, done) = channel();
            let helpers = (1..threads)
                .map(|_| {
                    let (jobs, inbox) = channel::<Arc<Job>>();
                    let finished = finished.clone();
                    scope.spawn(move || {
                        while let Ok(job) = inbox.recv() {
                            let results = take_chunks(&job, task, shape, chunk);
                            drop(job);
                            if finished.send(results).is_err() {
                                break;
                            }
                        }
                    });
                    jobs
                })
                .collect();
            // The last sender must be a helper's, or a helper that panics would leave `recv` waiting for ever.
            drop(finished);
            work(&Self {
                task,
                shape,
                chunk,
                helpers,
                done,
            })
        })
    }

    pub(crate) fn examples(&self, part: Part) -> usize {
        self.task.examples(part)
    }

    /// Gradient of the summed loss of training examples, then that loss: `[Shape::parameters + 1]`.
    pub(crate) fn gradient(&self, parameters: &Tensor<1>, range: Range<usize>) -> Tensor<1> {
        self.run(parameters, Wanted::Gradient, Part::Train, range)
            .into_iter()
            .reduce(|sum, chunk| sum + chunk)
            .expect("a batch holds at least one example")
    }

    /// The summed loss of each chunk of a whole part, in order.
    pub(crate) fn losses(&self, parameters: &Tensor<1>, part: Part) -> Vec<Tensor<1>> {
        self.run(parameters, Wanted::Loss, part, 0..self.task.examples(part))
    }

    fn run(
        &self,
        parameters: &Tensor<1>,
        wanted: Wanted,
        part: Part,
        range: Range<usize>,
    ) -> Vec<Tensor<1>> {
        let chunks = range.len().div_ceil(self.chunk);
        let job = Arc::new(Job {
            parameters: parameters.clone(),
            wanted,
            part,
            range,
            chunks,
            next: AtomicUsize::new(0),
        });
        // A helper that would find no chunk is not woken.
        let woken = self.helpers.len().min(chunks.saturating_sub(1));
        for helper in &self.helpers[..woken] {
            helper
                .send(Arc::clone(&job))
                .expect("a helper listens until its team is dropped");
        }
        let mut results = take_chunks(&job, self.task, self.shape, self.chunk);
        for _ in 0..woken {
            results.extend(self.done.recv().expect("a helper answers every job"));
        }
        results.sort_unstable_by_key(|&(chunk, _)| chunk);
        results.into_iter().map(|(_, tensor)| tensor).collect()
    }
}

/// Takes chunks until none is left.
fn take_chunks(job: &Job, task: &dyn Task, shape: &Shape, size: usize) -> Results {
    let mut results = Vec::new();
    loop {
        let chunk = job.next.fetch_add(1, Ordering::Relaxed);
        if chunk >= job.chunks {
            return results;
        }
        let start = job.range.start + chunk * size;
        let range = start..(start + size).min(job.range.end);
        let result = match job.wanted {
            Wanted::Gradient => {
                let network = Network::tracked(shape, &job.parameters);
                let loss = task.loss_sum(&network, job.part, range);
                network.gradient(loss)
            }
            Wanted::Loss => {
                let network = Network::new(shape, &job.parameters);
                task.loss_sum(&network, job.part, range)
            }
        };
        results.push((chunk, result));
    }
}
