//! The loop over epochs and batches.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use burn::tensor::{Device, Tensor, TensorData};
use peelnet_model::{DatasetRef, Input, Losses, Metadata, Model};

use crate::adam::Adam;
use crate::checkpoint::{self, State};
use crate::config::{Config, DEFAULT_BUFFER_ROWS};
use crate::curve::{CurveFormat, write_curve};
use crate::device::Compute;
use crate::error::TrainError;
use crate::feed::{Examples, Feed, Windows};
use crate::lock::OutputLock;
use crate::network::Shape;
use crate::normalise::Normalisation;
use crate::report::{End, EpochReport, Outcome};
use crate::split::Split;
use crate::streamed::Source;
use crate::task::{Part, Task};
use crate::team::Team;

/// What a run needs besides its configuration and data, without an effect on the weights.
#[derive(Clone, Debug)]
pub struct RunOptions<'a> {
    /// The model file to write. The checkpoint folder lies beside it.
    pub out: PathBuf,
    /// Continue from the checkpoint folder, which must be there.
    pub resume: bool,
    /// Loss curves to write, by ending .csv or .svg.
    pub loss_curve: Vec<PathBuf>,
    /// Set it from anywhere to end the run: the last whole epoch is saved.
    pub stop: &'a AtomicBool,
    /// Threads to use, all cores when none. The result does not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Where to compute.
    pub compute: Compute,
    /// The lock of [`RunOptions::out`], where the caller holds it longer than the run. Without it the run takes it.
    pub lock: Option<&'a OutputLock>,
}

impl<'a> RunOptions<'a> {
    /// A fresh run on all cores without a loss curve.
    pub fn new(out: impl Into<PathBuf>, stop: &'a AtomicBool) -> Self {
        Self {
            out: out.into(),
            resume: false,
            loss_curve: Vec::new(),
            stop,
            threads: None,
            compute: Compute::default(),
            lock: None,
        }
    }
}

/// A checkpoint is a few kilobytes, but an epoch of a small dataset takes a millisecond.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// Trains a network, writes the model file, the checkpoint folder and the loss curves, and returns the model.
///
/// `on_epoch` is called after every epoch.
///
/// # Errors
/// Settings out of range, columns that do not fit, files that cannot be written or that another run writes, a checkpoint that belongs to
/// another run, or [`TrainError::Diverged`] when a loss or a weight is no longer finite. Being asked to stop is not an error:
/// see [`End::Interrupted`].
pub fn train<'a>(
    config: &Config,
    data: impl Into<Source<'a>>,
    options: &RunOptions<'_>,
    on_epoch: impl FnMut(&EpochReport),
) -> Result<Outcome, TrainError> {
    let source = data.into();
    config.check()?;
    for path in &options.loss_curve {
        CurveFormat::of(path)?;
    }
    for path in options.loss_curve.iter().chain([&options.out]) {
        if path.is_dir() {
            return Err(TrainError::Io {
                path: path.clone(),
                error: std::io::ErrorKind::IsADirectory.into(),
            });
        }
    }
    if let Source::Memory(data) = source {
        data.check(config.recipe)?;
    }
    let _lock = match options.lock {
        Some(_) => None,
        None => Some(OutputLock::take(&options.out)?),
    };
    let (examples, normalisation, dataset, fingerprint) = match source {
        Source::Memory(data) => {
            let split = match &data.subsets {
                Some(subsets) => Split::of(subsets),
                None => Split::random(data.examples() as u32, config.held_out, config.seed),
            };
            let normalisation = data.normalisation(&split);
            let examples = Examples::in_memory(data, split);
            (examples, normalisation, &data.dataset, data.fingerprint())
        }
        Source::Streamed(data) => {
            let most = config.buffer_rows.unwrap_or(DEFAULT_BUFFER_ROWS);
            let windows = Windows::new(data, config, most);
            let normalisation = data.normalisation.clone();
            (
                Examples::Streamed(Box::new(windows)),
                normalisation,
                &data.dataset,
                data.fingerprint(),
            )
        }
    };
    let device = options.compute.device();
    let mut feed = Feed::new(config, examples, &normalisation, &device);
    let run = Run {
        config,
        normalisation: &normalisation,
        dataset,
        fingerprint,
        options,
        device,
        threads: rayon::ThreadPoolBuilder::new()
            .num_threads(options.compute.threads(options.threads))
            .build()
            .map_err(|error| TrainError::Threads(error.to_string()))?,
        shape: shape(config),
        folder: checkpoint::folder(&options.out),
    };
    run.go(&mut feed, on_epoch)
}

fn shape(config: &Config) -> Shape {
    let recipe = config.recipe;
    let widths = std::iter::once(recipe.inputs.about().len())
        .chain(config.hidden.iter().copied())
        .chain([recipe.output.count()])
        .collect();
    Shape {
        widths,
        hidden: config.hidden_activation,
        output: config.output_activation,
    }
}

/// What does not change during a run.
struct Run<'a> {
    config: &'a Config,
    normalisation: &'a [Normalisation],
    dataset: &'a Option<DatasetRef>,
    fingerprint: String,
    options: &'a RunOptions<'a>,
    device: Device,
    threads: rayon::ThreadPool,
    shape: Shape,
    folder: PathBuf,
}

/// What an epoch changes. Cloning it copies references to tensors, not their values.
#[derive(Clone)]
struct Progress {
    parameters: Tensor<1>,
    adam: Adam,
    best: Option<(u32, Tensor<1>)>,
    history: Vec<EpochReport>,
}

/// What one epoch made.
struct Pass {
    parameters: Tensor<1>,
    adam: Adam,
    train_loss: f64,
    held_out_loss: Option<f64>,
    seconds: f64,
}

impl Run<'_> {
    fn go(
        &self,
        feed: &mut Feed<'_>,
        mut on_epoch: impl FnMut(&EpochReport),
    ) -> Result<Outcome, TrainError> {
        let (mut progress, resumed_from) = self.start()?;
        let mut saved = Instant::now();
        let end = loop {
            let epoch = progress.history.len() as u32 + 1;
            if let (Some(patience), Some((best, _))) = (self.config.patience, &progress.best)
                && epoch - 1 - best >= patience
            {
                break End::StoppedEarly;
            }
            if epoch > self.config.epochs {
                break End::Finished;
            }
            let Some(pass) = self
                .threads
                .install(|| self.epoch(epoch, feed, &progress))?
            else {
                break End::Interrupted;
            };
            self.take(pass, epoch, feed.examples(Part::Train), &mut progress)?;
            if let Some(report) = progress.history.last() {
                on_epoch(report);
            }
            if saved.elapsed() >= SAVE_EVERY {
                self.save(&progress)?;
                saved = Instant::now();
            }
        };
        self.save(&progress)?;
        for path in &self.options.loss_curve {
            write_curve(path, &progress.history)?;
        }
        self.finish(feed, progress, end, resumed_from)
    }

    /// The state that a run starts from: the checkpoint's, with the epoch that it was saved after, or a new one.
    fn start(&self) -> Result<(Progress, Option<u32>), TrainError> {
        if self.options.resume {
            let state = State::load(
                &self.folder,
                self.config,
                &self.fingerprint,
                self.shape.parameters(),
            )?;
            let epoch = state.history.len() as u32;
            return Ok((self.restore(state), Some(epoch)));
        }
        let parameters = self.upload(self.shape.initial(self.config.seed));
        let progress = Progress {
            adam: Adam::new(&parameters),
            parameters,
            best: None,
            history: Vec::new(),
        };
        self.clear()?;
        // Reports now, and not after the last epoch, that the folder cannot be written.
        self.save(&progress)?;
        Ok((progress, None))
    }

    /// Makes what an epoch computed the state of the run.
    fn take(
        &self,
        pass: Pass,
        epoch: u32,
        examples: u64,
        progress: &mut Progress,
    ) -> Result<(), TrainError> {
        if let Some(what) = self.not_finite(pass.train_loss, pass.held_out_loss, &pass.parameters) {
            return Err(self.diverged(epoch, what, progress));
        }
        let score = pass.held_out_loss.unwrap_or(pass.train_loss);
        let best = self.score(progress).is_none_or(|lowest| score < lowest);
        if best {
            progress.best = Some((epoch, pass.parameters.clone()));
        }
        progress.parameters = pass.parameters;
        progress.adam = pass.adam;
        progress.history.push(EpochReport {
            epoch,
            epochs: self.config.epochs,
            train_loss: pass.train_loss,
            held_out_loss: pass.held_out_loss,
            seconds: pass.seconds,
            rows_per_s: examples as f64 / pass.seconds.max(f64::MIN_POSITIVE),
            best,
        });
        Ok(())
    }

    /// Chooses the model, judges it by the test examples and writes it, unless the run was interrupted.
    fn finish(
        &self,
        feed: &mut Feed<'_>,
        progress: Progress,
        end: End,
        resumed_from: Option<u32>,
    ) -> Result<Outcome, TrainError> {
        // Choosing the best epoch is what patience asks for; see the crate's documentation.
        let chosen = match &progress.best {
            Some((epoch, parameters)) if self.config.patience.is_some() => (*epoch, parameters),
            _ => (progress.history.len() as u32, &progress.parameters),
        };
        let mut model = self.model(chosen.0, chosen.1, &progress.history, &self.options.out)?;
        if feed.examples(Part::Validation) > 0 {
            let losses = &mut model.meta.losses;
            losses.validation = losses.validation.or(losses.test);
            losses.test = self
                .threads
                .install(|| self.mean_loss(feed, chosen.1, Part::Test))?;
        }
        if end != End::Interrupted {
            save_model(&model, &self.options.out)?;
        }
        Ok(Outcome {
            model,
            model_epoch: chosen.0,
            history: progress.history,
            end,
            resumed_from,
            checkpoint: self.folder.clone(),
        })
    }

    /// One pass over the training examples and one over the held-out ones; none when asked to stop.
    fn epoch(
        &self,
        epoch: u32,
        feed: &mut Feed<'_>,
        start: &Progress,
    ) -> Result<Option<Pass>, TrainError> {
        let config = self.config;
        let examples = feed.examples(Part::Train);
        let steps = examples.div_ceil(config.batch as u64) * u64::from(config.epochs);
        let begin = Instant::now();
        let mut parameters = start.parameters.clone();
        let mut adam = start.adam.clone();
        let count = self.shape.parameters();
        let mut loss = 0.0;
        feed.begin(Part::Train, Some(epoch));
        while let Some(window) = feed.next(Part::Train)? {
            let team = self.team(feed.task(Part::Train));
            let mut losses = Vec::with_capacity(window.div_ceil(config.batch));
            for first in (0..window).step_by(config.batch) {
                if self.options.stop.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let range = first..(first + config.batch).min(window);
                let scale = 1.0 / range.len() as f64;
                let sum = team.gradient(&parameters, range);
                losses.push(sum.clone().narrow(0, count, 1));
                let gradient = sum.narrow(0, 0, count) * scale;
                let rate = config
                    .schedule
                    .rate(config.learning_rate, adam.steps, steps);
                (adam, parameters) = adam.step(config, rate, parameters, gradient);
            }
            loss += total(losses);
        }
        let seconds = begin.elapsed().as_secs_f64();
        let held_out_loss = self.held_out_loss(feed, &parameters)?;
        Ok(Some(Pass {
            train_loss: loss / examples as f64,
            held_out_loss,
            seconds,
            parameters,
            adam,
        }))
    }

    /// Mean loss of what an epoch is judged by: the validation examples, or the test examples where there are none.
    fn held_out_loss(
        &self,
        feed: &mut Feed<'_>,
        parameters: &Tensor<1>,
    ) -> Result<Option<f64>, TrainError> {
        match self.mean_loss(feed, parameters, Part::Validation)? {
            None => self.mean_loss(feed, parameters, Part::Test),
            loss => Ok(loss),
        }
    }

    /// Mean loss of a part; none when it is empty.
    fn mean_loss(
        &self,
        feed: &mut Feed<'_>,
        parameters: &Tensor<1>,
        part: Part,
    ) -> Result<Option<f64>, TrainError> {
        let examples = feed.examples(part);
        let mut sum = 0.0;
        feed.begin(part, None);
        while let Some(window) = feed.next(part)? {
            sum += total(self.team(feed.task(part)).losses(parameters, window));
        }
        Ok((examples > 0).then(|| sum / examples as f64))
    }

    fn team<'a>(&'a self, task: &'a dyn Task) -> Team<'a> {
        Team {
            task,
            shape: &self.shape,
            chunk: self.config.chunk,
        }
    }

    /// Removes an earlier run's model files: they must not pass for this run's.
    fn clear(&self) -> Result<(), TrainError> {
        for name in ["last", "best"] {
            let path = self.folder.join(name).with_extension("safetensors");
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(TrainError::Io { path, error });
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn score(&self, progress: &Progress) -> Option<f64> {
        let (epoch, _) = progress.best.as_ref()?;
        let row = &progress.history[*epoch as usize - 1];
        Some(row.held_out_loss.unwrap_or(row.train_loss))
    }

    fn not_finite(
        &self,
        train_loss: f64,
        held_out_loss: Option<f64>,
        parameters: &Tensor<1>,
    ) -> Option<&'static str> {
        if !train_loss.is_finite() {
            Some("the training loss")
        } else if held_out_loss.is_some_and(|loss| !loss.is_finite()) {
            Some("the held-out loss")
        } else if download(parameters).iter().any(|v| !v.is_finite()) {
            Some("a weight")
        } else {
            None
        }
    }

    /// Keeps what there is, then says what happened. The divergence is what the user must hear of, so a failure to save
    /// only means that nothing is said to be kept.
    fn diverged(&self, epoch: u32, what: &'static str, progress: &Progress) -> TrainError {
        let saved = self.save(progress).is_ok();
        for path in &self.options.loss_curve {
            let _ = write_curve(path, &progress.history);
        }
        TrainError::Diverged {
            epoch,
            what,
            learning_rate: self.config.learning_rate,
            kept: (saved && !progress.history.is_empty())
                .then(|| self.folder.join("last.safetensors")),
        }
    }

    fn upload(&self, values: Vec<f32>) -> Tensor<1> {
        let n = values.len();
        Tensor::from_data(TensorData::new(values, [n]), &self.device)
    }

    fn restore(&self, state: State) -> Progress {
        Progress {
            parameters: self.upload(state.parameters),
            adam: Adam {
                first: self.upload(state.first),
                second: self.upload(state.second),
                steps: state.steps,
            },
            best: state
                .best
                .map(|(epoch, values)| (epoch, self.upload(values))),
            history: state.history,
        }
    }

    /// Saves the state and the two model files made from it.
    fn save(&self, progress: &Progress) -> Result<(), TrainError> {
        State {
            parameters: download(&progress.parameters),
            first: download(&progress.adam.first),
            second: download(&progress.adam.second),
            steps: progress.adam.steps,
            best: progress
                .best
                .as_ref()
                .map(|(epoch, p)| (*epoch, download(p))),
            history: progress.history.clone(),
        }
        .save(&self.folder, self.config, &self.fingerprint)?;
        let last = (progress.history.len() as u32, &progress.parameters);
        let best = progress.best.as_ref().map(|(epoch, p)| (*epoch, p));
        if last.0 > 0 {
            for (name, (epoch, parameters)) in [("last", Some(last)), ("best", best)]
                .into_iter()
                .filter_map(|(name, which)| which.map(|which| (name, which)))
            {
                let path = self.folder.join(name).with_extension("safetensors");
                save_model(
                    &self.model(epoch, parameters, &progress.history, &path)?,
                    &path,
                )?;
            }
        }
        Ok(())
    }

    /// The model with the parameters of `epoch`.
    fn model(
        &self,
        epoch: u32,
        parameters: &Tensor<1>,
        history: &[EpochReport],
        path: &Path,
    ) -> Result<Model, TrainError> {
        let failed = |error: Box<dyn std::error::Error + Send + Sync>| TrainError::Model {
            path: path.to_owned(),
            error,
        };
        let row = (epoch as usize).checked_sub(1).and_then(|i| history.get(i));
        let held_out = row.and_then(|r| r.held_out_loss);
        let chosen_by_it = self.config.patience.is_some();
        let about = self.config.recipe.inputs.about();
        let inputs = about
            .iter()
            .zip(self.normalisation)
            .map(|(about, n)| Input {
                name: about.name.to_owned(),
                unit: about.unit.to_owned(),
                offset: n.offset,
                scale: n.scale,
                min: n.min,
                max: n.max,
            })
            .collect();
        let mut mlp = self
            .shape
            .to_mlp(&download(parameters))
            .map_err(|e| failed(Box::new(e)))?;
        // See `Normalisation::over`: an input that never varied must not matter.
        let first = &mut mlp.layers[0];
        for row in first.weights.chunks_exact_mut(first.inputs) {
            for (weight, n) in row.iter_mut().zip(self.normalisation) {
                if n.constant {
                    *weight = 0.0;
                }
            }
        }
        Ok(Model {
            mlp,
            meta: Metadata {
                format_version: peelnet_model::FORMAT_VERSION,
                tool_version: env!("CARGO_PKG_VERSION").to_owned(),
                recipe: self.config.recipe,
                inputs,
                output: self.config.recipe.output,
                seed: self.config.seed,
                dataset: self.dataset.clone(),
                epochs: epoch,
                losses: Losses {
                    train: row.map(|r| r.train_loss),
                    validation: held_out.filter(|_| chosen_by_it),
                    test: held_out.filter(|_| !chosen_by_it),
                },
                held_out: Default::default(),
                config: serde_json::to_value(self.config).map_err(|e| failed(Box::new(e)))?,
            },
        })
    }
}

fn save_model(model: &Model, path: &Path) -> Result<(), TrainError> {
    if let Some(folder) = path.parent().filter(|p| *p != Path::new("")) {
        std::fs::create_dir_all(folder).map_err(|error| TrainError::Io {
            path: folder.to_owned(),
            error,
        })?;
    }
    model.save(path).map_err(|e| TrainError::Model {
        path: path.to_owned(),
        error: Box::new(e),
    })
}

/// Reads scalars back in one transfer and adds them in 64 bits.
fn total(losses: Vec<Tensor<1>>) -> f64 {
    if losses.is_empty() {
        return 0.0;
    }
    download(&Tensor::cat(losses, 0))
        .into_iter()
        .map(f64::from)
        .sum()
}

fn download(tensor: &Tensor<1>) -> Vec<f32> {
    tensor
        .to_data()
        .try_into_vec()
        .expect("parameters and losses are 32-bit floats")
}
