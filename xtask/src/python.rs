//! The Python package in `python/`, in a virtual environment of its own.

use crate::setup::ensure_driver;
use crate::{cargo, program, root, run};
use std::{env, path::PathBuf, process::Command};

/// Lints, the package built and installed as pip does it, and its tests.
pub fn python(with_ray: bool) -> Result<(), String> {
    ensure_driver()?;
    // Pip builds with MATURIN_PEP517_ARGS: the same profile as clippy and the program here, so that crates are compiled once.
    let extras = if with_ray { "test,ray" } else { "test" };
    let python = installed(extras)?;
    for (name, args, more) in [
        ("formatting", &["fmt", "--check"][..], &[][..]),
        ("clippy", &["clippy", "--locked"], &["--", "-D", "warnings"]),
    ] {
        println!("\n== {name} of python: cargo {}", args.join(" "));
        let mut command = cargo();
        command
            .args(args)
            .args(["--manifest-path", "python/Cargo.toml"])
            .args(more)
            .env("CARGO_TARGET_DIR", root().join("target"))
            .env("PYO3_PYTHON", &python);
        run(&mut command, name)?;
    }
    // What its pictures, rows and errors are compared with.
    run(cargo().args(["build", "--package", "peelnet"]), "peelnet")?;
    println!("\n== tests of python: pytest");
    let mut tests = Command::new(&python);
    tests
        .args(["-m", "pytest", "python/tests"])
        .env("PEELNET", program("debug"));
    run(&mut tests, "pytest")
}

/// Lints of the templates in deploy/; datasets and models in an object store, against an S3 server on this machine; then Ray with two nodes on it, killed in the middle of its work.
pub fn cluster(rest: &[&str]) -> Result<(), String> {
    ensure_driver()?;
    let python = installed("cluster")?;
    println!("\n== templates");
    for lint in [
        "shellcheck deploy/slurm-array.sh",
        "hadolint deploy/Containerfile",
        "kubernetes-validate --strict deploy/kubernetes-indexed-job.yaml",
    ] {
        let mut words = lint.split(' ');
        let tool = python.with_file_name(words.next().unwrap_or_default());
        run(Command::new(tool).args(words), lint)?;
    }
    println!("\n== object store");
    let build = "build --package peelnet --features object-store";
    run(cargo().args(build.split(' ')), "peelnet")?;
    let mut store = Command::new(&python);
    let tests = "tests/object_store.py";
    run(store.arg(tests).arg(program("debug")), tests)?;
    println!("\n== Ray");
    // Ray asks for addresses that other machines reach; a network namespace has none but its own, and two runs do not meet.
    let script = "ip link set lo up && exec \"$0\" python/cluster/run.py \"$@\"";
    let mut command = Command::new("unshare");
    command
        .args(["--map-root-user", "--net", "sh", "-c", script])
        .arg(&python)
        .args(rest)
        .env("RAY_USAGE_STATS_ENABLED", "0");
    run(&mut command, "cluster")
}

/// The Python of `target/python`, with the package and these of its extras in it.
fn installed(extras: &str) -> Result<PathBuf, String> {
    let folder = root().join("target/python");
    let python = folder.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    });
    if !python.exists() {
        let maker = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
        println!("making a virtual environment in target/python");
        let made = run(
            Command::new(maker).args(["-m", "venv"]).arg(&folder),
            "python3 -m venv",
        );
        made.map_err(|e| format!("{e}; PYTHON names another Python, 3.10 or later"))?;
    }
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--upgrade"])
        .arg(format!("./python[{extras}]"))
        .env("CARGO_TARGET_DIR", root().join("target"))
        .env("MATURIN_PEP517_ARGS", "--profile dev");
    run(&mut pip, "pip install ./python").map(|()| python)
}
