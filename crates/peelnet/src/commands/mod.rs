mod bench;
mod doctor;
mod export;
mod extract;
mod inspect;
mod recommend;
mod render;
mod run;
mod stress;
mod train;
mod view;

use crate::cli::{Cli, Command, Global};
use crate::console::Console;
use crate::interrupt;
use crate::progress::Bar;
use peelnet::{Failure, model_for, weight_of};
use peelnet_bench::report::{Measurement, Results, kind_of};
use peelnet_bench::{Partial, preview};
use peelnet_core::files::{Outputs, error_line, printable, shown};
use peelnet_model::Model;
use peelnet_render::gpu::Gpu;
use peelnet_render::{FrameStats, ImageFormat, LearnedWeight, MethodSpec};
use peelnet_scene::{Scene, SceneError, suite};
use peelnet_train::OutputLock;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    pub console: Console,
    pub global: &'a Global,
    /// Set by a signal.
    pub stop: &'static AtomicBool,
}

impl Context<'_> {
    fn gpu(&self) -> Result<Gpu, Failure> {
        Ok(Gpu::open(&self.global.adapter)?)
    }

    /// Warns if the GPU's memory was full and a command used smaller tiles.
    fn warn_of_memory(&self, gpu: &Gpu) {
        if gpu.memory_was_full() {
            self.console.warn(format!(
                "the memory of {} was full: fragments were kept in smaller tiles, which takes longer and loses nothing",
                gpu.info.name
            ));
        }
    }

    /// The outputs of a command that reads these files and folders.
    fn outputs<P: AsRef<Path>>(&self, inputs: impl IntoIterator<Item = P>) -> Outputs {
        Outputs::new(("--force", self.global.force), inputs)
    }

    /// The outputs of a measurement that reads these files: its results and pictures in a folder.
    fn results<'p, T: Measurement>(
        &self,
        inputs: impl IntoIterator<Item = &'p PathBuf>,
        out: &Path,
    ) -> Result<Outputs, Failure> {
        let mut outputs = self.outputs(inputs);
        let own = Results::<T>::files();
        // What only one of those that write a report.html writes. A model of a run must not lie beside the report of another command.
        let is_run = own.contains(&"results.json") && !own.contains(&"results.csv");
        let run = (!is_run).then_some("dataset-summary.json");
        let bench = (!own.contains(&"results.csv")).then_some(Partial::FILE);
        let marks = ["results.csv", "effects.json", "path.json"].into_iter();
        let is_other = |mark: &&str| !own.contains(mark) && out.join(mark).exists();
        let mut marks = marks
            .chain(run)
            .chain(bench)
            .filter(|_| own.contains(&"report.html"));
        if let Some(mark) = marks.find(is_other).filter(|_| !self.global.force) {
            return Err(Failure::failed(format!(
                "--out {}: {mark} in it is of another command, whose report.html would be replaced; choose another folder, or replace it with --force",
                shown(out)
            )));
        }
        let files = own.into_iter();
        outputs.folder("--out", out, files.map(|name| (name, kind_of(name))))?;
        let images = out.join("images");
        outputs.files_like("--out", &images, "png", ImageFormat::Png.kind())?;
        Ok(outputs)
    }

    /// Work on these scenes begins. Once what is returned is dropped, a message says which files were replaced.
    fn begin(&self, mut outputs: Outputs, scenes: &[Scene]) -> Result<Begun, Failure> {
        if outputs.is_stdout_taken() {
            self.console.give_stdout_away();
        }
        outputs.begin(scenes.iter().flat_map(|s| &s.files))?;
        Ok(Begun {
            outputs,
            console: self.console,
        })
    }

    /// As [`Context::begin`], for what [`Context::results`] checked: until what is returned is dropped, no other command writes results
    /// and pictures into the folder.
    fn begin_in(
        &self,
        out: &Path,
        outputs: Outputs,
        scenes: &[Scene],
    ) -> Result<(OutputLock, Begun), Failure> {
        let begun = self.begin(outputs, scenes)?;
        Ok((OutputLock::take(&out.join(".peelnet"))?, begun))
    }

    fn scenes(&self, paths: &[PathBuf]) -> Result<Vec<Scene>, Failure> {
        paths.iter().map(|path| self.scene(path, None)).collect()
    }

    fn scene(&self, path: &Path, time: Option<f32>) -> Result<Scene, Failure> {
        if path.is_file() {
            self.say_not_shipped("file", path);
        }
        let bar = Bar::spinner(self.console, format!("loading {}", shown(path)));
        let scene = suite::open_with(path, time, &self.global.files_from);
        drop(bar);
        let scene = scene.map_err(|error| match error {
            // The file is as it should be, the flag is not: states of a timeline have numbers.
            SceneError::Value { ref field, .. } if time.is_some() && field == "timeline" => {
                Failure::wrong(error_line(&error))
            }
            error => error.into(),
        })?;
        for warning in &scene.warnings {
            self.console.warn(warning);
        }
        Ok(scene)
    }

    /// Says that what is here comes before the shipped scene of the same name.
    fn say_not_shipped(&self, what: &str, path: &Path) {
        if path.to_str().and_then(suite::find).is_some() {
            self.console.message(format!(
                "{}: the {what} here, not the shipped scene of this name",
                shown(path)
            ));
        }
    }

    /// The text that a method draws with, of a model's file or the shipped one; none for a method that needs no model.
    fn weight(
        &self,
        gpu: &Gpu,
        method: &MethodSpec,
        path: Option<&Path>,
    ) -> Result<Option<LearnedWeight>, Failure> {
        let given = path.map(peelnet::load_model).transpose()?;
        let model = model_for(method, given).map_err(|failure| match path {
            Some(path) => failure.about(&format!("--model {}", shown(path))),
            None => failure,
        })?;
        let Some(model) = model else {
            return Ok(None);
        };
        self.say_network(&model, path)?;
        Ok(Some(weight_of(gpu, &model)?))
    }

    /// Says which network draws: the shipped one or that of a file, and its hash.
    fn say_network(&self, model: &Model, file: Option<&Path>) -> Result<(), Failure> {
        let hash = model.hash()?;
        let from = file.map_or_else(|| "the shipped network".to_owned(), shown);
        let method = model.meta.recipe.method;
        self.console
            .message(format!("{method}: {from}, {hash:.12}"));
        Ok(())
    }

    fn check_interrupt(&self) -> Result<(), Failure> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(Failure::failed(interrupt::MESSAGE));
        }
        Ok(())
    }
}

/// The outputs of a command that has begun.
struct Begun {
    outputs: Outputs,
    console: Console,
}

impl Drop for Begun {
    fn drop(&mut self) {
        let replaced = self.outputs.replaced();
        replaced.iter().for_each(|text| self.console.message(text));
    }
}

/// Counts the fragments of view 0.
fn count(gpu: &Gpu, scene: &Scene, size: [u32; 2]) -> Result<FrameStats, Failure> {
    let camera = peelnet::view_of(scene, 0)?;
    Ok(preview::count(gpu, scene, camera, size)?)
}

/// The losses of a model that are known, with the names of their rows.
fn losses(model: &Model) -> Vec<(&'static str, f64)> {
    let losses = &model.meta.losses;
    let named = [
        ("training", losses.train),
        ("validation", losses.validation),
        ("test", losses.test),
    ];
    let known = named.into_iter();
    known.filter_map(|(name, l)| Some((name, l?))).collect()
}

/// The first names of a list, and how many there are beyond.
fn few(names: &[String], most: usize) -> String {
    let shown: Vec<_> = names.iter().take(most).map(|n| printable(n)).collect();
    match names.len().saturating_sub(most) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// A path for JSON, which has no place for bytes that are no UTF-8.
fn json_path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The command line of this process, for provenance: the program's bare name and its arguments, quoted for a shell.
fn command_line() -> String {
    let arguments = std::env::args_os()
        .skip(1)
        .map(|a| a.to_string_lossy().into_owned());
    shell_words::join(std::iter::once("peelnet".to_owned()).chain(arguments))
}

pub fn dispatch(cli: &Cli) -> Result<(), Failure> {
    let context = Context {
        console: Console::new(cli.global.quiet, cli.global.json),
        global: &cli.global,
        stop: interrupt::install()
            .map_err(|e| Failure::failed(format!("cannot listen to signals: {e}")))?,
    };
    if let Some(other) = cli.global.files_from.iter().find(|f| !f.is_dir()) {
        let text = format!("--files-from {}: is no folder", shown(other));
        return Err(Failure::wrong(text));
    }
    match &cli.command {
        Command::Run(args) => run::run(&context, args),
        Command::Extract(args) => extract::run(&context, args),
        Command::Seal(args) => extract::seal(&context, args),
        Command::Train(args) => train::run(&context, args),
        Command::Export(args) => export::run(&context, args),
        Command::Render(args) => render::run(&context, args),
        Command::View(args) => view::run(&context, args),
        Command::Bench(args) => bench::run(&context, args),
        Command::Recommend(args) => recommend::run(&context, args),
        Command::Stress(args) => stress::run(&context, args),
        Command::Inspect(args) => inspect::run(&context, args),
        Command::Doctor => doctor::run(&context),
    }
}
