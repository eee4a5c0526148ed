//! Outputs never destroy: links and devices are written through, foreign files and inputs are refused, and all of that is known before
//! work begins.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{SCENE, ends_with, everything, peelnet};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// A folder with a scene, a shipped network's file, and a small dataset.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("two.toml"), SCENE).unwrap();
    let model = peelnet::Model::shipped(peelnet::Recipe::SMALL).unwrap();
    model.save(dir.path().join("m.safetensors")).unwrap();
    dir
}

#[cfg(unix)]
#[test]
fn links_and_devices_are_written_through() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    std::os::unix::fs::symlink("far.png", at("link.png")).unwrap();
    std::os::unix::fs::symlink("/dev/full", at("full.png")).unwrap();
    let render = "render two.toml --size 8x8 --out";
    ends_with(dir.path(), &format!("{render} link.png"), 0);
    assert!(
        std::fs::symlink_metadata(at("link.png"))
            .unwrap()
            .is_symlink()
    );
    assert!(image::open(at("far.png")).is_ok());
    ends_with(dir.path(), &format!("{render} /dev/null"), 0);
    assert!(!Path::new("/dev/null").is_file());
    for full in ["/dev/full", "full.png"] {
        let text = ends_with(dir.path(), &format!("{render} {full}"), 1);
        assert!(text.contains(full), "{text}");
    }
    assert!(
        std::fs::symlink_metadata(at("full.png"))
            .unwrap()
            .is_symlink()
    );
}

/// The file alone goes to stdout, the result to stderr; no file is called `-`.
#[test]
fn a_hyphen_is_stdout() {
    let dir = folder();
    ends_with(dir.path(), "extract --synthetic 300 --out d", 0);
    let before = everything(dir.path());
    for (line, start) in [
        ("render two.toml --size 8x8 --out -", &b"\x89PNG"[..]),
        ("render two.toml --size 8x8 --json --out -", b"\x89PNG"),
        ("export m.safetensors --out -", b"// A learned weight"),
        ("train d --epochs 1 --recipe small --out -", b""),
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(dir.path(), &arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {said}");
        assert!(output.stdout.starts_with(start), "{line}");
        assert!(!said.is_empty(), "{line}");
        if line.starts_with("train") {
            assert!(peelnet::Model::from_bytes(&output.stdout, "stdout").is_ok());
        }
    }
    for line in [
        "extract two.toml --out -",
        "bench two.toml --out -",
        "stress --out -",
        "run two.toml --out -",
    ] {
        let text = ends_with(dir.path(), line, 2);
        assert!(text.contains("name a folder"), "{text}");
    }
    assert_eq!(everything(dir.path()), before);
}

#[test]
fn inputs_and_foreign_files_are_refused_and_forced() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let extract = "extract two.toml --size 16x12 --format csv --out d";
    ends_with(dir.path(), extract, 0);
    std::fs::write(at("notes.png"), "a user's own").unwrap();
    std::fs::hard_link(at("two.toml"), at("hard.png")).unwrap();
    let part = std::fs::read_dir(at("d")).unwrap();
    let names = part.map(|e| e.unwrap().file_name().into_string().unwrap());
    let part = names.into_iter().find(|n| n.ends_with(".csv")).unwrap();
    let before = everything(dir.path());
    for (line, code) in [
        ("export m.safetensors --out m.safetensors", 2),
        ("export m.safetensors --out ./d/../m.safetensors", 2),
        ("export m.safetensors --out two.toml", 1),
        ("render two.toml --size 8x8 --out notes.png", 1),
        ("render two.toml --size 8x8 --out hard.png", 2),
        ("train d --epochs 1 --out d/_peelnet/manifest.json", 2),
        (
            &*format!("train d --epochs 1 --out n --loss-curve d/{part}"),
            2,
        ),
        ("train d --epochs 1 --out n.svg --loss-curve n.svg", 2),
        ("train d --epochs 1 --out two.toml", 1),
    ] {
        let text = ends_with(dir.path(), line, code);
        assert!(
            text.starts_with("error: --") && text.lines().count() == 1,
            "{line}: {text}"
        );
        assert_eq!(everything(dir.path()), before, "{line}");
    }
    ends_with(
        dir.path(),
        "render two.toml --size 8x8 --out notes.png --force",
        0,
    );
    let said = ends_with(dir.path(), "render two.toml --size 8x8 --out notes.png", 0);
    assert!(
        said.contains("replacing notes.png (a PNG image of peelnet)"),
        "{said}"
    );
}

/// Our own image, which may be replaced elsewhere, is a texture of the scene that is drawn.
#[test]
fn files_that_a_scene_reads_are_inputs() {
    let dir = folder();
    ends_with(dir.path(), "render two.toml --size 8x8 --out cut.png", 0);
    std::fs::create_dir_all(dir.path().join("b/images")).unwrap();
    std::fs::copy(
        dir.path().join("cut.png"),
        dir.path().join("b/images/c.png"),
    )
    .unwrap();
    for (texture, scene) in [("cut.png", "cut.toml"), ("b/images/c.png", "c.toml")] {
        let textured = format!("{SCENE}color_map = \"{texture}\"\n");
        std::fs::write(dir.path().join(scene), textured).unwrap();
    }
    let before = everything(dir.path());
    for (line, file) in [
        ("render cut.toml --size 8x8 --out cut.png", "cut.png"),
        (
            "bench c.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b",
            "c.png",
        ),
    ] {
        let text = ends_with(dir.path(), line, 2);
        let why = "which a scene of this command reads";
        assert!(text.contains(file) && text.contains(why), "{line}: {text}");
        assert_eq!(everything(dir.path()), before, "{line}");
    }
    ends_with(
        dir.path(),
        "render cut.toml --size 8x8 --out cut.png --force",
        0,
    );
}

/// Each of the files of a measurement is looked at, and nothing was measured before.
#[test]
fn a_folder_is_ours_by_its_content() {
    let dir = folder();
    let out = dir.path().join("out");
    std::fs::create_dir_all(out.join("images")).unwrap();
    let bench = "bench two.toml --methods wboit-eq9 --frames 0 --size 8x8 --out out";
    for name in [
        "report.html",
        "results.json",
        "results.csv",
        "table.md",
        "pareto.svg",
        "images/holiday.png",
    ] {
        std::fs::write(out.join(name), "a user's own").unwrap();
        let text = ends_with(dir.path(), bench, 1);
        assert!(text.contains(name) && text.contains("--force"), "{text}");
        // The folder of pictures, and the file.
        assert_eq!(everything(&out).len(), 2, "{name}");
        std::fs::remove_file(out.join(name)).unwrap();
    }
    ends_with(dir.path(), bench, 0);
    let said = ends_with(dir.path(), bench, 0);
    assert!(
        said.contains("replacing out/") && said.contains("more files"),
        "{said}"
    );
}

/// Nothing is trained or drawn for an output that cannot be written.
#[test]
fn outputs_are_checked_before_work_begins() {
    let dir = folder();
    ends_with(dir.path(), "extract --synthetic 300 --out d", 0);
    std::fs::write(dir.path().join("file"), "x").unwrap();
    std::fs::create_dir(dir.path().join("old.checkpoint")).unwrap();
    for (name, text) in [
        ("old.checkpoint/last.safetensors", "a user's own"),
        ("Cargo.lock", "version = 4"),
    ] {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let before = everything(dir.path());
    for (line, named) in [
        ("train d --epochs 1 --out old", "last.safetensors"),
        ("train d --epochs 1 --out Cargo", "Cargo.lock"),
    ] {
        let text = ends_with(dir.path(), line, 1);
        assert!(text.contains(named), "{line}: {text}");
        assert_eq!(everything(dir.path()), before, "{line}");
    }
    for line in [
        "train d --epochs 1 --out m2 --loss-curve file/loss.csv",
        "train d --epochs 1 --out file/m2",
        "stress --cases deep --methods wboit-eq9 --out file",
        "bench --scaling --out file/out",
        "bench --effects --out file",
        "extract two.toml --out file",
        "run two.toml --out file",
    ] {
        let text = ends_with(dir.path(), line, 1);
        let last = text.lines().last().unwrap_or_default();
        assert!(
            last.starts_with("error: --") && last.contains("file"),
            "{line}: {text}"
        );
        assert_eq!(text.lines().count(), 1, "{line}: {text}");
        assert_eq!(everything(dir.path()), before, "{line}");
    }
}

/// Two seconds are promised; the deadline here only ends a test that would hang.
#[cfg(unix)]
#[test]
fn signals_end_every_command() {
    let dir = folder();
    ends_with(dir.path(), "extract --synthetic 3000 --out d", 0);
    let before = everything(dir.path());
    for (line, signal, code) in [
        (
            "render sixteen-050 --size 4096x4096 --out a.png",
            "INT",
            130,
        ),
        ("inspect vase --time", "TERM", 143),
        ("stress --out s", "TERM", 143),
        ("bench sixteen-050 --out b", "INT", 130),
        (
            "train d --epochs 1000000 --recipe small --out n",
            "INT",
            130,
        ),
    ] {
        let child = Command::new(env!("CARGO_BIN_EXE_peelnet"))
            .args(line.split_whitespace())
            .current_dir(dir.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Long enough that the handler is there, short enough that no command has finished.
        std::thread::sleep(std::time::Duration::from_millis(400));
        let id = child.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(sent.unwrap().success());
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}: {text}");
        assert!(text.contains("interrupted"), "{line}: {text}");
        let left = everything(dir.path());
        // What a training resumes from, and folders that stay empty.
        let ours = |p: &Path| p.starts_with("n.checkpoint") || dir.path().join(p).is_dir();
        let before: BTreeMap<_, _> = before.iter().filter(|(p, _)| !ours(p)).collect();
        let left: BTreeMap<_, _> = left.iter().filter(|(p, _)| !ours(p)).collect();
        assert_eq!(left, before, "{line}");
    }
}
