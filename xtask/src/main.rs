//! The commands of a fresh machine: `cargo xtask demo` and `cargo xtask test` do everything, set-up included.
//!
//! Only the standard library is used, so that this compiles in a second before anything else does.

use std::{
    env,
    ffi::OsStr,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
    time::{Duration, Instant},
};

const HELP: &str = "\
cargo xtask <command>

  demo [--full]   peel the shipped scenes, train, export, render, compare; ends with a report in out/demo
                  (--full: the thesis's full size, 1.5 M rows and 150 epochs, into out/full)
  train-models    makes the shipped networks again, in models/ (about 20 minutes on two cores; data in out/models)
  test            formatting, clippy, all tests, documentation: what CI runs
  ci              test, and cargo-deny: licences, advisories, sources, versions
  search          a million random fragment lists for every property (minutes)
  faults          extract, train and bench killed fifty times each (minutes)
  fuzz [SECONDS]  each fuzz target for so long (default 1800), on nightly Rust; installs cargo-fuzz where it is missing
  peers           training against PyTorch, transparency against VTK and pygfx (installed from PyPI into out/peers)
";

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let rest: Vec<&str> = args.iter().skip(1).map(String::as_str).collect();
    let result = match (args.first().map(String::as_str), rest.as_slice()) {
        (Some("demo"), []) => demo(false),
        (Some("demo"), ["--full"]) => demo(true),
        (Some("train-models"), []) => train_models(),
        (Some("test"), []) => test(),
        (Some("ci"), []) => test().and_then(|()| deny()),
        (Some("search"), []) => again("PROPTEST_CASES", "1000000", "peelnet_core", "random_lists"),
        (Some("faults"), []) => {
            ensure_driver().and_then(|()| again("PEELNET_KILLS", "50", "peelnet", "faults"))
        }
        (Some("fuzz"), []) => fuzz("1800"),
        (Some("fuzz"), [seconds]) => fuzz(seconds),
        (Some("peers"), []) => ["train", "transparency"].into_iter().try_for_each(|name| {
            run(
                Command::new("python3").arg(format!("benches/peers/{name}.py")),
                "peers",
            )
        }),
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

/// The workspace's root: this package's parent.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command in the root with its output shown.
fn run(command: &mut Command, name: &str) -> Result<(), String> {
    // Graphics libraries complain on stderr where this is not set, as in containers.
    if env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", env::temp_dir());
    }
    let status = command
        .current_dir(root())
        .status()
        .map_err(|e| format!("{name}: cannot start {:?}: {e}", command.get_program()))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{name} failed ({status})"))
    }
}

/// The release build of `peelnet`, with these arguments.
fn peelnet(args: &[&str]) -> Command {
    let mut command = cargo();
    command
        .args(["run", "--release", "--quiet", "--package", "peelnet", "--"])
        .args(args);
    command
}

fn demo(full: bool) -> Result<(), String> {
    ensure_driver()?;
    let out = if full { "out/full" } else { "out/demo" };
    let mut command = peelnet(&["run", "--out", out]);
    if full {
        command.arg("--full");
    }
    run(&mut command, "demo")?;
    println!(
        "\nThe report: {}",
        root().join(out).join("report.html").display()
    );
    Ok(())
}

/// Recipes that learn from synthetic lists and peeled scenes together.
const PIXEL_RECIPES: [&str; 5] = ["small", "medium", "large", "nmt", "dfaoit"];

/// Makes everything in `models/` from the shipped scenes and the seed.
fn train_models() -> Result<(), String> {
    ensure_driver()?;
    let step = |args: &[&str]| {
        println!("\n== peelnet {}", args.join(" "));
        run(&mut peelnet(args), args[0])
    };
    // What an earlier run left would be in the way of extraction.
    let _ = std::fs::remove_dir_all(root().join("out/models"));
    let scenes = scene_files()?;
    let (synthetic, peeled) = ("out/models/synthetic", "out/models/peeled");
    step(&["extract", "--synthetic", "600000", "--out", synthetic])?;
    let mut peel = vec!["extract"];
    peel.extend(scenes.iter().map(String::as_str));
    // Many small views teach more than few large ones.
    peel.extend(["--size", "256x192", "--augment", "5", "--pixels", "0.12"]);
    peel.extend(["--out", peeled]);
    step(&peel)?;
    step(&["run", "--full", "--out", "out/models/thesis"])?;
    finish("thesis", &["out/models/thesis/dataset"], &["--resume"])?;
    for recipe in PIXEL_RECIPES {
        finish(recipe, &[synthetic, peeled], &[])?;
    }
    println!(
        "\nmodels/ is complete; compare with: cargo run --release -- bench data/scenes/*-held.toml --out out/bench"
    );
    Ok(())
}

/// Trains a recipe in `out/models` and puts the model, its text and its figures into `models`.
fn finish(recipe: &str, data: &[&str], more: &[&str]) -> Result<(), String> {
    let made = format!("out/models/{recipe}/model.safetensors");
    let shipped = root().join("models").join(recipe);
    let io = |e: std::io::Error| format!("models/{recipe}: {e}");
    std::fs::create_dir_all(root().join(format!("out/models/{recipe}"))).map_err(io)?;
    std::fs::create_dir_all(&shipped).map_err(io)?;
    let mut args = vec!["train"];
    args.extend(data);
    args.extend(["--recipe", recipe, "--out", &made, "--json"]);
    args.extend(more);
    println!("\n== peelnet {}", args.join(" "));
    let output = peelnet(&args)
        .current_dir(root())
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|e| format!("train: {e}"))?;
    if !output.status.success() {
        return Err(format!("training {recipe} failed ({})", output.status));
    }
    let text = format!("models/{recipe}/model.wgsl");
    println!("== peelnet export {made} --out {text}");
    run(&mut peelnet(&["export", &made, "--out", &text]), "export")?;
    std::fs::write(shipped.join("metrics.json"), output.stdout).map_err(io)?;
    std::fs::copy(root().join(made), shipped.join("model.safetensors")).map_err(io)?;
    Ok(())
}

/// The shipped scenes, relative to the root, in the order of their names.
fn scene_files() -> Result<Vec<String>, String> {
    let folder = root().join("data/scenes");
    let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<String> = entries
        .flatten()
        .filter_map(|e| e.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .map(|name| format!("data/scenes/{name}"))
        .collect();
    files.sort();
    Ok(files)
}

/// One test file again, at the length that an environment variable asks for, its output shown.
fn again(variable: &str, value: &str, package: &str, test: &str) -> Result<(), String> {
    let args = [
        "test",
        "--package",
        package,
        "--test",
        test,
        "--",
        "--nocapture",
    ];
    run(cargo().args(args).env(variable, value), test)
}

/// Whether a subcommand of cargo is there; installs it where it is not.
fn ensure_subcommand(name: &str) -> Result<(), String> {
    let there = cargo().args([name, "--version"]).output();
    if there.is_ok_and(|o| o.status.success()) {
        return Ok(());
    }
    println!("cargo-{name} is not installed: cargo install cargo-{name} --locked");
    run(
        cargo().args(["install", &format!("cargo-{name}"), "--locked"]),
        "install",
    )
}

/// Licences, sources and versions; advisories where their database can be reached.
fn deny() -> Result<(), String> {
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

/// Every fuzz target for so many seconds, one after the other; a finding ends it and lies in fuzz/artifacts.
fn fuzz(seconds: &str) -> Result<(), String> {
    ensure_subcommand("fuzz")?;
    run(
        cargo().args([
            "run",
            "--package",
            "peelnet_tests",
            "--example",
            "write_seeds",
        ]),
        "seeds",
    )?;
    for target in FUZZ_TARGETS {
        println!("\n== {target}, {seconds} s");
        // A dictionary of what the formats say, little memory, and no input that takes long.
        let limit = format!("-max_total_time={seconds}");
        let dictionary = "-dict=fuzz/formats.dict";
        let options = [
            &limit,
            dictionary,
            "-rss_limit_mb=1024",
            "-timeout=10",
            "-print_final_stats=1",
        ];
        let mut command = Command::new("cargo");
        command
            .args(["+nightly", "fuzz", "run", target, "--"])
            .args(options);
        run(&mut command, target)?;
    }
    Ok(())
}

/// One for each reader of files that users hand over.
const FUZZ_TARGETS: [&str; 5] = ["scene", "obj", "gltf", "dataset", "model"];

fn test() -> Result<(), String> {
    ensure_driver()?;
    ensure_browser()?;
    let nextest = cargo()
        .args(["nextest", "--version"])
        .output()
        .is_ok_and(|o| o.status.success());
    let tests: &[&str] = if nextest {
        &["nextest", "run", "--workspace", "--no-fail-fast"]
    } else {
        println!(
            "cargo-nextest is not installed: using cargo test (cargo install cargo-nextest runs tests side by side)"
        );
        &["test", "--workspace", "--lib", "--bins", "--tests"]
    };
    let steps: [(&str, &[&str]); 5] = [
        ("formatting", &["fmt", "--all", "--check"]),
        ("tests", tests),
        (
            "documentation examples",
            &["test", "--workspace", "--doc", "--quiet"],
        ),
        (
            "clippy",
            &[
                "clippy",
                "--workspace",
                "--all-targets",
                "--",
                "-D",
                "warnings",
            ],
        ),
        (
            "documentation",
            &["doc", "--workspace", "--no-deps", "--quiet"],
        ),
    ];
    let mut times: Vec<(&str, Duration)> = Vec::new();
    let mut result = Ok(());
    for (name, args) in steps {
        println!("\n== {name}: cargo {}", args.join(" "));
        let start = Instant::now();
        result = run(cargo().args(args).env("RUSTDOCFLAGS", "-D warnings"), name);
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

/// Makes sure that a Vulkan driver is there: installs Mesa's software rasteriser through apt where none is and apt
/// exists, saying so; elsewhere tells what to do.
fn ensure_driver() -> Result<(), String> {
    if !cfg!(target_os = "linux") || driver_exists() {
        return Ok(());
    }
    const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];
    let how = format!(
        "install your GPU vendor's Vulkan driver, or Mesa's software rasteriser (packages {})",
        PACKAGES.join(", ")
    );
    if !Path::new("/usr/bin/apt-get").exists() {
        return Err(format!("no Vulkan driver is installed; {how}"));
    }
    println!(
        "No Vulkan driver is installed: installing Mesa's software rasteriser with apt-get ({}).",
        PACKAGES.join(", ")
    );
    match apt_install(&PACKAGES) {
        Ok(()) if driver_exists() => Ok(()),
        Ok(()) => Err(format!("apt-get installed no Vulkan driver; {how}")),
        Err(e) => Err(format!("{e}; {how}")),
    }
}

/// Installs packages, as root or through sudo.
fn apt_install(packages: &[&str]) -> Result<(), String> {
    let is_root = Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|o| o.stdout.trim_ascii() == b"0");
    let apt = |args: &[&str]| {
        let mut words: Vec<&OsStr> = Vec::new();
        if !is_root {
            words.push("sudo".as_ref());
        }
        words.push("apt-get".as_ref());
        words.extend(args.iter().map(|a| -> &OsStr { a.as_ref() }));
        run(
            Command::new(words[0])
                .args(&words[1..])
                .env("DEBIAN_FRONTEND", "noninteractive"),
            "apt-get",
        )
    };
    apt(&["update", "-qq"])?;
    apt(&[["install", "-y", "-qq"].as_slice(), packages].concat())
}

/// Makes sure that a browser is there for the test of the report: installs Chromium through apt where none is and apt exists,
/// saying so. Elsewhere the test itself says what it needs.
fn ensure_browser() -> Result<(), String> {
    let found = ["chromium", "chromium-browser", "google-chrome", "chrome"]
        .into_iter()
        .any(|name| {
            Command::new(name)
                .arg("--version")
                .output()
                .is_ok_and(|o| o.status.success())
        });
    if found || !Path::new("/usr/bin/apt-get").exists() {
        return Ok(());
    }
    println!(
        "No Chromium is installed: installing it with apt-get (chromium), for the test of the report."
    );
    apt_install(&["chromium"])
}

/// Whether the Vulkan loader and at least one driver's manifest are in the places that the loader searches.
fn driver_exists() -> bool {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"]
        .into_iter()
        .filter_map(env::var_os)
        .any(|list| env::split_paths(&list).any(|file| file.exists()));
    let manifest = [
        "/usr/share/vulkan/icd.d",
        "/etc/vulkan/icd.d",
        "/usr/local/share/vulkan/icd.d",
    ]
    .iter()
    .filter_map(|d| std::fs::read_dir(d).ok())
    .flatten()
    .flatten()
    .any(|f| f.path().extension().is_some_and(|e| e == "json"));
    let loader = Command::new("ldconfig")
        .arg("-p")
        .output()
        .or_else(|_| Command::new("/sbin/ldconfig").arg("-p").output())
        // Where there is no ldconfig the manifests must do.
        .map_or(true, |o| {
            String::from_utf8_lossy(&o.stdout).contains("libvulkan.so.1")
        });
    (named || manifest) && loader
}
