//! The state of a run on disk: bit for bit what a resumed run needs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use peelnet_core::files::{Kind, holds};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::config::{Config, MAX_EPOCHS, Schedule};
use crate::error::{TrainError, beside, io};
use crate::optimizer::Adam;
use crate::report::{EpochReport, HISTORY_KIND};

/// 2: the order of rows and the split come from another generator.
const VERSION: u32 = 2;
const KEY: &str = "peelnet_training_state";

/// The losses of every epoch.
pub(crate) const LOSSES: &str = "loss.csv";

/// The files of a checkpoint's folder, and by what they are known.
pub const FILES: [(&str, Kind); 4] = [
    (
        "state.safetensors",
        Kind {
            name: "the state of a training",
            is: |head| holds(head, KEY.as_bytes()),
        },
    ),
    ("best.safetensors", peelnet_model::KIND),
    ("last.safetensors", peelnet_model::KIND),
    (LOSSES, HISTORY_KIND),
];

/// What a training that begins anew replaces: not the hours of one that was interrupted.
pub const FINISHED: Kind = Kind {
    name: "the state of a finished training (an unfinished one can be resumed)",
    is: |head| (FILES[0].1.is)(head) && !is_unfinished(head),
};

/// Whether epochs were trained, and fewer than were asked for. What cannot be read cannot be resumed either.
fn is_unfinished(head: &[u8]) -> bool {
    let header = || -> Option<Header> {
        let (length, text) = head.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let text: serde_json::Value = serde_json::from_slice(text.get(..length)?).ok()?;
        serde_json::from_str(text["__metadata__"][KEY].as_str()?).ok()
    };
    header().is_some_and(|h| {
        let epochs = u32::try_from(h.epochs).unwrap_or(u32::MAX);
        epochs > 0 && h.config.end_after(epochs, h.best_epoch).is_none()
    })
}

/// `out/net.safetensors` → `out/net.safetensors.checkpoint`.
pub fn folder(out: &Path) -> PathBuf {
    beside(out, "checkpoint")
}

/// A run between two epochs.
#[derive(Clone)]
pub(crate) struct Progress {
    pub(crate) adam: Adam,
    /// Epoch and parameters with the lowest loss so far.
    pub(crate) best: Option<(u32, Vec<f32>)>,
    pub(crate) history: Vec<EpochReport>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    version: u32,
    config: Config,
    data: String,
    steps: u64,
    epochs: usize,
    best_epoch: Option<u32>,
}

/// Columns of the history tensor; losses as 64-bit floats, because text would round them.
const HISTORY: usize = 4;

/// What to do about a checkpoint that cannot be read.
const DAMAGED: &str = "delete the checkpoint folder, or start without it";

fn damaged(e: impl std::fmt::Display) -> String {
    format!("is not a whole checkpoint ({e}); {DAMAGED}")
}

impl Progress {
    pub(crate) fn save(
        &self,
        folder: &Path,
        config: &Config,
        data: &str,
    ) -> Result<(), TrainError> {
        let path = folder.join(FILES[0].0);
        let header = Header {
            version: VERSION,
            config: config.clone(),
            data: data.to_owned(),
            steps: self.adam.steps,
            epochs: self.history.len(),
            best_epoch: self.best.as_ref().map(|(epoch, _)| *epoch),
        };
        let mut tensors = vec![
            ("parameters", &self.adam.parameters),
            ("first_moment", &self.adam.first),
            ("second_moment", &self.adam.second),
        ];
        tensors.extend(self.best.iter().map(|(_, best)| ("best_parameters", best)));
        let mut tensors: Vec<_> = tensors
            .into_iter()
            .map(|(name, values)| {
                let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
                (name, Dtype::F32, vec![values.len()], bytes)
            })
            .collect();
        // A tensor without elements is legal, but a reader may dislike it: the history of no epoch is left out.
        if !self.history.is_empty() {
            let numbers = self.history.iter().flat_map(|row| {
                let held_out = row.held_out_loss.unwrap_or(f64::NAN);
                [row.train_loss, held_out, row.seconds, row.rows_per_s]
            });
            let shape = vec![self.history.len(), HISTORY];
            let bytes = numbers.flat_map(f64::to_le_bytes).collect();
            tensors.push(("history", Dtype::F64, shape, bytes));
        }
        let bytes = || -> Result<_, Box<dyn std::error::Error>> {
            let views = tensors.iter().map(|(name, dtype, shape, bytes)| {
                TensorView::new(*dtype, shape.clone(), bytes).map(|view| (*name, view))
            });
            let views = views.collect::<Result<Vec<_>, _>>()?;
            let header = serde_json::to_string(&header)?;
            let metadata = HashMap::from([(KEY.to_owned(), header)]);
            Ok(safetensors::serialize(views, Some(metadata))?)
        };
        let bytes = bytes().map_err(|e| TrainError::Checkpoint {
            path: path.clone(),
            problem: format!("cannot be written: {e}"),
        })?;
        peelnet_core::files::write_whole(&path, &bytes).map_err(io(&path))
    }

    /// Loads the state of a run with this configuration and these rows.
    ///
    /// `epochs` and `patience` may differ from the saved ones when the schedule does not depend on the number of epochs.
    pub(crate) fn load(
        folder: &Path,
        config: &Config,
        data: &str,
        parameters: usize,
    ) -> Result<Self, TrainError> {
        let path = folder.join(FILES[0].0);
        // No state has more bytes: four tensors of parameters, the history, and a header.
        let history = 8 * HISTORY as u64 * u64::from(MAX_EPOCHS);
        let most = 16 * parameters as u64 + history + (1 << 20);
        let read = match peelnet_core::files::read(&path, most) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                Err("there is no such file, so there is nothing to resume".to_owned())
            }
            read => Self::parse(&read.map_err(io(&path))?, config, data, parameters),
        };
        read.map_err(|problem| TrainError::Checkpoint { path, problem })
    }

    fn parse(bytes: &[u8], config: &Config, data: &str, parameters: usize) -> Result<Self, String> {
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(damaged)?;
        let header = metadata.metadata().as_ref().and_then(|m| m.get(KEY));
        let header = header.ok_or_else(|| damaged("no training state in it"))?;
        // The version first: a later version's header may have other fields.
        let version = serde_json::from_str::<serde_json::Value>(header)
            .ok()
            .and_then(|v| v.get("version").and_then(serde_json::Value::as_u64));
        if version != Some(VERSION.into()) {
            return Err(format!(
                "has version {}, this program reads {VERSION}; {DAMAGED}",
                version.map_or("none".to_owned(), |v| v.to_string())
            ));
        }
        let header: Header = serde_json::from_str(header).map_err(damaged)?;
        if let Some(setting) = difference(&header.config, config) {
            return Err(format!(
                "was made with another `{setting}`; repeat that setting, or start without the checkpoint"
            ));
        }
        if header.data != data {
            return Err(
                "was made with other rows; give the same dataset, or start without the checkpoint"
                    .to_owned(),
            );
        }
        let tensors = SafeTensors::deserialize(bytes).map_err(damaged)?;
        let tensor = |name: &str, dtype: Dtype, shape: &[usize]| {
            let tensor = tensors.tensor(name).map_err(damaged)?;
            if tensor.dtype() != dtype || tensor.shape() != shape {
                return Err(damaged(format!("`{name}` has shape {:?}", tensor.shape())));
            }
            Ok(tensor.data())
        };
        let floats = |name: &str| -> Result<Vec<f32>, String> {
            let (words, _) = tensor(name, Dtype::F32, &[parameters])?.as_chunks();
            let values = words.iter().map(|&word| f32::from_le_bytes(word));
            Ok(values.collect())
        };
        let mut history = Vec::new();
        if header.epochs > 0 {
            let data = tensor("history", Dtype::F64, &[header.epochs, HISTORY])?;
            let words = data.as_chunks().0.iter();
            let values: Vec<f64> = words.map(|&word| f64::from_le_bytes(word)).collect();
            let mut lowest = f64::INFINITY;
            for (epoch, row) in (1..).zip(values.chunks_exact(HISTORY)) {
                let mut report = EpochReport {
                    epoch,
                    epochs: config.epochs,
                    train_loss: row[0],
                    held_out_loss: (!row[1].is_nan()).then_some(row[1]),
                    seconds: row[2],
                    rows_per_s: row[3],
                    best: false,
                };
                report.best = report.score() < lowest;
                lowest = lowest.min(report.score());
                history.push(report);
            }
        }
        let best = match header.best_epoch {
            Some(epoch) if (1..=history.len()).contains(&(epoch as usize)) => {
                Some((epoch, floats("best_parameters")?))
            }
            Some(epoch) => return Err(damaged(format!("best epoch {epoch} was not run"))),
            None => None,
        };
        Ok(Self {
            adam: Adam {
                parameters: floats("parameters")?,
                first: floats("first_moment")?,
                second: floats("second_moment")?,
                steps: header.steps,
            },
            best,
            history,
        })
    }
}

/// The first setting that differs and may not.
fn difference(saved: &Config, asked: &Config) -> Option<String> {
    let mut saved = saved.clone();
    saved.patience = asked.patience;
    if asked.schedule == Schedule::Constant {
        saved.epochs = asked.epochs;
    }
    let (a, b) = (
        serde_json::to_value(&saved).ok()?,
        serde_json::to_value(asked).ok()?,
    );
    // Defaults are left out.
    let mut settings = a.as_object()?.keys().chain(b.as_object()?.keys());
    settings.find(|key| a.get(key) != b.get(key)).cloned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Also of those that are stored only where they are given.
    #[test]
    fn the_setting_that_differs_is_named() {
        let plain = Config::for_recipe(peelnet_model::Recipe::SMALL);
        let streamed = Config {
            buffer_rows: Some(9),
            ..plain.clone()
        };
        for (saved, asked) in [(&plain, &streamed), (&streamed, &plain)] {
            assert_eq!(difference(saved, asked).as_deref(), Some("buffer_rows"));
        }
        assert_eq!(difference(&plain, &plain), None);
    }
}
