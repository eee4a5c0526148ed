//! Training, with a callback each epoch.

use crate::{
    failure::{failed, raised, wrong},
    model::{Model, may_write},
    rows::DatasetArg,
    watch::{Bar, Reporter, watch},
};
use peelnet::{
    Recipe,
    dataset::{Dataset, SplitBy, is_remote},
    train::{
        CHECKPOINT_FILES, Config, CurveFormat, DEFAULT_BUFFER_ROWS, End, EpochReport, Outcome,
        OutputLock, RunOptions, Schedule, Source, StreamedData, TrainingData, checkpoint_folder,
        held_out_errors,
    },
};
use peelnet_files::{error_line, shown, thousands};
use pyo3::{exceptions::PyTypeError, prelude::*};
use std::{
    num::NonZeroUsize,
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
};
use tempfile::TempDir;

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

/// One dataset, or several.
pub struct DatasetArgs(Vec<DatasetArg>);

impl<'a, 'py> FromPyObject<'a, 'py> for DatasetArgs {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let one = object.extract::<DatasetArg>();
        if object.is_instance_of::<crate::rows::Rows>() {
            return one.map(|one| Self(vec![one]));
        }
        if let Ok(one) = one {
            return Ok(Self(vec![one]));
        }
        object
            .try_iter()
            .map_err(|_| PyTypeError::new_err("data is a Dataset, a folder, or a list of them"))?
            .map(|item| item?.extract())
            .collect::<PyResult<_>>()
            .map(Self)
    }
}

struct Run<'a> {
    config: &'a Config,
    datasets: Vec<DatasetArg>,
    out: PathBuf,
    resume: bool,
    loss_curve: Vec<PathBuf>,
    threads: Option<NonZeroUsize>,
}

fn fit(run: Run<'_>, stop: &AtomicBool, reporter: &Reporter<Epoch>) -> PyResult<Outcome> {
    let datasets: Vec<Dataset> = run
        .datasets
        .into_iter()
        .map(DatasetArg::open)
        .collect::<PyResult<_>>()?;
    let lock = OutputLock::take(&run.out).map_err(raised)?;
    let (held, streamed);
    let source: Source<'_> = if run.config.buffer_rows.is_some() {
        let folder = checkpoint_folder(&run.out);
        streamed = StreamedData::from_datasets(run.config, &datasets, &folder, stop, |_, _| ())
            .map_err(raised)?;
        (&streamed).into()
    } else {
        held = TrainingData::from_datasets(run.config, &datasets).map_err(raised)?;
        (&held).into()
    };
    let mut options = RunOptions::new(&run.out, stop);
    options.resume = run.resume;
    options.loss_curve = run.loss_curve;
    options.threads = run.threads;
    options.lock = Some(&lock);
    let ask = |e: &EpochReport| reporter.ask(e.into());
    let mut outcome = peelnet::train::train(run.config, source, &options, ask).map_err(raised)?;
    if outcome.end != End::Interrupted && !stop.load(Ordering::Relaxed) {
        let held_out = held_out_errors(&outcome.model, &datasets).map_err(raised)?;
        if !held_out.is_empty() {
            outcome.model.meta.held_out = held_out;
            outcome.model.save(&options.out).map_err(raised)?;
        }
    }
    Ok(outcome)
}

/// Writes a model to an object store. Where that fails, the folder it was made in stays: hours of training are not lost with a connection.
fn send(model: &peelnet::Model, place: &Path, made_in: Option<TempDir>) -> PyResult<()> {
    peelnet::save_model(model, place).map_err(|e| match made_in {
        Some(folder) => failed(format!(
            "{}; the model is kept: {}",
            error_line(&e),
            shown(&folder.keep().join("model.safetensors"))
        )),
        None => raised(e),
    })
}

fn schedule_of(name: &str) -> PyResult<Schedule> {
    match name {
        "constant" => Ok(Schedule::Constant),
        "one-cycle" => Ok(Schedule::ONE_CYCLE),
        other => Err(wrong(format!(
            "schedule '{other}': there are constant, one-cycle"
        ))),
    }
}

/// Trains a network on datasets.
///
/// Args:
///     data: A Dataset or its folder, or a list of them. Rows of scenes that are marked held-out are never trained on.
///     recipe: "thesis", "small", "medium", "large", "nmt" or "dfaoit".
///     out: The model file to write; its checkpoint is the folder `out + ".checkpoint"`, and nothing for an `s3://…`. Without `out`
///         nothing is kept.
///     epochs: Passes over the training rows.
///     batch: Fragments per step (pixels, for recipes that learn from whole pixels).
///     lr: Learning rate.
///     schedule: "constant" or "one-cycle".
///     hidden: Widths of the hidden layers.
///     patience: Stop after this many epochs without a lower held-out loss, and keep the best.
///     loss: "image", "contributions", "weighted-transmittance" or "transmittance", of small, medium and large.
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
#[pyo3(signature = (data, *, recipe="thesis", out=None, epochs=None, batch=None, lr=None, schedule=None, hidden=None, patience=None, loss="image", seed=1, max_rows=None, stream=false, buffer_rows=None, split="scene", threads=None, resume=false, loss_curve=None, callback=None, progress=None, force=false))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn train<'py>(
    py: Python<'py>,
    data: DatasetArgs,
    recipe: &str,
    out: Option<PathBuf>,
    epochs: Option<u32>,
    batch: Option<usize>,
    lr: Option<f64>,
    schedule: Option<&str>,
    hidden: Option<Vec<usize>>,
    patience: Option<u32>,
    loss: &str,
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
    let mut config = Config::for_recipe(recipe);
    config.seed = seed;
    config.epochs = epochs.unwrap_or(config.epochs);
    config.batch = batch.unwrap_or(config.batch);
    config.learning_rate = lr.unwrap_or(config.learning_rate);
    config.schedule = schedule.map_or(Ok(config.schedule), schedule_of)?;
    config.hidden = hidden.unwrap_or(config.hidden);
    config.patience = patience.or(config.patience);
    config.loss = loss.parse().map_err(|e: String| wrong(e))?;
    config.max_rows = max_rows.unwrap_or(config.max_rows);
    config.buffer_rows = stream.then(|| buffer_rows.unwrap_or(DEFAULT_BUFFER_ROWS));
    config.split = match split {
        "scene" => SplitBy::Scene,
        "pixel" => SplitBy::Pixel,
        other => return Err(wrong(format!("split '{other}': there are scene, pixel"))),
    };
    config.check().map_err(raised)?;
    let (out, stored): (Option<PathBuf>, _) = match out {
        Some(out) if is_remote(&out) => (None, Some(out)),
        out => (out, None),
    };
    if let Some(stored) = &stored {
        peelnet::check_model_place(stored).map_err(raised)?;
    }
    let scratch = match &out {
        Some(out) => {
            may_write(out, peelnet::model::KIND, force)?;
            for (name, kind) in CHECKPOINT_FILES {
                may_write(&checkpoint_folder(out).join(name), kind, force)?;
            }
            None
        }
        None if resume => {
            return Err(wrong(
                "resume needs out, a file beside which the checkpoint lies",
            ));
        }
        None => Some(
            tempfile::tempdir()
                .map_err(|e| failed(format!("cannot create a temporary folder: {e}")))?,
        ),
    };
    let loss_curve = loss_curve.unwrap_or_default();
    for path in &loss_curve {
        may_write(path, CurveFormat::of(path).map_err(raised)?.kind(), force)?;
    }
    let path = match (&scratch, &out) {
        (Some(folder), _) => folder.path().join("model.safetensors"),
        (None, out) => out.clone().unwrap_or_default(),
    };
    let run = Run {
        config: &config,
        datasets: data.0,
        out: path,
        resume,
        loss_curve,
        threads,
    };
    let mut bar = Bar::new(progress)?;
    let result = watch(
        py,
        |stop, reporter| fit(run, stop, reporter),
        |py, epoch: Epoch| {
            let rate = thousands(epoch.rows_per_s as u64);
            let held_out = epoch.held_out_loss;
            let held_out = held_out.map_or_else(String::new, |l| format!(", held out {l:.6}"));
            let text = format!("loss {:.6}{held_out}, {rate} rows/s", epoch.train_loss);
            bar.set(epoch.epoch.into(), epoch.epochs.into(), &text)?;
            match &callback {
                Some(callback) => callback.call1((Bound::new(py, epoch)?,)).map(|_| ()),
                None => Ok(()),
            }
        },
    )
    .and_then(|result| result);
    let outcome = bar.close(result)?;
    if let Some(place) = &stored {
        send(&outcome.model, place, scratch)?;
    }
    Ok(Training {
        model: Py::new(py, Model(outcome.model))?,
        history: outcome.history.iter().map(Epoch::from).collect(),
        end: match outcome.end {
            End::Finished => "finished",
            End::StoppedEarly => "stopped-early",
            End::Interrupted => "interrupted",
        },
        model_epoch: outcome.model_epoch,
        resumed_from: outcome.resumed_from,
    })
}
