//! `extract --shard`, `extract --resume` and `seal`: processes that share one dataset.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{Folder, SCENE};
use serde_json::Value;
use std::process::{Command, Stdio};

/// Two views of the scene.
fn scene() -> String {
    format!("{SCENE}[orbit]\nviews = 2\n")
}

fn command(folder: &Folder, line: &str, worker: &str) -> Command {
    let mut command = folder.command(&format!("{line} --json --adapter software"));
    command.env("PEELNET_WORKER", worker);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(folder: &Folder, line: &str, worker: &str) -> Value {
    let output = command(folder, line, worker).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {text}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// An error with these words in it.
fn fails(folder: &Folder, line: &str, worker: &str, words: &[&str]) {
    let output = command(folder, line, worker).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{line}");
    let text = String::from_utf8(output.stderr).unwrap();
    let errors = text.lines().filter(|l| l.starts_with("error"));
    assert_eq!(errors.count(), 1, "{line}: {text}");
    for word in words {
        assert!(text.contains(word), "{line}: {word:?} is not in: {text}");
    }
}

/// Shards of two processes at once, the same scene under another path, another number of shards for what is missing: one hash.
#[test]
fn shards_of_processes_are_the_whole() {
    let folder = Folder::new(&[("s.toml", &scene()), ("elsewhere/s.toml", &scene())]);
    let line = "extract s.toml --size 32x24 --augment 2 --out";
    let whole = run(&folder, &format!("{line} whole"), "one");
    assert_eq!(
        (&whole["sealed"], &whole["parts"]),
        (&true.into(), &6.into())
    );
    let moved = line.replace("s.toml", "elsewhere/s.toml");
    let children = [(line, 1), (&moved, 2)].map(|(line, k)| {
        let line = format!("{line} d --shard {k}/3");
        command(&folder, &line, &format!("node-{k}"))
            .spawn()
            .unwrap()
    });
    for child in children {
        let output = child.wait_with_output().unwrap();
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["sealed"], false);
    }
    let missing = ["2 of 6 parts are missing", "--resume", "peelnet seal"];
    fails(&folder, "inspect d", "one", &missing);
    fails(&folder, "seal d", "one", &missing[..1]);
    // Without the third shard: what is missing is done by two others.
    run(&folder, &format!("{line} d --shard 1/2"), "node-3");
    let last = run(&folder, &format!("{line} d --resume"), "node-4");
    assert_eq!(last["sealed"], true);
    assert!(last["parts_written"].as_u64().unwrap() <= 2);
    let sealed = run(&folder, "seal d", "one");
    assert_eq!(sealed["rows"], whole["rows"]);
    run(&folder, "inspect d", "one");
    let nothing = run(&folder, &format!("{line} d --resume"), "node-5");
    assert_eq!(nothing["parts_written"], 0);
    for answer in [last, sealed, nothing] {
        assert_eq!(answer["hash"], whole["hash"]);
    }
}

#[test]
fn another_command_line_is_refused() {
    let changed = scene().replace("[camera]", "# another text\n[camera]");
    let folder = Folder::new(&[("s.toml", &scene()), ("t.toml", &changed)]);
    let extract = "extract s.toml --size 16x12 --out d";
    run(&folder, &format!("{extract} --shard 1/2"), "node-a");
    for (line, words) in [
        (
            "extract s.toml --size 16x16 --out d --shard 2/2",
            "size is 16x12",
        ),
        (&format!("{extract} --seed 9 --resume"), "seed is 1"),
        (
            &format!("{extract} --max-passes 2 --resume"),
            "limit of passes is all",
        ),
        (
            &format!("{extract} --views 1 --resume"),
            "list of cameras is",
        ),
        ("extract t.toml --size 16x12 --out d --resume", "scene 0 is"),
        (
            &format!("{extract} --format npy --shard 2/2"),
            "format is parquet",
        ),
        (
            &format!("{extract} --peel dual --resume"),
            "peeling method is sbuffer",
        ),
        (
            &format!("{extract} --pixels 0.5 --resume"),
            "fraction of pixels is 1",
        ),
        (
            &format!("{extract} --augment 1 --resume"),
            "number of copies is 0",
        ),
        (
            "extract --synthetic 100 --out d --resume",
            "adapter class is software",
        ),
    ] {
        let words = [words, "node-a", "node-b", "use the same command"];
        fails(&folder, line, "node-b", &words);
    }
    // Other paths, other words: the same plan.
    std::fs::rename(folder.at("s.toml"), folder.at("t.toml")).unwrap();
    let line = "extract t.toml --seed 1 --out d --size 16x12 --shard 2/2";
    assert_eq!(run(&folder, line, "node-b")["sealed"], true);
}

#[test]
fn synthetic_lists_are_resumed() {
    let folder = Folder::new(&[]);
    let line = "extract --synthetic 3000 --seed 4 --out";
    let whole = run(&folder, &format!("{line} a"), "one");
    run(&folder, &format!("{line} b --resume"), "one");
    for name in [
        "_peelnet/manifest.json",
        "_peelnet/parts/00001.json",
        "fragments-00001-synthetic-v1.parquet",
    ] {
        std::fs::remove_file(folder.at("b").join(name)).unwrap();
    }
    let missing = ["1 of 3 parts are missing", "the first is 1"];
    fails(&folder, "train b --out m", "one", &missing);
    let rest = run(&folder, &format!("{line} b --resume"), "two");
    assert_eq!(rest["parts_written"], 1);
    assert_eq!(rest["hash"], whole["hash"]);
}
