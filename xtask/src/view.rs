//! The viewer as people see it: `cargo xtask view-test`.

use crate::{
    cargo, program, run,
    setup::{apt_install, ensure_browser, ensure_driver},
    web,
};
use std::{env, path::PathBuf, process::Command};

/// A step of the suite.
type Step = fn() -> Result<(), String>;

/// The steps in their order.
const STEPS: [(&str, Step); 2] = [("window", window), ("page", page)];

/// Runs all steps, or those that are named.
pub fn test(names: &[&str]) -> Result<(), String> {
    let all: Vec<&str> = STEPS.iter().map(|(name, _)| *name).collect();
    if let Some(unknown) = names.iter().find(|name| !all.contains(name)) {
        return Err(format!(
            "view-test has no step {unknown}: {}",
            all.join(", ")
        ));
    }
    for (name, step) in STEPS {
        if names.is_empty() || names.contains(&name) {
            println!("\n== {name}");
            step()?;
        }
    }
    Ok(())
}

/// The program that native pictures are drawn with: PEELNET_BINARY, or one that is built.
fn binary() -> Result<PathBuf, String> {
    if let Some(path) = env::var_os("PEELNET_BINARY") {
        return Ok(path.into());
    }
    let build = "build --release --package peelnet --features view";
    run(cargo().args(build.split(' ')), "peelnet")?;
    Ok(program("release"))
}

/// The window under a display of its own, driven by pointer and keys.
fn window() -> Result<(), String> {
    ensure_driver()?;
    let missing = |tool: &&str| {
        Command::new("which")
            .arg(tool)
            .output()
            .is_ok_and(|o| !o.status.success())
    };
    let tools = ["Xvfb", "xdotool", "import"];
    if tools.iter().any(missing) {
        println!("Xvfb, xdotool or ImageMagick is not installed: installing them with apt-get.");
        apt_install(&["xvfb", "xdotool", "imagemagick"])?;
    }
    // What files are dragged from. Where it cannot be had, the script names it.
    if !std::path::Path::new("/usr/lib/python3/dist-packages/gi").exists() {
        apt_install(&["python3-gi", "gir1.2-gtk-3.0"])?;
    }
    let mut python = Command::new("python3");
    python
        .arg("benches/window.py")
        .arg("--binary")
        .arg(binary()?);
    run(&mut python, "window")
}

/// The page in headless Chromium, against native pictures. PEELNET_PAGE is the folder of a page that is built already.
fn page() -> Result<(), String> {
    ensure_driver()?;
    ensure_browser()?;
    let binary = binary()?;
    if env::var_os("PEELNET_PAGE").is_none() {
        web::web()?;
    }
    for words in [&["ci", "--no-audit", "--no-fund"][..], &["test"]] {
        let mut npm = Command::new("npm");
        npm.args(["--prefix", "crates/peelnet_view/web"])
            .args(words);
        run(npm.env("PEELNET_BINARY", &binary), "npm")?;
    }
    Ok(())
}
