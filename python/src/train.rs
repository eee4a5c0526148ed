use crate::{
    argument::load_all,
    failure::{raised, wrong},
    model::{Model, NO_INPUTS},
    rows::Dataset,
    watch::{Bar, Reporter, watch},
};
use peelnet::{
    Recipe, SCHEDULES, SPLITS,
    fit::{ModelPlace, Step, fit},
    named,
    train::{Config, DEFAULT_BUFFER_ROWS, EpochReport, PixelLoss, RunOptions},
};
use peelnet_core::files::Outputs;
use pyo3::prelude::*;
use std::{num::NonZeroUsize, path::PathBuf};

/// One finished epoch of a training.
#[pyclass(frozen, module = "peelnet", get_all)]
#[derive(Clone)]
pub struct Epoch {
    /// From 1.
    pub epoch: u32,
    /// How many there will be.
    pub epochs: u32,
    /// Mean loss of the training examples.
    pub train_loss: f64,
    /// Mean loss of the held-out examples; None where nothing is held out.
    pub held_out_loss: Option<f64>,
    /// Clock time of the epoch's training, seconds.
    pub seconds: f64,
    /// Training examples per second.
    pub rows_per_s: f64,
    /// Whether the held-out loss is the lowest so far.
    pub best: bool,
}

#[pymethods]
impl Epoch {
    fn __repr__(&self) -> String {
        format!(
            "Epoch({} of {}, train_loss={:.6})",
            self.epoch, self.epochs, self.train_loss
        )
    }
}

impl From<&EpochReport> for Epoch {
    fn from(e: &EpochReport) -> Self {
        Self {
            epoch: e.epoch,
            epochs: e.epochs,
            train_loss: e.train_loss,
            held_out_loss: e.held_out_loss,
            seconds: e.seconds,
            rows_per_s: e.rows_per_s,
            best: e.best,
        }
    }
}

/// What a training came to.
#[pyclass(frozen, module = "peelnet", get_all)]
pub struct Training {
    /// The trained Model.
    model: Py<Model>,
    /// An Epoch for each epoch, those before a resume included.
    history: Vec<Epoch>,
    /// "finished" or "stopped-early".
    end: &'static str,
    /// The epoch whose weights the model has.
    model_epoch: u32,
    /// The epoch that a checkpoint was continued from, or None.
    resumed_from: Option<u32>,
}

#[pymethods]
impl Training {
    fn __repr__(&self) -> String {
        format!("Training({}, {} epochs)", self.end, self.history.len())
    }
}

/// Trains a network on datasets.
///
/// Args:
///     data: A Dataset or its folder, or a list of them. Rows of scenes that are marked held-out are never trained on.
///     recipe: "thesis", "small", "medium", "large", "anchored-small", "anchored-medium", "nmt" or "dfaoit".
///     out: The model file to write; its checkpoint is the folder `out + ".checkpoint"`, and nothing for an `s3://…`. Without `out`
///         nothing is kept.
///     epochs: Passes over the training rows.
///     batch: Fragments per step (pixels, for recipes that learn from whole pixels).
///     lr: Learning rate.
///     schedule: "constant" or "one-cycle".
///     hidden: Widths of the hidden layers.
///     patience: Stop after this many epochs without a lower held-out loss, and keep the best.
///     loss: "image", "contributions", "weighted-transmittance" or "transmittance", of recipes that learn from whole pixels; None: the recipe's.
///     seed: Of initial weights, order and split. The same seed gives the same weights.
///     max_rows: Rows that are used at most; of more, whole pixels are drawn from the seed.
///     stream: Use all rows, read again from a scratch file beside `out` in every epoch, for datasets larger than memory.
///     buffer_rows: Rows in memory at most, with `stream`.
///     split: "scene" or "pixel": what stays together when rows are set aside for testing.
///     threads: Threads to use, all cores by default. The result does not depend on it.
///     resume: Continue from the checkpoint of `out`.
///     loss_curve: Files for the loss of every epoch, .csv or .svg.
///     callback: Called with an Epoch after every epoch, while the training waits. An exception ends the training and is raised.
///     progress: A progress bar of the tqdm protocol, or True for tqdm's own; it counts epochs.
///     force: Lets `out` replace any file.
///
/// What is None is as the recipe says.
///
/// Returns:
///     A Training: the model and the history. After Ctrl-C or an exception of the callback the checkpoint of `out` holds
///     the last whole epoch, and no model file was written.
#[pyfunction]
#[pyo3(signature = (data, *, recipe="medium", out=None, epochs=None, batch=None, lr=None, schedule=None, hidden=None, patience=None, loss=None, seed=1, max_rows=None, stream=false, buffer_rows=None, split="scene", threads=None, resume=false, loss_curve=None, callback=None, progress=None, force=false))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn train<'py>(
    py: Python<'py>,
    data: &Bound<'py, PyAny>,
    recipe: &str,
    out: Option<PathBuf>,
    epochs: Option<u32>,
    batch: Option<usize>,
    lr: Option<f64>,
    schedule: Option<&str>,
    hidden: Option<Vec<usize>>,
    patience: Option<u32>,
    loss: Option<&str>,
    seed: u64,
    max_rows: Option<u64>,
    stream: bool,
    buffer_rows: Option<u64>,
    split: &str,
    threads: Option<NonZeroUsize>,
    resume: bool,
    loss_curve: Option<Vec<PathBuf>>,
    callback: Option<Bound<'py, PyAny>>,
    progress: Option<Bound<'py, PyAny>>,
    force: bool,
) -> PyResult<Training> {
    let recipe: Recipe = recipe.parse().map_err(|e: String| wrong(e))?;
    let defaults = Config::for_recipe(recipe);
    let schedule = schedule.map(|name| named("schedule", SCHEDULES, name));
    let config = Config {
        seed,
        epochs: epochs.unwrap_or(defaults.epochs),
        batch: batch.unwrap_or(defaults.batch),
        learning_rate: lr.unwrap_or(defaults.learning_rate),
        schedule: schedule
            .transpose()
            .map_err(wrong)?
            .unwrap_or(defaults.schedule),
        hidden: hidden.unwrap_or(defaults.hidden),
        patience: patience.or(defaults.patience),
        max_rows: max_rows.unwrap_or(defaults.max_rows),
        buffer_rows: stream.then(|| buffer_rows.unwrap_or(DEFAULT_BUFFER_ROWS)),
        split: named("split", SPLITS, split).map_err(wrong)?,
        ..defaults
    };
    let loss = loss.map(str::parse::<PixelLoss>).transpose();
    let config = config.minimising(loss.map_err(|e: String| wrong(e))?);
    config.check().map_err(raised)?;
    let loss_curve = loss_curve.unwrap_or_default();
    let mut outputs = Outputs::new(("force=True", force), NO_INPUTS);
    let names = ["out", "loss_curve", "resume"];
    let place = ModelPlace::new(out.as_deref(), resume, &loss_curve, &mut outputs, names);
    let place = place.map_err(raised)?;
    let datasets = load_all::<Dataset>(data)?.into_iter();
    let datasets: Vec<_> = datasets.map(|d| d.dataset).collect();
    let mut bar = Bar::new(progress)?;
    let result = watch(
        py,
        |stop, reporter: &Reporter<EpochReport>| {
            let mut options = RunOptions::new(place.file(), stop);
            options.resume = resume;
            options.threads = threads;
            fit(&config, &datasets, &options, &loss_curve, &mut |step| {
                if let Step::Epoch(epoch) = step {
                    reporter.ask(epoch.clone());
                }
            })
        },
        |py, epoch| {
            let text = epoch.progress();
            bar.set(epoch.epoch.into(), epoch.epochs.into(), &text)?;
            match &callback {
                Some(callback) => {
                    let epoch = Bound::new(py, Epoch::from(&epoch))?;
                    callback.call1((epoch,)).map(|_| ())
                }
                None => Ok(()),
            }
        },
    );
    let outcome = bar.close(result)?;
    place.deliver(&outcome.model).map_err(raised)?;
    Ok(Training {
        model: Py::new(py, Model(outcome.model))?,
        history: outcome.history.iter().map(Epoch::from).collect(),
        end: outcome.end.name(),
        model_epoch: outcome.model_epoch,
        resumed_from: outcome.resumed_from,
    })
}
