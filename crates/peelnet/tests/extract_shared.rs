//! `extract --shard`, `extract --resume` and `seal`: processes that share one dataset.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::SCENE as ONE_VIEW;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Two views of the scene.
fn scene() -> String {
    format!("{ONE_VIEW}[orbit]\nviews = 2\n")
}

fn command(line: &str, worker: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_peelnet"));
    command.args(line.split_whitespace()).current_dir(folder);
    command.args(["--json", "--adapter", "software"]);
    command.env("PEELNET_WORKER", worker);
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    }
    command
}

fn json(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn run(line: &str, worker: &str, folder: &Path) -> Value {
    json(&command(line, worker, folder).output().unwrap())
}

fn fails(line: &str, worker: &str, folder: &Path) -> String {
    let output = command(line, worker, folder).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{line}");
    assert!(output.stdout.is_empty(), "{line}");
    String::from_utf8(output.stderr).unwrap()
}

fn has(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

/// Shards of two processes at once, the same scene under another path, another number of shards for what is missing: one hash.
#[test]
fn shards_of_processes_are_the_whole() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), scene()).unwrap();
    std::fs::create_dir(folder.join("elsewhere")).unwrap();
    std::fs::write(folder.join("elsewhere/s.toml"), scene()).unwrap();
    let line = "extract s.toml --size 32x24 --augment 2 --out";
    let whole = run(&format!("{line} whole"), "one", folder);
    assert_eq!(whole["sealed"], true);
    let parts = whole["parts"].as_u64().unwrap();
    assert!(parts >= 6, "{parts} parts");

    let moved = line.replace("s.toml", "elsewhere/s.toml");
    let children: Vec<_> = [(line, 1), (&moved, 2)]
        .into_iter()
        .map(|(line, k)| {
            command(
                &format!("{line} d --shard {k}/3"),
                &format!("node-{k}"),
                folder,
            )
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
        })
        .collect();
    for child in children {
        let answer = json(&child.wait_with_output().unwrap());
        assert_eq!(answer["sealed"], false);
    }
    has(
        &fails("inspect d", "one", folder),
        &["2 of 6 parts are missing", "--resume", "peelnet seal"],
    );
    has(
        &fails("seal d", "one", folder),
        &["2 of 6 parts are missing"],
    );
    // Without the third shard: what is missing is done by two others.
    run(&format!("{line} d --shard 1/2"), "node-3", folder);
    let last = run(&format!("{line} d --resume"), "node-4", folder);
    assert_eq!(last["sealed"], true);
    assert_eq!(last["hash"], whole["hash"]);
    assert!(last["parts_written"].as_u64().unwrap() <= 2);
    let sealed = run("seal d", "one", folder);
    assert_eq!(sealed["hash"], whole["hash"]);
    assert_eq!(sealed["rows"], whole["rows"]);
    run("inspect d", "one", folder);
    let nothing = run(&format!("{line} d --resume"), "node-5", folder);
    assert_eq!(nothing["parts_written"], 0);
    assert_eq!(nothing["hash"], whole["hash"]);
}

#[test]
fn another_command_line_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), scene()).unwrap();
    run(
        "extract s.toml --size 16x12 --out d --shard 1/2",
        "node-a",
        folder,
    );
    let changed = scene().replace("[camera]", "# another text\n[camera]");
    std::fs::write(folder.join("t.toml"), &changed).unwrap();
    for (line, words) in [
        (
            "extract s.toml --size 16x16 --out d --shard 2/2",
            "size is 16x12",
        ),
        (
            "extract s.toml --size 16x12 --seed 9 --out d --resume",
            "seed is 1",
        ),
        (
            "extract s.toml --size 16x12 --max-passes 2 --out d --resume",
            "limit of passes is all",
        ),
        (
            "extract s.toml --size 16x12 --views 1 --out d --resume",
            "list of cameras is",
        ),
        ("extract t.toml --size 16x12 --out d --resume", "scene 0 is"),
        (
            "extract s.toml --size 16x12 --format npy --out d --shard 2/2",
            "format is parquet",
        ),
        (
            "extract --synthetic 100 --out d --resume",
            "adapter class is software",
        ),
    ] {
        let message = fails(line, "node-b", folder);
        has(
            &message,
            &[words, "node-a", "node-b", "use the same command"],
        );
        assert_eq!(
            message.lines().filter(|l| l.starts_with("error")).count(),
            1
        );
    }
    // Other paths, other words: the same plan.
    std::fs::rename(folder.join("s.toml"), folder.join("t.toml")).unwrap();
    let last = run(
        "extract t.toml --seed 1 --out d --size 16x12 --shard 2/2",
        "node-b",
        folder,
    );
    assert_eq!(last["sealed"], true);
}

#[test]
fn synthetic_lists_are_resumed() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    let line = "extract --synthetic 3000 --seed 4 --out";
    let whole = run(&format!("{line} a"), "one", folder);
    run(&format!("{line} b --resume"), "one", folder);
    let remove = |name: &str| std::fs::remove_file(folder.join("b").join(name)).unwrap();
    remove("_peelnet/manifest.json");
    remove("_peelnet/parts/00001.json");
    remove("fragments-00001-synthetic-v1.parquet");
    has(
        &fails("train b --out m", "one", folder),
        &["1 of 3 parts are missing", "the first is 1"],
    );
    let rest = run(&format!("{line} b --resume"), "two", folder);
    assert_eq!(rest["parts_written"], 1);
    assert_eq!(rest["hash"], whole["hash"]);
}
