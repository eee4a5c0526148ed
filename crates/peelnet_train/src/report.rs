//! What a run reports: every epoch, and at the end.

use std::path::PathBuf;

use peelnet_core::files::{Kind, thousands};
use peelnet_model::Model;

const HEADINGS: &str = "epoch,train_loss,held_out_loss,seconds,rows_per_s";

/// By what the table of [`history_csv`] is known.
pub const HISTORY_KIND: Kind = Kind {
    name: "a loss curve (CSV)",
    is: |head| head.starts_with(HEADINGS.as_bytes()),
};

/// The epochs as a table, as CSV: a line for each.
pub fn history_csv(history: &[EpochReport]) -> String {
    let mut table = format!("{HEADINGS}\n");
    for row in history {
        let held_out = row.held_out_loss.map_or(String::new(), |l| l.to_string());
        table += &format!(
            "{},{},{held_out},{:.4},{:.0}\n",
            row.epoch, row.train_loss, row.seconds, row.rows_per_s
        );
    }
    table
}

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

impl EpochReport {
    /// What epochs are compared by.
    pub(crate) fn score(&self) -> f64 {
        self.held_out_loss.unwrap_or(self.train_loss)
    }

    /// What a progress bar says of the epoch.
    pub fn progress(&self) -> String {
        let held_out = self
            .held_out_loss
            .map_or_else(String::new, |loss| format!(", held out {loss:.3e}"));
        let rate = thousands(self.rows_per_s as u64);
        format!("loss {:.3e}{held_out}, {rate} rows/s", self.train_loss)
    }
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

impl End {
    /// Its name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::StoppedEarly => "stopped-early",
            Self::Interrupted => "interrupted",
        }
    }
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
