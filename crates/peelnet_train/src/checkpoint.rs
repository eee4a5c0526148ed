//! The state of a run on disk: bit for bit what a resumed run needs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use peelnet_files::Kind;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::config::{Config, MAX_EPOCHS, Schedule};
use crate::error::TrainError;
use crate::files;
use crate::report::EpochReport;

/// 2: the order of rows and the split come from another generator.
const VERSION: u32 = 2;
const KEY: &str = "peelnet_training_state";

/// The files of a checkpoint's folder, and by what they are known.
pub const FILES: [(&str, Kind); 3] = [
    (
        "state.safetensors",
        Kind {
            name: "the state of a training",
            is: |head| head.windows(KEY.len()).any(|w| w == KEY.as_bytes()),
        },
    ),
    ("best.safetensors", peelnet_model::KIND),
    ("last.safetensors", peelnet_model::KIND),
];

/// `out/net.safetensors` → `out/net.safetensors.checkpoint`.
pub fn folder(out: &Path) -> PathBuf {
    files::beside(out, "checkpoint")
}

/// The file of a folder that holds the state.
pub(crate) fn state_file(folder: &Path) -> PathBuf {
    folder.join("state.safetensors")
}

/// A run between two epochs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) parameters: Vec<f32>,
    pub(crate) first: Vec<f32>,
    pub(crate) second: Vec<f32>,
    pub(crate) steps: u64,
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

/// No state of a network with so many parameters has more bytes: four tensors of them, the history, and a header.
const fn most_bytes(parameters: usize) -> u64 {
    16 * parameters as u64 + 8 * HISTORY as u64 * MAX_EPOCHS as u64 + (1 << 20)
}

impl State {
    pub(crate) fn save(
        &self,
        folder: &Path,
        config: &Config,
        data: &str,
    ) -> Result<(), TrainError> {
        let path = state_file(folder);
        let header = Header {
            version: VERSION,
            config: config.clone(),
            data: data.to_owned(),
            steps: self.steps,
            epochs: self.history.len(),
            best_epoch: self.best.as_ref().map(|(epoch, _)| *epoch),
        };
        let f32_bytes =
            |values: &[f32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
        let history: Vec<u8> = self
            .history
            .iter()
            .flat_map(|row| {
                [
                    row.train_loss,
                    row.held_out_loss.unwrap_or(f64::NAN),
                    row.seconds,
                    row.rows_per_s,
                ]
            })
            .flat_map(f64::to_le_bytes)
            .collect();
        let mut tensors = vec![
            (
                "parameters",
                Dtype::F32,
                vec![self.parameters.len()],
                f32_bytes(&self.parameters),
            ),
            (
                "first_moment",
                Dtype::F32,
                vec![self.first.len()],
                f32_bytes(&self.first),
            ),
            (
                "second_moment",
                Dtype::F32,
                vec![self.second.len()],
                f32_bytes(&self.second),
            ),
        ];
        // A tensor without elements is legal, but a reader may dislike it: the history of no epoch is left out.
        if !self.history.is_empty() {
            tensors.push((
                "history",
                Dtype::F64,
                vec![self.history.len(), HISTORY],
                history,
            ));
        }
        if let Some((_, best)) = &self.best {
            tensors.push((
                "best_parameters",
                Dtype::F32,
                vec![best.len()],
                f32_bytes(best),
            ));
        }
        let problem = |e: &dyn std::fmt::Display| TrainError::Checkpoint {
            path: path.clone(),
            problem: format!("cannot be written: {e}"),
        };
        let views = tensors
            .iter()
            .map(|(name, dtype, shape, bytes)| {
                TensorView::new(*dtype, shape.clone(), bytes).map(|view| (*name, view))
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| problem(&e))?;
        let header = serde_json::to_string(&header).map_err(|e| problem(&e))?;
        let bytes = safetensors::serialize(views, Some(HashMap::from([(KEY.to_owned(), header)])))
            .map_err(|e| problem(&e))?;
        files::write(&path, &bytes)
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
        let path = state_file(folder);
        let bytes = match peelnet_files::read(&path, most_bytes(parameters)) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                let problem = "there is no such file, so there is nothing to resume".to_owned();
                return Err(TrainError::Checkpoint { path, problem });
            }
            Err(error) => return Err(TrainError::Io { path, error }),
        };
        Self::parse(&bytes, config, data, parameters)
            .map_err(|problem| TrainError::Checkpoint { path, problem })
    }

    fn parse(bytes: &[u8], config: &Config, data: &str, parameters: usize) -> Result<Self, String> {
        const DAMAGED: &str = "delete the checkpoint folder, or start without it";
        let damaged =
            |e: &dyn std::fmt::Display| format!("is not a whole checkpoint ({e}); {DAMAGED}");
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(|e| damaged(&e))?;
        let header = metadata
            .metadata()
            .as_ref()
            .and_then(|m| m.get(KEY))
            .ok_or_else(|| damaged(&"no training state in it"))?;
        // The version first: a later version's header may have other fields.
        let version = serde_json::from_str::<serde_json::Value>(header)
            .ok()
            .and_then(|v| v.get("version").and_then(serde_json::Value::as_u64));
        if version != Some(u64::from(VERSION)) {
            return Err(format!(
                "has version {}, this program reads {VERSION}; {DAMAGED}",
                version.map_or("none".to_owned(), |v| v.to_string())
            ));
        }
        let header: Header = serde_json::from_str(header).map_err(|e| damaged(&e))?;
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
        let tensors = SafeTensors::deserialize(bytes).map_err(|e| damaged(&e))?;
        let floats = |name: &str| -> Result<Vec<f32>, String> {
            let tensor = tensors.tensor(name).map_err(|e| damaged(&e))?;
            if tensor.dtype() != Dtype::F32 || tensor.shape() != [parameters] {
                return Err(damaged(&format!("`{name}` has shape {:?}", tensor.shape())));
            }
            Ok(tensor
                .data()
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect())
        };
        let mut history = Vec::new();
        if header.epochs > 0 {
            let tensor = tensors.tensor("history").map_err(|e| damaged(&e))?;
            if tensor.dtype() != Dtype::F64 || tensor.shape() != [header.epochs, HISTORY] {
                return Err(damaged(&format!(
                    "`history` has shape {:?}",
                    tensor.shape()
                )));
            }
            let values: Vec<f64> = tensor
                .data()
                .as_chunks::<8>()
                .0
                .iter()
                .map(|b| f64::from_le_bytes(*b))
                .collect();
            let mut lowest = f64::INFINITY;
            for (i, row) in values.chunks_exact(HISTORY).enumerate() {
                let held_out_loss = (!row[1].is_nan()).then_some(row[1]);
                let score = held_out_loss.unwrap_or(row[0]);
                history.push(EpochReport {
                    epoch: i as u32 + 1,
                    epochs: config.epochs,
                    train_loss: row[0],
                    held_out_loss,
                    seconds: row[2],
                    rows_per_s: row[3],
                    best: score < lowest,
                });
                lowest = lowest.min(score);
            }
        }
        let best = match header.best_epoch {
            Some(epoch) if (1..=history.len()).contains(&(epoch as usize)) => {
                Some((epoch, floats("best_parameters")?))
            }
            Some(epoch) => return Err(damaged(&format!("best epoch {epoch} was not run"))),
            None => None,
        };
        Ok(Self {
            parameters: floats("parameters")?,
            first: floats("first_moment")?,
            second: floats("second_moment")?,
            steps: header.steps,
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
    if saved == *asked {
        return None;
    }
    let (a, b) = (
        serde_json::to_value(&saved).ok()?,
        serde_json::to_value(asked).ok()?,
    );
    let name = a
        .as_object()?
        .iter()
        .find(|(key, value)| b.get(key.as_str()) != Some(value))
        .map_or("config", |(key, _)| key.as_str());
    Some(name.to_owned())
}
