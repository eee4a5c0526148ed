//! The suites that `cargo xtask test` leaves out: other compilers, languages and programs, and searches that take long.

use crate::{
    Outcome, answers,
    checks::Step,
    command,
    product::Program,
    program, program_in_root, root, run,
    setup::{apt_install, ensure, ensure_browser, ensure_driver, ensure_subcommand},
    start, target_folder, web,
};
use std::{
    env,
    path::{Path, PathBuf},
};

/// Every suite by its command, the quickest first; some commands take arguments as well.
pub const SUITES: [Step; 12] = [
    ("docs", || {
        ensure("mdbook --version", "mdbook")?;
        run("mdbook build docs")
    }),
    ("deny", deny),
    ("wasm", wasm),
    ("languages", languages),
    ("python", || python("test,ray,readers")),
    ("faults", || {
        again("PEELNET_KILLS", "50", "peelnet --test all -- faults::")
    }),
    ("search", || {
        let tests = "peelnet_tests --test all -- random_lists";
        again("PROPTEST_CASES", "1000000", tests)
    }),
    ("fuzz", || fuzz("60")),
    ("three", || {
        npm("packages/three", &[])?;
        npm("packages/engines", &[])
    }),
    ("bevy", bevy),
    ("view-test", || view(&[])),
    ("cluster", || cluster(&[])),
];

/// The suite of a command without arguments.
pub fn find(name: &str) -> Option<fn() -> Outcome> {
    let suite = SUITES.iter().find(|(known, _)| *known == name);
    suite.map(|(_, run)| *run)
}

/// Training and its gradients against PyTorch, transparency against other renderers.
pub fn peers() -> Outcome {
    run("python3 benches/peers/train.py")?;
    let python = python_of("out/peers/venv");
    let test = "--lib gradients_are_pytorchs -- --ignored";
    let mut test = command(&format!("cargo test --release -p peelnet_train {test}"));
    start(test.env("PEELNET_PYTORCH", python))?;
    run("python3 benches/peers/transparency.py")
}

/// The Bevy plugin, a workspace of its own: its lints and tests, its comparison against the exact image, and a page in Chromium.
fn bevy() -> Outcome {
    ensure_driver()?;
    // The crate declares the compiler that Bevy asks for. Older ones compile it, down to that of this workspace.
    const BEVY: &str = "--manifest-path bevy/Cargo.toml --ignore-rust-version";
    run("cargo fmt --check --manifest-path bevy/Cargo.toml")?;
    run(&format!("cargo clippy {BEVY} --all-targets -- -D warnings"))?;
    run(&format!("cargo test {BEVY} --no-fail-fast"))?;
    run(&format!(
        "cargo run {BEVY} --example compare -- --out out/bevy"
    ))?;
    // In a browser, which the package for three.js starts.
    ensure_browser()?;
    npm_ci("packages/three")?;
    let folder = web::bevy_page()?;
    start(command("node --test bevy/web/page.test.mjs").env("PEELNET_PAGE", folder))
}

/// Compiles what a page in a browser needs, without linking it: peeling and training wait and write files.
fn wasm() -> Outcome {
    let crates = "-p peelnet_core -p peelnet_scene -p peelnet_model -p peelnet_render -p peelnet_export \
                  -p peelnet_bench -p peelnet_view";
    let target = web::TARGET;
    run(&format!("cargo check --target {target} {crates}"))
        .map_err(|e| format!("{e}; where the target is missing: rustup target add {target}"))
}

/// Installs what a package of npm in this folder needs.
pub fn npm_ci(folder: &str) -> Outcome {
    run(&format!("npm --prefix {folder} ci --no-audit --no-fund"))
}

/// Installs and tests a package of npm in this folder.
fn npm(folder: &str, more: &[(&str, &Path)]) -> Outcome {
    ensure_browser()?;
    npm_ci(folder)?;
    let mut test = command(&format!("npm --prefix {folder} test"));
    start(test.envs(more.iter().copied()))
}

/// The exported texts, by the compilers that renderers use.
fn languages() -> Outcome {
    if !answers("glslangValidator --version") {
        apt_install("glslang-tools").map_err(|e| {
            format!("{e}; install glslangValidator, of the Khronos Group's glslang")
        })?;
    }
    run("python3 benches/languages.py")
}

/// Tests again, at the length that an environment variable asks for, their output shown.
fn again(variable: &str, value: &str, tests: &str) -> Outcome {
    ensure_driver()?;
    let mut command = command(&format!("cargo test --package {tests} --nocapture"));
    start(command.env(variable, value))
}

/// Commands as a whole and every fuzz target for so many seconds, one after the other; a finding ends it and lies in fuzz/artifacts.
pub fn fuzz(seconds: &str) -> Outcome {
    println!("\n== commands, {seconds} s");
    let commands = "peelnet --test all -- fuzzed_commands::";
    again("PEELNET_FUZZ_SECONDS", seconds, commands)?;
    ensure_subcommand("fuzz")?;
    run("cargo run --package peelnet_tests --example write_seeds")?;
    // One for each reader of files that users hand over.
    for target in [
        "scene", "obj", "gltf", "ply", "stl", "texture", "dataset", "model", "results", "splat",
        "spz",
    ] {
        // Errors of memory, with what finding them takes; then what an input of less than 1 MB may take: 256 MB and a second. A scene file
        // may ask for a million generated triangles.
        let few = match target {
            "scene" => "-rss_limit_mb=1024 -timeout=10 -max_len=1000000",
            _ => "-rss_limit_mb=256 -timeout=1 -max_len=1000000",
        };
        for (sanitizer, limits) in [("address", "-rss_limit_mb=1024 -timeout=10"), ("none", few)] {
            println!("\n== {target}, sanitizer {sanitizer}, {seconds} s");
            // A dictionary of what the formats say. A toolchain is named to the rustup's cargo only.
            let line = format!(
                "+nightly fuzz run --sanitizer {sanitizer} {target} -- -max_total_time={seconds} \
                 -dict=fuzz/formats.dict {limits} -print_final_stats=1"
            );
            start(&mut program_in_root("cargo", &line))?;
        }
    }
    Ok(())
}

/// The viewer as people see it, all steps or those that are named: the window under a display of its own, driven by pointer and keys; the page
/// in headless Chromium, against native pictures. PEELNET_BINARY is a program that is built already, PEELNET_PAGE the folder of a page.
pub fn view(names: &[&str]) -> Outcome {
    if let Some(unknown) = names.iter().find(|n| !["window", "page"].contains(n)) {
        return Err(format!("view-test has no step {unknown}: window, page"));
    }
    let Program(binary) = Program::given_or_built("view")?;
    let is_asked = |name: &str| names.is_empty() || names.contains(&name);
    if is_asked("window") {
        println!("\n== window");
        let tools = ["Xvfb", "xdotool", "import"];
        if tools.iter().any(|tool| !answers(&format!("which {tool}"))) {
            apt_install("xvfb xdotool imagemagick")?;
        }
        // What files are dragged from. Where it cannot be had, the script names it.
        if !Path::new("/usr/lib/python3/dist-packages/gi").exists() {
            apt_install("python3-gi gir1.2-gtk-3.0")?;
        }
        start(command("python3 benches/window.py --binary").arg(&binary))?;
    }
    if is_asked("page") {
        println!("\n== page");
        if env::var_os("PEELNET_PAGE").is_none() {
            web::web()?;
        }
        npm("crates/peelnet_view/web", &[("PEELNET_BINARY", &binary)])?;
    }
    Ok(())
}

/// The Python package in `python/`: lints, the package with these extras built and installed as pip does it, and its tests.
pub fn python(extras: &str) -> Outcome {
    ensure_driver()?;
    let python = installed(extras)?;
    run("cargo fmt --check --manifest-path python/Cargo.toml")?;
    let mut clippy =
        command("cargo clippy --locked --manifest-path python/Cargo.toml -- -D warnings");
    clippy.env("CARGO_TARGET_DIR", target_folder());
    start(clippy.env("PYO3_PYTHON", &python))?;
    // What its pictures, rows and errors are compared with.
    run("cargo build --package peelnet")?;
    let mut tests = program_in_root(&python, "-m pytest python/tests");
    start(tests.env("PEELNET", program("debug")))
}

/// Lints of the templates in deploy/; datasets and models in an object store, against an S3 server on this machine; then Ray with two nodes on it,
/// killed in the middle of its work.
pub fn cluster(rest: &[&str]) -> Outcome {
    ensure_driver()?;
    let python = installed("cluster")?;
    for lint in [
        "shellcheck deploy/slurm-array.sh",
        "hadolint deploy/Containerfile",
        "kubernetes-validate --strict deploy/kubernetes-indexed-job.yaml",
    ] {
        println!("\n== {lint}");
        let (tool, arguments) = lint.split_once(' ').unwrap_or_default();
        start(&mut program_in_root(python.with_file_name(tool), arguments))?;
    }
    println!("\n== object store");
    run("cargo build --package peelnet --features object-store")?;
    let mut store = program_in_root(&python, "tests/object_store.py");
    start(store.arg(program("debug")))?;
    println!("\n== Ray");
    // Ray asks for addresses that other machines reach; a network namespace has none but its own, and two runs do not meet.
    let mut ray = command("unshare --map-root-user --net sh -c");
    ray.arg("ip link set lo up && exec \"$0\" python/cluster/run.py \"$@\"");
    ray.arg(&python).args(rest);
    start(ray.env("RAY_USAGE_STATS_ENABLED", "0"))
}

/// The interpreter of a virtual environment.
fn python_of(folder: &str) -> PathBuf {
    root().join(folder).join(match cfg!(windows) {
        true => "Scripts/python.exe",
        false => "bin/python",
    })
}

/// The Python of `target/python`, with the package and these of its extras in it.
fn installed(extras: &str) -> Result<PathBuf, String> {
    let python = python_of("target/python");
    if !python.exists() {
        let maker = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
        println!("making a virtual environment in target/python");
        let made = start(&mut program_in_root(maker, "-m venv target/python"));
        made.map_err(|e| format!("{e}; PYTHON names another Python, 3.10 or later"))?;
    }
    let install = format!("-m pip install --quiet --upgrade ./python[{extras}]");
    let mut pip = program_in_root(&python, &install);
    // The same profile as clippy and the program here, so that crates are compiled once.
    pip.env("CARGO_TARGET_DIR", target_folder());
    start(pip.env("MATURIN_PEP517_ARGS", "--profile dev")).map(|()| python)
}

/// Licences, sources and versions; advisories where their database can be reached.
pub fn deny() -> Outcome {
    ensure_subcommand("deny")?;
    run("cargo deny check licenses bans sources")?;
    run("cargo deny fetch db").map_err(|e| {
        format!("{e}: the database of advisories cannot be reached, they are not checked")
    })?;
    run("cargo deny check advisories")
}
