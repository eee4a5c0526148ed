//! Tests, lints and the longer searches.

use crate::setup::{apt_install, ensure_browser, ensure_driver, ensure_program, ensure_subcommand};
use crate::{cargo, run};
use std::process::Command;
use std::time::{Duration, Instant};

pub fn test() -> Result<(), String> {
    ensure_driver()?;
    ensure_browser()?;
    let nextest = cargo()
        .args(["nextest", "--version"])
        .output()
        .is_ok_and(|o| o.status.success());
    let tests = if nextest {
        "nextest run --workspace --no-fail-fast"
    } else {
        println!(
            "cargo-nextest is not installed: using cargo test (cargo install cargo-nextest runs tests side by side)"
        );
        "test --workspace --lib --bins --tests"
    };
    let steps = [
        ("formatting", "fmt --all --check"),
        // Tests run them.
        ("examples", "build --workspace --examples"),
        ("tests", tests),
        ("documentation examples", "test --workspace --doc --quiet"),
        ("clippy", "clippy --workspace --all-targets -- -D warnings"),
        ("documentation", "doc --workspace --no-deps --quiet"),
    ];
    let mut times: Vec<(&str, Duration)> = Vec::new();
    let mut result = Ok(());
    for (name, args) in steps {
        println!("\n== {name}: cargo {args}");
        let start = Instant::now();
        let mut command = cargo();
        command
            .args(args.split(' '))
            .env("RUSTDOCFLAGS", "-D warnings");
        result = run(&mut command, name);
        times.push((name, start.elapsed()));
        if result.is_err() {
            break;
        }
    }
    println!();
    for (name, time) in times {
        println!("{:>7.1} s  {name}", time.as_secs_f64());
    }
    if result.is_ok() {
        println!("all steps passed");
    }
    result
}

/// The Bevy plugin, a workspace of its own: its lints and tests, and its comparison against the exact image.
pub fn bevy() -> Result<(), String> {
    ensure_driver()?;
    // The crate declares the compiler that Bevy asks for. Older ones compile it, down to that of this workspace.
    const OLDER: &str = "--ignore-rust-version";
    let steps: [(&str, &[&str]); 4] = [
        ("formatting", &["fmt", "--check"]),
        ("clippy", &["clippy", OLDER, "--all-targets"]),
        ("tests", &["test", OLDER, "--no-fail-fast"]),
        ("comparison", &["run", OLDER, "--example", "compare"]),
    ];
    for (name, args) in steps {
        println!("\n== {name} of bevy_peelnet: cargo {}", args.join(" "));
        let mut command = cargo();
        command
            .args(args)
            .args(["--manifest-path", "bevy/Cargo.toml"]);
        match name {
            "clippy" => command.args(["--", "-D", "warnings"]),
            "comparison" => command.args(["--", "--out", "out/bevy"]),
            _ => &mut command,
        };
        run(&mut command, name)?;
    }
    Ok(())
}

/// Whether the committed results are complete, and the documents show what they hold.
pub fn results() -> Result<(), String> {
    let package = ["--quiet", "--package", "peelnet_tests"];
    let check = ["--example", "check_results"];
    let documents = ["--test", "documents"];
    run(cargo().arg("run").args(package).args(check), "results")?;
    run(
        cargo().arg("test").args(package).args(documents),
        "documents",
    )
}

/// Licences, sources and versions; advisories where their database can be reached.
pub fn deny() -> Result<(), String> {
    ensure_subcommand("deny")?;
    run(
        cargo().args(["deny", "check", "licenses", "bans", "sources"]),
        "cargo deny",
    )?;
    run(
        cargo().args(["deny", "fetch", "db"]),
        "fetching the advisories",
    )
    .map_err(|e| {
        format!("{e}: the database of advisories cannot be reached, they are not checked")
    })?;
    run(cargo().args(["deny", "check", "advisories"]), "cargo deny")
}

/// What a page in a browser needs.
const WEB_CRATES: [&str; 10] = [
    "peelnet_core",
    "peelnet_scene",
    "peelnet_shaders",
    "peelnet_gpu",
    "peelnet_model",
    "peelnet_export",
    "peelnet_render",
    "peelnet_peel",
    "peelnet_eval",
    "peelnet_view",
];

/// Compiles the crates of a page without linking them.
pub fn wasm() -> Result<(), String> {
    let mut command = cargo();
    command.args(["check", "--target", "wasm32-unknown-unknown"]);
    command.args(WEB_CRATES.iter().flat_map(|name| ["--package", name]));
    run(&mut command, "wasm").map_err(|e| {
        format!("{e}; where the target is missing: rustup target add wasm32-unknown-unknown")
    })
}

/// The package for three.js.
pub fn three() -> Result<(), String> {
    ensure_browser()?;
    let npm = |args: &[&str]| {
        let mut command = Command::new("npm");
        // Commands run in the root.
        command.args(["--prefix", "packages/three"]).args(args);
        run(&mut command, "npm")
    };
    npm(&["ci", "--no-audit", "--no-fund"])?;
    npm(&["test"])
}

/// The exported texts, by the compilers that renderers use.
pub fn languages() -> Result<(), String> {
    let glslang = Command::new("glslangValidator").arg("--version").output();
    if glslang.is_err() {
        println!("glslangValidator is not installed: installing it with apt-get (glslang-tools).");
        apt_install(&["glslang-tools"]).map_err(|e| {
            format!("{e}; install glslangValidator, of the Khronos Group's glslang")
        })?;
    }
    run(
        Command::new("python3").arg("benches/languages.py"),
        "languages",
    )
}

/// The book.
pub fn docs() -> Result<(), String> {
    ensure_program("mdbook")?;
    run(Command::new("mdbook").args(["build", "docs"]), "mdbook")
}

/// A million random lists of fragments.
pub fn search() -> Result<(), String> {
    again("PROPTEST_CASES", "1000000", "peelnet_tests", "random_lists")
}

/// Commands that are killed again and again.
pub fn faults() -> Result<(), String> {
    ensure_driver()?;
    again("PEELNET_KILLS", "50", "peelnet", "faults")
}

/// One test file again, at the length that an environment variable asks for, its output shown.
fn again(variable: &str, value: &str, package: &str, test: &str) -> Result<(), String> {
    let mut command = cargo();
    command.args(["test", "--package", package, "--test", test]);
    command.args(["--", "--nocapture"]).env(variable, value);
    run(&mut command, test)
}

/// One for each reader of files that users hand over.
const FUZZ_TARGETS: [&str; 7] = ["scene", "obj", "gltf", "ply", "stl", "dataset", "model"];

/// Commands as a whole and every fuzz target for so many seconds, one after the other; a finding ends it and lies in fuzz/artifacts.
pub fn fuzz(seconds: &str) -> Result<(), String> {
    ensure_driver()?;
    println!("\n== commands, {seconds} s");
    again(
        "PEELNET_FUZZ_SECONDS",
        seconds,
        "peelnet",
        "fuzzed_commands",
    )?;
    ensure_subcommand("fuzz")?;
    let seeds = "run --package peelnet_tests --example write_seeds";
    run(cargo().args(seeds.split(' ')), "seeds")?;
    for target in FUZZ_TARGETS {
        println!("\n== {target}, {seconds} s");
        let mut command = Command::new("cargo");
        command.args(["+nightly", "fuzz", "run", target, "--"]);
        command.arg(format!("-max_total_time={seconds}"));
        // A dictionary of what the formats say, little memory, and no input that takes long.
        command.args(["-dict=fuzz/formats.dict", "-rss_limit_mb=1024"]);
        command.args(["-timeout=10", "-print_final_stats=1"]);
        run(&mut command, target)?;
    }
    Ok(())
}
