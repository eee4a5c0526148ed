//! `cargo xtask test`, short and long.

use crate::{
    Outcome, command, run,
    setup::{ensure_browser, ensure_driver, ensure_subcommand},
    start, suites,
};
use std::{env, path::PathBuf, process::Command, time::Instant};

pub type Step = (&'static str, fn() -> Outcome);

/// What every change may break.
const SHORT: [Step; 4] = [
    ("formatting", || run("cargo fmt --all --check")),
    ("build and clippy", || {
        linted("nextest run --workspace --no-run")
    }),
    ("tests", || linted("nextest run --workspace --no-fail-fast")),
    ("documentation examples", || {
        linted("test --workspace --doc --quiet")
    }),
];

/// What only `test --all` runs beside the suites.
const LONG: [Step; 3] = [
    ("long tests", || {
        ensure_browser()?;
        // Without what `peers` runs.
        linted(
            "nextest run --workspace --no-fail-fast --run-ignored only -E !test(gradients_are_pytorchs)",
        )
    }),
    ("benchmarks", || {
        linted("test --workspace --benches --no-run")
    }),
    ("documentation", || {
        let mut doc = command("cargo doc --workspace --no-deps --quiet");
        start(doc.env("RUSTDOCFLAGS", "-D warnings"))
    }),
];

/// What every change may break, ending with the first step that fails; or everything, each suite whatever became of those before it.
pub fn test(all: bool) -> Outcome {
    ensure_driver()?;
    ensure_subcommand("nextest")?;
    match all {
        false => steps(&SHORT, true),
        true => steps(&[&SHORT[..], &LONG, &suites::SUITES].concat(), false),
    }
}

fn steps(steps: &[Step], ends_early: bool) -> Outcome {
    let mut summary = String::new();
    let mut failed = Vec::new();
    for (name, step) in steps {
        println!("\n== {name}");
        let begin = Instant::now();
        let result = step();
        let word = if result.is_ok() { "ok" } else { "FAILED" };
        let seconds = begin.elapsed().as_secs_f64();
        summary += &format!("{seconds:>8.1} s  {word:<6}  {name}\n");
        if let Err(e) = result {
            eprintln!("error: {e}");
            failed.push(*name);
            if ends_early {
                break;
            }
        }
    }
    print!("\n{summary}");
    if failed.is_empty() {
        println!("all steps passed");
        return Ok(());
    }
    Err(format!("failed: {}", failed.join(", ")))
}

/// Cargo with clippy in the compiler's place for the workspace's own crates, warnings denied: what is tested is what was linted, and
/// dependencies are compiled once. It is what `cargo clippy` does for `cargo check`. Artefacts of the workspace lie beside those of a plain
/// `cargo build`; neither makes the other build again.
fn linted(line: &str) -> Outcome {
    let mut command = command(&format!("cargo {line}"));
    // A toolchain has them side by side.
    let name = format!("clippy-driver{}", env::consts::EXE_SUFFIX);
    let beside = env::var_os("CARGO").map(|cargo| PathBuf::from(cargo).with_file_name(&name));
    let driver = beside.filter(|path| path.exists());
    let driver = driver.unwrap_or_else(|| name.into());
    if Command::new(&driver).arg("--version").output().is_err() {
        return Err("clippy is not installed: rustup component add clippy".to_owned());
    }
    command.env("RUSTC_WORKSPACE_WRAPPER", driver);
    // With the driver's own separator.
    let denied = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";
    start(command.env("CLIPPY_ARGS", denied))
}
