//! Training on the scene that is open, or on a dataset. A thread peels the scene on a device of its own, trains, and leaves the network of every epoch for the window,
//! which draws it when it has the time.

use crate::{
    app::App,
    slot::Network,
    stage::Stage,
    task::{Fallible, one_line},
};
use egui::Context;
use peelnet_bench::preview;
use peelnet_core::files::counted;
use peelnet_dataset::Dataset;
use peelnet_model::{Model, Recipe};
use peelnet_peel::{ExtractOptions, PeelError, extract};
use peelnet_render::gpu::Gpu;
use peelnet_scene::Scene;
use peelnet_train::{Config, EpochReport, RunOptions, TrainingData, train_watched};
use std::{
    num::NonZeroUsize,
    path::Path,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{JoinHandle, available_parallelism},
    time::{Duration, Instant},
};

/// The least time between two networks that are drawn, seconds.
const LEAST_PAUSE: f64 = 0.25;

/// To make a network ready stops the window, because its pipelines are compiled. The pause is this many times as long.
const PAUSE: f64 = 4.0;

/// The next network waits at most so long for the error of the one that is drawn, seconds.
const MEASURING: f64 = 2.0;

/// Errors are compared with this many times the last one.
const NEAR: f64 = 1.2;

/// An epoch, and when it ended.
#[derive(Clone)]
pub(crate) struct Epoch {
    /// Since the button was pressed.
    pub seconds: f64,
    pub report: EpochReport,
}

impl Epoch {
    /// The held-out loss, or the training loss where nothing is held out.
    pub fn loss(&self) -> f64 {
        self.report.held_out_loss.unwrap_or(self.report.train_loss)
    }
}

/// A network that was drawn.
pub(crate) struct Drawn {
    number: u64,
    pub epoch: u32,
    /// Since the button was pressed.
    pub seconds: f64,
    /// Error of the view that was shown, where it was measured: mean squared, 0–255.
    pub mse255: Option<f64>,
}

/// What the thread has done.
#[derive(Default)]
struct News {
    /// Views peeled, and all.
    peeled: (u32, u32),
    epochs: Vec<Epoch>,
    /// Of the last epoch, until the window takes it.
    model: Option<Model>,
    end: Option<Result<(), String>>,
}

struct Shared {
    stop: AtomicBool,
    news: Mutex<News>,
    ui: Context,
    begun: Instant,
}

impl Shared {
    fn news(&self) -> MutexGuard<'_, News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self, change: impl FnOnce(&mut News)) {
        change(&mut self.news());
        self.ui.request_repaint();
    }
}

/// The thread; dropping it ends the training and waits until its files are gone.
struct Running {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        // A panic was reported when the thread ended.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

pub(crate) struct Training {
    /// The recipe that was chosen; by default that of the method shown.
    pub recipe: Option<Recipe>,
    /// By default the recipe's.
    pub epochs: Option<u32>,
    /// Of the views that are peeled.
    pub size: [u32; 2],
    /// Fragments that are trained on, about: whole pixels are drawn to reach it.
    pub rows: u64,
    running: Option<Running>,
    /// Views peeled, and all.
    pub peeled: (u32, u32),
    pub history: Vec<Epoch>,
    pub drawn: Vec<Drawn>,
    pub failure: Option<String>,
    swapped: Instant,
}

/// The sizes of `peelnet run`.
impl Default for Training {
    fn default() -> Self {
        Self {
            recipe: None,
            epochs: None,
            size: [512, 384],
            rows: 300_000,
            running: None,
            peeled: (0, 0),
            history: Vec::new(),
            drawn: Vec::new(),
            failure: None,
            swapped: Instant::now(),
        }
    }
}

impl Training {
    pub const fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// Whether it was asked to stop, and has not yet.
    pub fn is_stopping(&self) -> bool {
        let running = self.running.as_ref();
        running.is_some_and(|r| r.shared.stop.load(Ordering::Relaxed))
    }

    /// Ends the training after the batch that it is at; the network of the last whole epoch is drawn.
    pub fn stop(&self) {
        if let Some(running) = &self.running {
            running.shared.stop.store(true, Ordering::Relaxed);
        }
    }

    /// Ends the training; the network that is drawn stays.
    pub fn abandon(&mut self) {
        self.running = None;
    }

    /// When errors came near the last one and stayed there, and what they were; for scripts.
    pub fn text(&self) -> Option<String> {
        let last = self.history.last()?;
        let since = |all: &[(f64, f64)]| {
            let (_, end) = *all.last()?;
            let far = all.iter().rposition(|(_, error)| *error > NEAR * end);
            let (seconds, _) = all[far.map_or(0, |k| k + 1)];
            Some(format!(
                "{end:.3e}, at most {NEAR} times that from {seconds:.1} s on"
            ))
        };
        let losses: Vec<_> = self.history.iter().map(|e| (e.seconds, e.loss())).collect();
        let errors = self.drawn.iter();
        let errors: Vec<_> = errors
            .filter_map(|d| Some((d.seconds, d.mse255?)))
            .collect();
        let mut text = format!(
            "trained {} of {} in {:.1} s, the first after {:.1} s",
            counted(self.history.len() as u64, "epoch"),
            last.report.epochs,
            last.seconds,
            self.history[0].seconds
        );
        for (name, errors) in [("held-out loss", losses), ("MSE of the view", errors)] {
            text += &since(&errors).map_or(String::new(), |s| format!("; {name} {s}"));
        }
        for d in &self.drawn {
            let mse = d
                .mse255
                .map_or("not measured".into(), |x| format!("MSE {x:.4}"));
            text += &format!("\n{:.1} s: epoch {}, {mse}", d.seconds, d.epoch);
        }
        Some(text)
    }
}

impl App {
    /// What the button would train.
    pub(crate) fn recipe(&self) -> Recipe {
        let shown = || Recipe::for_method(self.first.spec.name());
        self.training.recipe.or_else(shown).unwrap_or(Recipe::SMALL)
    }

    /// Peels and trains; without a recipe what the panel says.
    pub(crate) fn begin_training(&mut self, ui: &Context, recipe: Option<Recipe>) {
        self.training.recipe = recipe.or(self.training.recipe);
        let config = Config::for_recipe(self.recipe());
        let config = Config {
            epochs: self.training.epochs.unwrap_or(config.epochs),
            ..config
        };
        let Some(stage) = &self.stage else { return };
        let (gpu, scene) = (self.gpu.clone(), seen(stage));
        let dataset = self.dataset.as_ref().map(|looked| looked.path.clone());
        let shared = Arc::new(Shared {
            stop: AtomicBool::new(false),
            news: Mutex::default(),
            ui: ui.clone(),
            begun: Instant::now(),
        });
        let (size, rows) = (self.training.size, self.training.rows);
        self.training = Training {
            recipe: self.training.recipe,
            epochs: self.training.epochs,
            size,
            rows,
            ..Training::default()
        };
        let own = Arc::clone(&shared);
        let work = move || {
            let end = match dataset {
                Some(path) => train_on(&path, &config, &own),
                None => peel_and_train(&gpu, scene, &config, size, rows, &own),
            };
            let end = end.map_err(|e| one_line(&*e));
            own.tell(|news| news.end = Some(end));
        };
        let thread = std::thread::Builder::new().spawn(work);
        if let Some(thread) = self.messages.unless_error(thread) {
            let thread = Some(thread);
            self.training.running = Some(Running { shared, thread });
            // What a file says would replace what is trained.
            self.watch.follow(None);
        }
    }

    /// Takes what the thread has done since the last frame.
    pub(crate) fn poll_training(&mut self, ui: &Context) {
        let training = &mut self.training;
        if let Some((key, Ok(numbers))) = &self.errors.last {
            let mut drawn = training.drawn.iter_mut();
            if let Some(drawn) = drawn.find(|d| Some(d.number) == key.network) {
                drawn.mse255 = Some(numbers.differences.mse255);
            }
        }
        let Some(Running { shared, thread }) = &training.running else {
            return;
        };
        let is_due = training.drawn.last().is_none_or(|last| {
            let is_measured = last.mse255.is_some() || !self.panels.measures;
            let wait = if is_measured { LEAST_PAUSE } else { MEASURING };
            let pause = wait.max(PAUSE * self.first.ready_ms / 1e3);
            training.swapped.elapsed().as_secs_f64() >= pause
        });
        let has_ended = thread.as_ref().is_none_or(JoinHandle::is_finished);
        let mut news = shared.news();
        let panicked = || has_ended.then(|| Err("the training failed".to_owned()));
        let end = news.end.take().or_else(panicked);
        let model = news.model.take_if(|_| is_due || end.is_some());
        training.peeled = news.peeled;
        let new = news.epochs.iter().skip(training.history.len());
        training.history.extend(new.cloned());
        drop(news);
        let seconds = shared.begun.elapsed().as_secs_f64();
        if let Some(model) = model {
            self.draw_trained(model, seconds);
        }
        match end {
            None => ui.request_repaint_after(Duration::from_millis(100)),
            Some(end) => {
                self.training.abandon();
                self.training.failure = end.err();
                let failure = self.training.failure.iter();
                failure.for_each(|e| self.messages.error(format!("training: {e}")));
            }
        }
    }

    fn draw_trained(&mut self, model: Model, seconds: f64) {
        let (method, epoch) = (model.meta.recipe.method, model.meta.epochs);
        let Some(network) = self.messages.unless_error(Network::from_model(None, model)) else {
            return;
        };
        let is_drawn = self.first.spec.name() == method;
        if !is_drawn && self.training.drawn.is_empty() {
            self.messages
                .unless_error(method.parse().map(|spec| self.first.set_spec(spec)));
        }
        self.training.drawn.push(Drawn {
            number: network.number,
            epoch,
            seconds,
            mse255: None,
        });
        self.training.swapped = Instant::now();
        self.first.set_network(Some(network));
    }

    /// Whether a script waits: for the end of the training, and for the error of its last network.
    pub(crate) fn awaits_training(&self) -> bool {
        let last = self.training.drawn.last();
        let is_unknown = last.is_some_and(|d| d.mse255.is_none());
        let fails = matches!(self.errors.last, Some((_, Err(_))));
        self.training.is_busy() || (is_unknown && self.panels.measures && !fails)
    }
}

/// The scene as it is drawn. What is trained is this scene's own network: a mark that holds the scene out does not count.
fn seen(stage: &Stage) -> Scene {
    let mut scene = stage.without_effects();
    scene.held_out = false;
    scene
}

fn peel_and_train(
    gpu: &Gpu,
    scene: Scene,
    config: &Config,
    size: [u32; 2],
    rows: u64,
    shared: &Shared,
) -> Fallible<()> {
    config.check()?;
    let gpu = gpu.open_another()?;
    let folder = tempfile::tempdir()?;
    let camera = scene.views.first().ok_or("the scene has no view")?;
    let of_view = preview::count(&gpu, &scene, camera, size)?.fragments;
    let fragments = of_view.unwrap_or(0) * scene.views.len() as u64;
    if fragments == 0 {
        return Err("view 0 has no transparent fragment, so there is nothing to learn from".into());
    }
    let options = ExtractOptions {
        size,
        pixels: (rows as f64 / fragments as f64).min(1.0),
        ..ExtractOptions::new(folder.path().join("dataset"))
    };
    let peeled = extract(&gpu, &[scene], &options, &shared.stop, &mut |p| {
        shared.tell(|news| news.peeled = (p.items_done, p.items));
    });
    match peeled {
        Err(PeelError::Interrupted) => return Ok(()),
        peeled => peeled?,
    };
    drop(gpu);
    train_on(&options.out, config, shared)
}

fn train_on(dataset: &Path, config: &Config, shared: &Shared) -> Fallible<()> {
    let folder = tempfile::tempdir()?;
    let data = TrainingData::from_datasets(config, &[Dataset::open(dataset)?])?;
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let run = RunOptions {
        // One is the window's.
        threads: NonZeroUsize::new(cores - 1).or(Some(NonZeroUsize::MIN)),
        ..RunOptions::new(folder.path().join("model.safetensors"), &shared.stop)
    };
    train_watched(config, &data, &run, |epochs, model| {
        let (seconds, model) = (shared.begun.elapsed().as_secs_f64(), model());
        let report = epochs.last().cloned();
        shared.tell(|news| {
            let epoch = |report| Epoch { seconds, report };
            news.epochs.extend(report.map(epoch));
            news.model = Some(model);
        });
    })?;
    Ok(())
}
