//! What a fresh machine lacks: a Vulkan driver, a browser, subcommands of cargo.

use crate::{Outcome, answers, captured, command, run};
use std::{env, path::Path, process::Output};

pub fn ensure_subcommand(name: &str) -> Outcome {
    ensure(&format!("cargo {name} --version"), &format!("cargo-{name}"))
}

/// Makes sure that a program of a package is there that cargo can install.
pub fn ensure(version: &str, package: &str) -> Outcome {
    if answers(version) {
        return Ok(());
    }
    println!("{package} is not installed: cargo install {package} --locked");
    run(&format!("cargo install {package} --locked"))
}

/// Makes sure that a Vulkan driver is there: installs Mesa's software rasteriser through apt where none is and apt
/// exists, saying so; elsewhere says what to do.
pub fn ensure_driver() -> Outcome {
    if !cfg!(target_os = "linux") || driver_exists() {
        return Ok(());
    }
    const PACKAGES: &str = "mesa-vulkan-drivers libvulkan1";
    let how = format!(
        "no Vulkan driver is installed; install your GPU vendor's, or Mesa's software rasteriser (packages {PACKAGES})"
    );
    if !Path::new("/usr/bin/apt-get").exists() {
        return Err(how);
    }
    println!("No Vulkan driver is installed: installing Mesa's software rasteriser.");
    match apt_install(PACKAGES) {
        Ok(()) if driver_exists() => Ok(()),
        Ok(()) => Err(how),
        Err(e) => Err(format!("{e}; {how}")),
    }
}

/// Installs packages with apt-get, as root or through sudo, and says so.
pub fn apt_install(packages: &str) -> Outcome {
    println!("apt-get install {packages}");
    let is_root = captured(&mut command("id -u")).is_ok_and(|id| id.trim_ascii() == b"0");
    let sudo = if is_root { "" } else { "sudo" };
    // Its pages of output are shown only where it fails.
    for line in ["update -qq", &format!("install -y -qq {packages}")] {
        let mut apt = command(&format!("{sudo} apt-get {line}"));
        let output = apt.env("DEBIAN_FRONTEND", "noninteractive").output();
        let output = output.map_err(|e| format!("apt-get cannot be started: {e}"))?;
        if !output.status.success() {
            eprint!("{}", String::from_utf8_lossy(&output.stdout));
            eprint!("{}", String::from_utf8_lossy(&output.stderr));
            return Err(format!("apt-get failed ({})", output.status));
        }
    }
    Ok(())
}

/// Makes sure that a browser is there: installs Chromium through apt where none is and apt exists, saying so. Elsewhere the test itself says
/// what it needs.
pub fn ensure_browser() -> Outcome {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let mut versions = names.iter().map(|name| format!("{name} --version"));
    if versions.any(|line| answers(&line)) || !Path::new("/usr/bin/apt-get").exists() {
        return Ok(());
    }
    println!("No Chromium is installed.");
    apt_install("chromium")
}

/// Whether the Vulkan loader and at least one driver's manifest are in the places that the loader searches.
fn driver_exists() -> bool {
    let lists = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].map(env::var_os);
    let exists = |list| env::split_paths(list).any(|file| file.exists());
    let named = lists.iter().flatten().any(exists);
    let folders = ["/usr/share", "/etc", "/usr/local/share"];
    let folders = folders.map(|d| std::fs::read_dir(format!("{d}/vulkan/icd.d")));
    let mut files = folders.into_iter().flatten().flatten().flatten();
    let manifest = files.any(|f| f.path().extension().is_some_and(|e| e == "json"));
    let mut lines = ["ldconfig -p", "/sbin/ldconfig -p"].into_iter();
    let output = lines.find_map(|line| command(line).output().ok());
    let has = |o: Output| String::from_utf8_lossy(&o.stdout).contains("libvulkan.so.1");
    // Where there is no ldconfig the manifests must do.
    (named || manifest) && output.is_none_or(has)
}
