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
  test            formatting, clippy, all tests, documentation: what CI runs
  ci              the same as test
  peers           the training comparison with PyTorch (installs it from PyPI into target/)
";

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let rest: Vec<&str> = args.iter().skip(1).map(String::as_str).collect();
    let result = match (args.first().map(String::as_str), rest.as_slice()) {
        (Some("demo"), []) => demo(false),
        (Some("demo"), ["--full"]) => demo(true),
        (Some("test" | "ci"), []) => test(),
        (Some("peers"), []) => run(
            Command::new("python3").arg("benches/peers/train.py"),
            "peers",
        ),
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

fn demo(full: bool) -> Result<(), String> {
    ensure_driver()?;
    let out = if full { "out/full" } else { "out/demo" };
    let mut command = cargo();
    command.args([
        "run",
        "--release",
        "--package",
        "peelnet",
        "--",
        "run",
        "--out",
        out,
    ]);
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

fn test() -> Result<(), String> {
    ensure_driver()?;
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
    let installed = apt(&["update", "-qq"])
        .and_then(|()| apt(&[["install", "-y", "-qq"].as_slice(), &PACKAGES].concat()));
    match installed {
        Ok(()) if driver_exists() => Ok(()),
        Ok(()) => Err(format!("apt-get installed no Vulkan driver; {how}")),
        Err(e) => Err(format!("{e}; {how}")),
    }
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
