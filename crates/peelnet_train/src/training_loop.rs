//! The loop over epochs and batches.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use burn::tensor::Device;
use peelnet_core::files::write_whole;
use peelnet_dataset::Subset;
use peelnet_model::{Input, Losses, Metadata, Model};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::checkpoint::{self, Progress};
use crate::config::Config;
use crate::error::{TrainError, io};
use crate::lock::OutputLock;
use crate::loss::Window;
use crate::network::{Network, Shape};
use crate::optimizer::Adam;
use crate::report::{End, EpochReport, Outcome, history_csv};
use crate::sampler::{Feed, by_subset};
use crate::table::TrainingData;

/// What a run needs besides its configuration and data, without an effect on the weights.
#[derive(Clone, Debug)]
pub struct RunOptions<'a> {
    /// The model file to write. The checkpoint folder lies beside it.
    pub out: PathBuf,
    /// Continue from the checkpoint folder, which must be there.
    pub resume: bool,
    /// Set it from anywhere to end the run: the last whole epoch is saved.
    pub stop: &'a AtomicBool,
    /// Threads to use, all cores when none. The result does not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// The lock of [`RunOptions::out`], where the caller holds it longer than the run. Without it the run takes it.
    pub lock: Option<&'a OutputLock>,
}

impl<'a> RunOptions<'a> {
    /// A fresh run on all cores.
    pub fn new(out: impl Into<PathBuf>, stop: &'a AtomicBool) -> Self {
        Self {
            out: out.into(),
            resume: false,
            stop,
            threads: None,
            lock: None,
        }
    }
}

/// A checkpoint is a few kilobytes, but an epoch of a small dataset takes a millisecond.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// With more threads a batch has no more chunks.
const MAX_THREADS: usize = 16;

/// Trains a network, writes the model file and the checkpoint folder, and returns the model.
///
/// `on_epoch` gets every epoch so far, those before a resume included, whenever one has ended.
///
/// # Errors
/// Settings out of range, columns that do not fit, files that cannot be written or that another run writes, a checkpoint that belongs to
/// another run, or a loss or a weight that is no longer finite. Being asked to stop is not an error:
/// see [`End::Interrupted`].
pub fn train(
    config: &Config,
    data: &TrainingData,
    options: &RunOptions<'_>,
    mut on_epoch: impl FnMut(&[EpochReport]),
) -> Result<Outcome, TrainError> {
    train_watched(config, data, options, |epochs, _| on_epoch(epochs))
}

/// The same, for programs that draw while it trains: `on_epoch` also gets a function that makes the model of the epoch that has ended.
///
/// # Errors
/// As [`train`].
pub fn train_watched(
    config: &Config,
    data: &TrainingData,
    options: &RunOptions<'_>,
    on_epoch: impl FnMut(&[EpochReport], &dyn Fn() -> Model),
) -> Result<Outcome, TrainError> {
    config.check()?;
    if options.out.is_dir() {
        return Err(io(&options.out)(std::io::ErrorKind::IsADirectory.into()));
    }
    data.check(config.recipe)?;
    let _lock = match options.lock {
        Some(_) => None,
        None => Some(OutputLock::take(&options.out)?),
    };
    let cores = || std::thread::available_parallelism().ok();
    let threads = options.threads.or_else(cores);
    let threads = threads.map_or(1, |n| n.get().min(MAX_THREADS));
    let device = Device::flex();
    let examples = by_subset(data, config);
    let run = Run {
        feed: Feed {
            config,
            data,
            device: &device,
            normalisation: data.normalisation(&examples[Subset::Train as usize]),
            examples,
            loaded: Default::default(),
        },
        config,
        fingerprint: data.fingerprint(),
        options,
        threads: rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| TrainError::Failed(format!("threads could not be started: {e}")))?,
        shape: Shape::new(config),
        folder: checkpoint::folder(&options.out),
    };
    run.go(on_epoch)
}

/// What does not change during a run.
struct Run<'a> {
    feed: Feed<'a>,
    config: &'a Config,
    fingerprint: String,
    options: &'a RunOptions<'a>,
    threads: rayon::ThreadPool,
    shape: Shape,
    folder: PathBuf,
}

impl Run<'_> {
    fn go(
        &self,
        mut on_epoch: impl FnMut(&[EpochReport], &dyn Fn() -> Model),
    ) -> Result<Outcome, TrainError> {
        let mut progress = self.start()?;
        let epochs = |progress: &Progress| progress.history.len() as u32;
        let resumed_from = self.options.resume.then(|| epochs(&progress));
        let mut saved = Instant::now();
        let end = loop {
            let best = progress.best.as_ref().map(|(epoch, _)| *epoch);
            if let Some(end) = self.config.end_after(epochs(&progress), best) {
                break end;
            }
            let epoch = self.threads.install(|| self.epoch(&progress));
            let (adam, report) = match epoch {
                Err(TrainError::Stopped) => break End::Interrupted,
                epoch => epoch?,
            };
            if let Some(what) = not_finite(&report, &adam) {
                return Err(self.diverged(what, &progress));
            }
            if report.best {
                progress.best = Some((report.epoch, adam.parameters.clone()));
            }
            progress.adam = adam;
            progress.history.push(report);
            let (parameters, history) = (&progress.adam.parameters, &progress.history);
            on_epoch(history, &|| {
                self.model(epochs(&progress), parameters, history)
            });
            if saved.elapsed() >= SAVE_EVERY {
                self.save(&progress)?;
                saved = Instant::now();
            }
        };
        self.save(&progress)?;
        // Choosing the best epoch is what patience asks for; see the crate's documentation.
        let (model_epoch, parameters) = match &progress.best {
            Some((epoch, parameters)) if self.config.patience.is_some() => (*epoch, parameters),
            _ => (epochs(&progress), &progress.adam.parameters),
        };
        let mut model = self.model(model_epoch, parameters, &progress.history);
        if self.feed.examples(Subset::Validation) > 0 {
            let losses = &mut model.meta.losses;
            losses.validation = losses.validation.or(losses.test);
            let test = || self.mean_loss(parameters, Subset::Test);
            losses.test = self.threads.install(test)?;
        }
        if end != End::Interrupted {
            model.save(&self.options.out)?;
        }
        Ok(Outcome {
            model,
            model_epoch,
            history: progress.history,
            end,
            resumed_from,
            checkpoint: self.folder.clone(),
        })
    }

    /// The state that a run starts from: the checkpoint's, or a new one.
    fn start(&self) -> Result<Progress, TrainError> {
        if self.options.resume {
            return Progress::load(
                &self.folder,
                self.config,
                &self.fingerprint,
                self.shape.parameters(),
            );
        }
        // An earlier run's model files must not pass for this run's.
        for (name, _) in &checkpoint::FILES[1..] {
            let path = self.folder.join(name);
            match std::fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(io(&path)(e)),
                _ => {}
            }
        }
        let initial = self.shape.initial(self.config.seed);
        let progress = Progress {
            adam: Adam::new(initial),
            best: None,
            history: Vec::new(),
        };
        // Reports now, and not after the last epoch, that the folder cannot be written.
        self.save(&progress)?;
        Ok(progress)
    }

    /// One pass over the training examples and one over the held-out ones.
    fn epoch(&self, progress: &Progress) -> Result<(Adam, EpochReport), TrainError> {
        let config = self.config;
        let epoch = progress.history.len() as u32 + 1;
        let examples = self.feed.examples(Subset::Train);
        let steps = examples.div_ceil(config.batch as u64) * u64::from(config.epochs);
        let begin = Instant::now();
        let mut adam = progress.adam.clone();
        let mut loss = 0.0;
        self.feed.pass(Subset::Train, Some(epoch), |window| {
            for first in (0..window.examples).step_by(config.batch) {
                if self.options.stop.load(Ordering::Relaxed) {
                    return Err(TrainError::Stopped);
                }
                let range = first..(first + config.batch).min(window.examples);
                let count = range.len();
                let (gradient, sum) = self.gradient(window, &adam.parameters, range);
                loss += sum;
                let schedule = config.schedule;
                let rate = schedule.rate(config.learning_rate, adam.steps, steps);
                adam.step(config, rate, &gradient, count);
            }
            Ok(())
        })?;
        let seconds = begin.elapsed().as_secs_f64();
        // The validation examples judge, or the test examples where there are none.
        let held_out_loss = match self.mean_loss(&adam.parameters, Subset::Validation)? {
            None => self.mean_loss(&adam.parameters, Subset::Test)?,
            loss => loss,
        };
        let mut report = EpochReport {
            epoch,
            epochs: config.epochs,
            train_loss: loss / examples as f64,
            held_out_loss,
            seconds,
            rows_per_s: examples as f64 / seconds.max(f64::MIN_POSITIVE),
            best: false,
        };
        let best = progress.best.as_ref();
        let lowest = best.map(|(epoch, _)| progress.history[*epoch as usize - 1].score());
        report.best = lowest.is_none_or(|lowest| report.score() < lowest);
        Ok((adam, report))
    }

    /// Mean loss of a subset; none when it is empty.
    fn mean_loss(&self, parameters: &[f32], subset: Subset) -> Result<Option<f64>, TrainError> {
        let examples = self.feed.examples(subset);
        let network = self.network(parameters);
        let mut sum = 0.0;
        self.feed.pass(subset, None, |window| {
            let losses = self.chunks(0..window.examples, |range| {
                window.loss(&network, range, self.config)
            });
            sum += losses.iter().sum::<f64>();
            Ok(())
        })?;
        Ok((examples > 0).then(|| sum / examples as f64))
    }

    fn network<'a>(&'a self, parameters: &'a [f32]) -> Network<'a> {
        Network {
            shape: &self.shape,
            parameters,
        }
    }

    /// Gradient of the summed loss of examples, `[Shape::parameters]`, and that loss.
    fn gradient(
        &self,
        window: &Window,
        parameters: &[f32],
        range: Range<usize>,
    ) -> (Vec<f32>, f64) {
        let network = self.network(parameters);
        let chunks = self.chunks(range, |range| window.gradient(&network, range, self.config));
        let sum = chunks
            .into_iter()
            .reduce(|(mut sum, loss), (chunk, of_chunk)| {
                sum.iter_mut().zip(chunk).for_each(|(sum, g)| *sum += g);
                (sum, loss + of_chunk)
            });
        sum.expect("a batch holds at least one example")
    }

    /// What `evaluate` makes of each chunk of a range, on several threads, in the order of the chunks: rayon's own reduction adds in an
    /// order that depends on which thread was free. To be called in the pool: to enter it takes longer than a small batch.
    fn chunks<T: Send>(
        &self,
        range: Range<usize>,
        evaluate: impl Fn(Range<usize>) -> T + Sync,
    ) -> Vec<T> {
        let chunk = self.config.chunk;
        if range.len() <= chunk {
            return vec![evaluate(range)];
        }
        (0..range.len().div_ceil(chunk))
            .into_par_iter()
            .map(|k| {
                let start = range.start + k * chunk;
                evaluate(start..(start + chunk).min(range.end))
            })
            .collect()
    }

    /// Keeps what there is, then says what happened. The divergence is what the user must hear of, so a failure to save
    /// only means that nothing is said to be kept.
    fn diverged(&self, what: &str, progress: &Progress) -> TrainError {
        let saved = self.save(progress).is_ok();
        let kept = if saved && !progress.history.is_empty() {
            let last = self.folder.join("last.safetensors");
            format!("; the weights before it are in {}", last.display())
        } else {
            String::new()
        };
        TrainError::Failed(format!(
            "training diverged in epoch {}: {what} is not finite or beyond use; a lower learning rate than {:?} may help{kept}",
            progress.history.len() + 1,
            self.config.learning_rate
        ))
    }

    /// Saves the state, the two model files made from it and the losses of every epoch.
    fn save(&self, progress: &Progress) -> Result<(), TrainError> {
        progress.save(&self.folder, self.config, &self.fingerprint)?;
        let history = &progress.history;
        let last = ("last", history.len() as u32, &progress.adam.parameters);
        let best = progress.best.iter();
        let best = best.map(|(epoch, best)| ("best", *epoch, best));
        let models = best.chain([last]).filter(|_| !history.is_empty());
        if !history.is_empty() {
            let path = self.folder.join(checkpoint::LOSSES);
            write_whole(&path, history_csv(history).as_bytes()).map_err(io(&path))?;
        }
        for (name, epoch, parameters) in models {
            let path = self.folder.join(name).with_extension("safetensors");
            self.model(epoch, parameters, history).save(path)?;
        }
        Ok(())
    }

    fn model(&self, epoch: u32, parameters: &[f32], history: &[EpochReport]) -> Model {
        let row = (epoch as usize).checked_sub(1).and_then(|i| history.get(i));
        let held_out = row.and_then(|r| r.held_out_loss);
        let chosen_by_it = self.config.patience.is_some();
        let recipe = self.config.recipe;
        let about = recipe.inputs.features();
        let inputs = about.iter().zip(&self.feed.normalisation);
        let inputs = inputs.map(|(about, n)| Input {
            name: about.name.to_owned(),
            unit: about.unit.to_owned(),
            offset: n.offset,
            scale: n.scale,
            min: n.min,
            max: n.max,
        });
        let mut mlp = self.shape.to_mlp(parameters);
        // See `Normalisation::from_moments`: an input that never varied must not matter.
        let first = &mut mlp.layers[0];
        for row in first.weights.chunks_exact_mut(first.inputs) {
            for (weight, n) in row.iter_mut().zip(&self.feed.normalisation) {
                if n.constant {
                    *weight = 0.0;
                }
            }
        }
        Model {
            mlp,
            meta: Metadata {
                format_version: peelnet_model::FORMAT_VERSION,
                tool_version: env!("CARGO_PKG_VERSION").to_owned(),
                recipe,
                inputs: inputs.collect(),
                output: recipe.output,
                seed: self.config.seed,
                dataset: self.feed.data.dataset.clone(),
                epochs: epoch,
                losses: Losses {
                    train: row.map(|r| r.train_loss),
                    validation: held_out.filter(|_| chosen_by_it),
                    test: held_out.filter(|_| !chosen_by_it),
                },
                held_out: Default::default(),
                config: serde_json::json!(self.config),
            },
        }
    }
}

/// Errors of what is learned are of the size of 1: beyond, a network says nothing, and will not return.
const MOST_LOSS: f64 = 1e6;

/// What of an epoch is not finite, or too large.
fn not_finite(report: &EpochReport, adam: &Adam) -> Option<&'static str> {
    let is_bad = |loss: f64| loss.is_nan() || loss > MOST_LOSS;
    if is_bad(report.train_loss) {
        Some("the training loss")
    } else if report.held_out_loss.is_some_and(is_bad) {
        Some("the held-out loss")
    } else {
        let mut weights = adam.parameters.iter();
        weights.any(|v| !v.is_finite()).then_some("a weight")
    }
}
