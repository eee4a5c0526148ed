//! Trains peelnet's networks with burn.
//!
//! ```text
//! datasets ─► loader, examples ─► table, in memory or in a scratch file ─► sampler ─► windows ─► loss ─┐
//!                                                                                                     ├─► loop
//! Config, seed ─► Shape ─► one row of weights ─► network, optimizer ──────────────────────────────────┘
//!                                                                        loop ─► checkpoint, model file
//! ```
//!
//! [`train`] takes the examples of datasets ([`TrainingData`]) and a [`Config`]. What a recipe is trained *on* is its rows or pixels in the
//! table; what it minimises is in `loss`. The loop, the gradient, and checkpoints know nothing about recipes.
//!
//! # What makes it fast
//!
//! These networks have a few hundred parameters, so arithmetic is cheap and everything around it is not.
//!
//! - *Passes of our own.* `network` runs 64 rows side by side through all layers and back, in vector instructions, without a tensor. What is
//!   beyond the network, the loss of whole pixels, is burn's: it differentiates it by the network's answers.
//! - *Cache-sized chunks.* A batch is cut into chunks of [`Config::chunk`] examples, spread over the threads. The
//!   gradients are added in the order of the chunks. The cut does not depend on the number of threads, so neither does
//!   a single bit of the result.
//!
//! # Memory
//!
//! Examples are in memory ([`TrainingData::from_datasets`]) or streamed ([`TrainingData::streamed`]).
//!
//! In memory they are there twice: as columns, and normalised in the order of the epoch. Of a dataset with more than [`Config::max_rows`]
//! rows, whole pixels are drawn from the seed, the same share of every view. Streamed, they lie in a scratch file, of which windows of
//! [`Config::buffer_rows`] rows are in memory, and 24 bytes for each block of 4,096 rows, twice.
//!
//! # Same seed, same weights
//!
//! All randomness comes from [`Config::seed`] through [`peelnet_core::random`], whose numbers a test
//! holds. Initial weights depend on the seed, the order of rows on the seed and the epoch. A resumed run continues from
//! the saved weights, moments and step count and ends with the same bits as a run that was never interrupted. Sums are
//! formed in the same order on every processor; exponentials, and what burn adds of whole pixels, differ in the last bits between machines.
//!
//! # The thesis's recipe
//!
//! 3-10-8-1 on (z, Σα, n), target T, mean squared error, Adam with rate 1e-4, 150 epochs of batches of 128, a third of
//! the rows held out. Two decisions are ours:
//!
//! - Hidden layers are ReLU, the output is linear. A ReLU output whose sum is negative for every row has no gradient
//!   and never recovers; the network then answers zero for ever. A linear output that leaves the range is cut
//!   to `[2⁻¹⁴, 1]` by the guard that evaluation and export share, so the network is a ReLU at the output in all but
//!   its gradient.
//! - The model is the *last* epoch's. Taking the epoch with the lowest error on held-out rows would be choosing by the
//!   test set. With [`Config::patience`] the held-out rows are used for choosing: the model is then the best epoch's and
//!   its error is recorded as validation, not as test.
//!
//! # Files
//!
//! For `out/net.safetensors` the folder `out/net.safetensors.checkpoint/` holds `state.safetensors` (everything a resumed run
//! needs), two model files, `last.safetensors` and `best.safetensors` (lowest held-out error so far), and the losses of every epoch,
//! `loss.csv`, all written again every five seconds. It stays after a finished run, so that a resumed run can add epochs; deleting it is safe. Every file is replaced as a whole. As long as a run
//! lasts, `out/net.safetensors.lock` is locked, so that a second run cannot write to the same files; see [`OutputLock`].

mod checkpoint;
mod config;
mod draws;
mod error;
mod examples;
mod loader;
mod lock;
mod loss;
mod network;
mod normalise;
mod optimizer;
mod report;
mod sampler;
mod scratch;
mod table;
mod training_loop;

pub use checkpoint::{
    FILES as CHECKPOINT_FILES, FINISHED as FINISHED_STATE, folder as checkpoint_folder,
};
pub use config::{Config, DEFAULT_BUFFER_ROWS, DEFAULT_MAX_ROWS, Schedule};
pub use error::TrainError;
pub use loader::held_out_errors;
pub use lock::OutputLock;
pub use peelnet_model::PixelLoss;
pub use report::{End, EpochReport, HISTORY_KIND, Outcome, history_csv};
pub use table::{
    ALPHA, COLOR, DataSplit, EXACT, KNOWN, LEFT, PixelColumns, RESIDUAL, SUM, TrainingData,
    UsedRows,
};
pub use training_loop::{RunOptions, train, train_watched};
