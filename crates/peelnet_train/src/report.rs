//! What a run reports: every epoch, and at the end.

use std::path::PathBuf;

use peelnet_model::Model;

/// One finished epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochReport {
    /// From 1.
    pub epoch: u32,
    /// How many there will be.
    pub epochs: u32,
    /// Mean loss of the training examples, each measured before the step that learnt from it.
    pub train_loss: f64,
    /// Mean loss of the held-out examples after the epoch; none when nothing is held out.
    pub held_out_loss: Option<f64>,
    /// Wall-clock time of the training part of the epoch.
    pub seconds: f64,
    /// Training examples per second.
    pub rows_per_s: f64,
    /// Whether the held-out loss is the lowest so far.
    pub best: bool,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All epochs were run.
    Finished,
    /// The held-out loss did not fall for [`Config::patience`](crate::Config::patience) epochs.
    StoppedEarly,
    /// It was asked to stop. The checkpoint holds the last whole epoch; the model file was not written.
    Interrupted,
}

/// A run that ended without an error.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The trained network; for an interrupted run that of the last whole epoch.
    pub model: Model,
    /// All epochs, those before a resume included.
    pub history: Vec<EpochReport>,
    /// Why it ended.
    pub end: End,
    /// The epoch whose weights the model has; 0 is the initial network.
    pub model_epoch: u32,
    /// The epoch that a checkpoint was continued from.
    pub resumed_from: Option<u32>,
    /// The checkpoint folder.
    pub checkpoint: PathBuf,
}
