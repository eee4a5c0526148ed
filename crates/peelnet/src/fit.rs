//! Training as the command line and Python do it: datasets into a model at a path or an address, with the errors on held-out scenes.

use crate::{
    Failure, check_model_place,
    loss_curve::{curve_kind, write_curve},
    save_model,
};
use peelnet_core::files::{Outputs, STDOUT, Unfinished, is_remote, shown};
use peelnet_dataset::Dataset;
use peelnet_model::Model;
use peelnet_train::{
    CHECKPOINT_FILES, Config, End, EpochReport, FINISHED_STATE, Outcome, OutputLock, RunOptions,
    TrainingData, checkpoint_folder, held_out_errors, train,
};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// What a training reports.
#[derive(Debug)]
pub enum Step<'a> {
    /// Rows that were written to the scratch file of a streamed training, and of how many.
    Read(u64, u64),
    /// The examples are there.
    Ready(&'a TrainingData),
    /// An epoch ended.
    Epoch(&'a EpochReport),
}

/// Trains on datasets and writes the loss curves, also of a run that diverges, but not of one that is interrupted; the model file has the errors on held-out scenes in it where the datasets hold such.
///
/// # Errors
/// As [`train`], and a dataset that cannot be read.
pub fn fit(
    config: &Config,
    datasets: &[Dataset],
    options: &RunOptions<'_>,
    loss_curves: &[PathBuf],
    on: &mut dyn FnMut(Step<'_>),
) -> Result<Outcome, Failure> {
    // Until the model has all of its metadata; before the rows are read, because that can take minutes.
    let own = match options.lock {
        Some(_) => None,
        None => Some(OutputLock::take(&options.out)?),
    };
    let options = &RunOptions {
        lock: options.lock.or(own.as_ref()),
        ..options.clone()
    };
    let data = if config.buffer_rows.is_some() {
        let folder = checkpoint_folder(&options.out);
        TrainingData::streamed(config, datasets, &folder, options.stop, |n, of| {
            on(Step::Read(n, of));
        })?
    } else {
        TrainingData::from_datasets(config, datasets)?
    };
    on(Step::Ready(&data));
    let mut history: Vec<EpochReport> = Vec::new();
    let trained = train(config, &data, options, |all| {
        history.extend_from_slice(&all[history.len()..]);
        all.last().into_iter().for_each(|e| on(Step::Epoch(e)));
    });
    let mut outcome = match trained {
        Ok(outcome) => outcome,
        Err(error) => {
            // What went wrong is what the user must hear of. Without an epoch the curves of an older model stay.
            for path in loss_curves.iter().filter(|_| !history.is_empty()) {
                let _ = write_curve(path, &history);
            }
            return Err(error.into());
        }
    };
    if outcome.end == End::Interrupted {
        // The checkpoint has the history. An older model stays, and so do the curves beside it.
        return Ok(outcome);
    }
    for path in loss_curves {
        write_curve(path, &outcome.history)?;
    }
    let held_out = held_out_errors(&outcome.model, datasets)?;
    if !held_out.is_empty() {
        outcome.model.meta.held_out = held_out;
        outcome.model.save(&options.out)?;
    }
    Ok(outcome)
}

/// Where a trained model goes. Beside a file lies the training's state; stdout, an address or nothing at all get the model at the end, and
/// until then it is in a temporary folder.
#[derive(Debug)]
pub struct ModelPlace {
    out: Option<PathBuf>,
    scratch: Option<(TempDir, Unfinished)>,
}

impl ModelPlace {
    /// Checks where the model and the loss curves go.
    ///
    /// # Errors
    /// An output that may not be written, or nothing to resume from.
    pub fn new(
        out: Option<&Path>,
        resume: bool,
        loss_curves: &[PathBuf],
        outputs: &mut Outputs,
        label: [&str; 3],
    ) -> Result<Self, Failure> {
        let [out_label, curve_label, resume_label] = label;
        let mut is_file = false;
        if let Some(path) = out {
            if is_remote(path) {
                check_model_place(path)?;
            } else {
                outputs.file(out_label, path, peelnet_model::KIND)?;
                is_file = path != Path::new(STDOUT);
            }
            if is_file {
                let mut files = CHECKPOINT_FILES;
                if !resume {
                    files[0].1 = FINISHED_STATE;
                }
                outputs.folder(out_label, &checkpoint_folder(path), files)?;
            }
        }
        if resume && !is_file {
            return Err(Failure::wrong(format!(
                "{resume_label} needs {out_label} to be a file, beside which the training's state lies"
            )));
        }
        for path in loss_curves {
            outputs.file(curve_label, path, curve_kind(path)?)?;
        }
        let scratch = if is_file {
            None
        } else {
            let folder = tempfile::tempdir()
                .map_err(|e| Failure::failed(format!("cannot create a temporary folder: {e}")))?;
            let unfinished = Unfinished::new(folder.path());
            Some((folder, unfinished))
        };
        let out = out.map(Path::to_owned);
        Ok(Self { out, scratch })
    }

    /// The file that is trained into.
    pub fn file(&self) -> PathBuf {
        match &self.scratch {
            Some((folder, _)) => folder.path().join("model.safetensors"),
            None => self.out.clone().unwrap_or_default(),
        }
    }

    /// Whether the training's state stays beside it.
    pub fn is_kept(&self) -> bool {
        self.scratch.is_none()
    }

    /// Hands the finished model over.
    ///
    /// # Errors
    /// A place that cannot be written; then the temporary folder stays: hours of training are not lost with a connection.
    pub fn deliver(self, model: &Model) -> Result<(), Failure> {
        let (Some(out), Some((folder, _))) = (self.out, self.scratch) else {
            return Ok(());
        };
        save_model(model, out).map_err(|error| {
            let kept = folder.keep().join("model.safetensors");
            let mut failure = Failure::from(error);
            failure.text += &format!("; the model is kept: {}", shown(&kept));
            failure
        })
    }
}
