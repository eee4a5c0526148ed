//! The program away from its sources: shipped scenes and networks are part of it.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::path::Path;
use std::process::Command;

/// Runs a copy of the program that lies alone in `folder`, and returns its stdout.
fn installed(folder: &Path, arguments: &str) -> String {
    let program = folder.join(format!("peelnet{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        std::fs::copy(env!("CARGO_BIN_EXE_peelnet"), &program).unwrap();
    }
    let output = Command::new(&program)
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn an_installed_program_finds_its_scenes_and_networks() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    installed(
        folder,
        "render cups --method deep-medium --size 64x48 --out cups.png",
    );
    installed(
        folder,
        "render data/scenes/cups.toml --method deep-medium --size 64x48 --out same.png",
    );
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert_eq!(read("cups.png"), read("same.png"));
    let rows = installed(
        folder,
        "bench cups-held --methods wboit-eq9,deep-large --size 64x48 --views 1 --frames 0 --out bench --json",
    );
    assert!(rows.contains("deep-large"), "{rows}");
    let vase = installed(folder, "inspect data/effects/vase.toml --json");
    assert!(vase.contains("vase"), "{vase}");
    let stress = installed(
        folder,
        "stress --methods deep-anchored-small:targets=f16 --cases coplanar --json",
    );
    assert!(stress.contains("deep-anchored-small"), "{stress}");
    installed(
        folder,
        "run cups cups-held --size 64x48 --rows 2000 --epochs 1 --out out",
    );
    assert!(folder.join("out/report.html").is_file());
}
