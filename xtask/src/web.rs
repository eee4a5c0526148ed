//! The viewer's page: `cargo xtask web`.

use crate::{cargo, root, run, target_folder};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

const TARGET: &str = "wasm32-unknown-unknown";
/// The page's own files.
const OWN: &str = "crates/peelnet_view/web";
/// What a page is to weigh on the line at most, bytes.
const MOST: u64 = 3_000_000;

/// Builds the page into out/web.
pub fn web() -> Result<(), String> {
    let target = target_folder();
    let mut build = cargo();
    build.args(["rustc", "--package", "peelnet_view", "--lib"]);
    build.args(["--crate-type", "cdylib", "--profile", "web", "--target"]);
    build.arg(TARGET);
    if !has_std()? {
        // A compiler without the target's library, and with its source: it is compiled along, which needs unstable flags.
        build.arg("-Zbuild-std=std,panic_abort");
    }
    run(&mut build, "the page")?;
    let wasm = target.join(TARGET).join("web/peelnet_view.wasm");
    let into = root().join("out/web");
    fs::create_dir_all(&into).map_err(|e| format!("{}: {e}", into.display()))?;
    glue(&wasm, &into, &target)?;
    let index = root().join(OWN).join("index.html");
    fs::copy(&index, into.join("index.html")).map_err(|e| format!("{}: {e}", index.display()))?;
    sizes(&into)
}

/// Whether the compiler has the standard library of the target.
fn has_std() -> Result<bool, String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(&rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .current_dir(root())
        .output()
        .map_err(|e| format!("{rustc:?} cannot be started: {e}"))?;
    let folder = String::from_utf8_lossy(&output.stdout);
    let found = fs::read_dir(folder.trim()).is_ok_and(|mut files| files.next().is_some());
    if found || env::var_os("RUSTC_BOOTSTRAP").is_some() {
        return Ok(found);
    }
    Err(format!(
        "the compiler has no standard library for {TARGET}: rustup target add {TARGET}"
    ))
}

/// Makes the JavaScript beside the wasm file, and packs the file, with a program of ours.
fn glue(wasm: &Path, into: &Path, target: &Path) -> Result<(), String> {
    let mut command = cargo();
    command.args(["run", "--quiet", "--manifest-path"]);
    command.arg(root().join("xtask/glue/Cargo.toml"));
    // Apart: its profile and its lock file are its own.
    command.arg("--target-dir").arg(target.join("glue"));
    run(command.arg("--").arg(wasm).arg(into), "glue")
}

/// Prints what each file weighs, and on the line where `gzip` is there to tell.
fn sizes(folder: &Path) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    paths.sort();
    let mut all = Some(0);
    for path in paths.iter().filter(|p| p.is_file()) {
        let raw = fs::metadata(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let packed = if path.extension().is_some_and(|e| e == "gz") {
            Some(raw.len())
        } else {
            let packed = Command::new("gzip").args(["-9", "-c"]).arg(path).output();
            let packed = packed.ok().filter(|o| o.status.success());
            packed.map(|o| o.stdout.len() as u64)
        };
        let shown = packed.map_or_else(String::new, |n| format!(", {n} gzipped"));
        println!("{}: {} bytes{shown}", path.display(), raw.len());
        all = all.zip(packed).map(|(a, b)| a + b);
    }
    if let Some(bytes) = all {
        println!("all: {bytes} bytes gzipped; the goal is {MOST}");
    }
    Ok(())
}
