//! One file per command.

mod bench;
mod bench_designs;
mod bench_effects;
mod bench_path;
mod doctor;
mod export;
mod extract;
mod inspect;
mod recommend;
mod render;
mod run;
mod seal;
mod stress;
mod train;
mod view;

use crate::cli::{Cli, Command, Global};
use crate::console::Console;
use crate::failure::{Failure, one_line};
use crate::interrupt;
use crate::parse::shown;
use crate::progress::Bar;
use peelnet_gpu::Gpu;
use peelnet_scene::{
    Scene, SceneError,
    suite::{self, SceneFile},
};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// What every command works with.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// Output.
    pub console: Console,
    /// The global flags.
    pub global: &'a Global,
    /// Set by a signal.
    pub stop: &'static AtomicBool,
}

impl Context<'_> {
    /// Opens the adapter that the flags ask for.
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

    /// Loads scenes and shows their warnings.
    fn scenes(&self, paths: &[PathBuf]) -> Result<Vec<Scene>, Failure> {
        paths.iter().map(|path| self.scene(path)).collect()
    }

    fn scene(&self, path: &Path) -> Result<Scene, Failure> {
        self.scene_at(path, None)
    }

    /// A scene at a time of its timeline.
    fn scene_at(&self, path: &Path, time: Option<f32>) -> Result<Scene, Failure> {
        if path.is_file() && path.to_str().and_then(suite::find).is_some() {
            self.console.message(format!(
                "{}: the file here, not the shipped scene of this name",
                shown(path)
            ));
        }
        let bar = Bar::spinner(self.console, format!("loading {}", shown(path)));
        let scene = suite::open(path, time);
        drop(bar);
        let scene = scene.map_err(|error| match error {
            // The file is as it should be, the flag is not: states of a timeline have numbers.
            SceneError::Value { ref field, .. } if time.is_some() && field == "timeline" => {
                Failure::Usage(one_line(&error))
            }
            error => error.into(),
        })?;
        for warning in &scene.warnings {
            self.console.warn(warning);
        }
        Ok(scene)
    }

    /// Loads scenes that ship.
    fn shipped<'f>(
        &self,
        files: impl IntoIterator<Item = &'f SceneFile>,
    ) -> Result<Vec<Scene>, Failure> {
        files
            .into_iter()
            .map(|file| Ok(suite::load_file(file, None)?))
            .collect()
    }

    /// An error if a signal came.
    fn check_interrupt(&self) -> Result<(), Failure> {
        if interrupt::requested() {
            return Err(Failure::Interrupted);
        }
        Ok(())
    }
}

/// Runs the command that was parsed.
///
/// # Errors
/// Whatever stopped it.
pub fn dispatch(cli: &Cli) -> Result<(), Failure> {
    let context = Context {
        console: Console::new(cli.global.quiet, cli.global.json),
        global: &cli.global,
        stop: interrupt::install()
            .map_err(|e| Failure::Failed(format!("cannot listen to signals: {e}")))?,
    };
    match &cli.command {
        Command::Run(args) => run::run(&context, args),
        Command::Extract(args) => extract::run(&context, args),
        Command::Seal(args) => seal::run(&context, args),
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
