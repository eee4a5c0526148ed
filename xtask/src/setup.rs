//! What a fresh machine lacks: a Vulkan driver, a browser, subcommands of cargo.

use crate::{cargo, run};
use std::{env, ffi::OsStr, path::Path, process::Command};

/// Makes sure that a subcommand of cargo is there.
pub fn ensure_subcommand(name: &str) -> Result<(), String> {
    ensure(cargo().args([name, "--version"]), &format!("cargo-{name}"))
}

/// Makes sure that a program is there that cargo can install.
pub fn ensure_program(name: &str) -> Result<(), String> {
    ensure(Command::new(name).arg("--version"), name)
}

fn ensure(version: &mut Command, package: &str) -> Result<(), String> {
    if version.output().is_ok_and(|o| o.status.success()) {
        return Ok(());
    }
    println!("{package} is not installed: cargo install {package} --locked");
    run(cargo().args(["install", package, "--locked"]), "install")
}

/// Makes sure that a Vulkan driver is there: installs Mesa's software rasteriser through apt where none is and apt
/// exists, saying so; elsewhere says what to do.
pub fn ensure_driver() -> Result<(), String> {
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
pub fn apt_install(packages: &[&str]) -> Result<(), String> {
    let is_root = Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|o| o.stdout.trim_ascii() == b"0");
    // Its pages of output are shown only where it fails.
    let apt = |args: &[&str]| {
        let mut words: Vec<&OsStr> = Vec::new();
        if !is_root {
            words.push("sudo".as_ref());
        }
        words.push("apt-get".as_ref());
        words.extend(args.iter().map(|a| -> &OsStr { a.as_ref() }));
        let output = Command::new(words[0])
            .args(&words[1..])
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(std::process::Stdio::inherit())
            .output()
            .map_err(|e| format!("apt-get cannot be started: {e}"))?;
        if output.status.success() {
            return Ok(());
        }
        eprint!("{}", String::from_utf8_lossy(&output.stdout));
        eprint!("{}", String::from_utf8_lossy(&output.stderr));
        Err(format!("apt-get failed ({})", output.status))
    };
    apt(&["update", "-qq"])?;
    apt(&[["install", "-y", "-qq"].as_slice(), packages].concat())
}

/// Makes sure that a browser is there for the test of the report: installs Chromium through apt where none is and apt exists,
/// saying so. Elsewhere the test itself says what it needs.
pub fn ensure_browser() -> Result<(), String> {
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
