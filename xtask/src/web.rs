//! The viewer's page: `cargo xtask web`.

use crate::{Outcome, captured, command, root, run, start, suites::npm_ci, target_folder};
use std::{
    env, fs,
    path::{Path, PathBuf},
};

pub const TARGET: &str = "wasm32-unknown-unknown";
/// What a page is to weigh on the line at most, bytes.
const MOST: u64 = 3_000_000;

pub fn web() -> Outcome {
    compile("cargo rustc --package peelnet_view --lib --crate-type cdylib")?;
    let wasm = target_folder().join(TARGET).join("web/peelnet_view.wasm");
    // The file is packed, too.
    let folder = page(&wasm, "crates/peelnet_view/web/index.html", "out/web", "")?;
    sizes(&folder)?;
    // The example of the package for three.js, a page of its own.
    npm_ci("packages/three")?;
    let mut example = command("npm --prefix packages/three run example --");
    start(example.arg(folder.join("three")))
}

/// The page of the Bevy plugin, with `index.html`, in a folder.
pub fn bevy_page() -> Result<PathBuf, String> {
    compile("cargo build --manifest-path bevy/Cargo.toml --ignore-rust-version --example page")?;
    let target =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("bevy/target"), Into::into);
    let wasm = target.join(TARGET).join("web/examples/page.wasm");
    let folder = page(&wasm, "bevy/web/index.html", "out/bevy-page", "--unpacked")?;
    // Five minutes less than what packs for a network.
    run(&format!(
        "gzip -9f {}",
        folder.join("page_bg.wasm").display()
    ))?;
    Ok(folder)
}

/// Compiles for pages, with the profile `web`.
fn compile(line: &str) -> Outcome {
    let mut build = command(line);
    build.args(["--profile", "web", "--target", TARGET]);
    let line = format!("rustc --print target-libdir --target {TARGET}");
    let libraries = captured(&mut command(&line))?;
    let libraries = String::from_utf8_lossy(&libraries);
    if !fs::read_dir(libraries.trim()).is_ok_and(|mut files| files.next().is_some()) {
        if env::var_os("RUSTC_BOOTSTRAP").is_none() {
            return Err(format!(
                "the compiler has no standard library for {TARGET}: rustup target add {TARGET}"
            ));
        }
        // A compiler without the target's library, and with its source: it is compiled along, which needs unstable flags.
        build.arg("-Zbuild-std=std,panic_abort");
    }
    start(&mut build)
}

/// Puts a page into a folder: its `index.html`, a wasm file, and the JavaScript beside that, by a program of ours, whose profile and lock file are
/// its own.
fn page(wasm: &Path, index: &str, folder: &str, more: &str) -> Result<PathBuf, String> {
    let into = root().join(folder);
    fs::create_dir_all(&into).map_err(|e| format!("{}: {e}", into.display()))?;
    let mut glue = command("cargo run --quiet --manifest-path xtask/glue/Cargo.toml --target-dir");
    glue.arg(target_folder().join("glue")).arg("--").arg(wasm);
    start(glue.arg(folder).args(more.split_whitespace()))?;
    fs::copy(root().join(index), into.join("index.html")).map_err(|e| format!("{index}: {e}"))?;
    Ok(into)
}

fn sizes(folder: &Path) -> Outcome {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    paths.sort();
    let mut all = 0;
    for path in paths.iter().filter(|p| p.is_file()) {
        let raw = fs::metadata(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let packed = match path.extension().is_some_and(|e| e == "gz") {
            true => raw.len(),
            false => captured(command("gzip -9 -c").arg(path))?.len() as u64,
        };
        all += packed;
        let path = path.display();
        println!("{path}: {} bytes, {packed} gzipped", raw.len());
    }
    println!("all: {all} bytes gzipped; the goal is {MOST}");
    Ok(())
}
