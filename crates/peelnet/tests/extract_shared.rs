//! `extract --shard`, `extract --resume` and `seal`: processes that share one dataset. Plans that differ are refused in `command_line.rs`.

use crate::common::{Folder, SCENE};
use std::process::Stdio;

fn fails(folder: &Folder, line: &str, words: &[&str]) {
    let text = folder.says(line, 1);
    assert_eq!(text.matches("error: ").count(), 1, "{line}: {text}");
    for word in words {
        assert!(text.contains(word), "{line}: {word:?} is not in: {text}");
    }
}

/// Shards of two processes at once, the same scene under another path, another number of shards for what is missing: one hash.
#[test]
fn shards_of_processes_are_the_whole() {
    let scene = format!("{SCENE}[orbit]\nviews = 2\n");
    let folder = Folder::new(&[("s.toml", &scene), ("elsewhere/s.toml", &scene)]);
    let line = "extract s.toml --size 32x24 --augment 2 --pixels 0.5 --out";
    let whole = folder.json(&format!("{line} whole"));
    let found = (&whole["sealed"], &whole["parts"]);
    assert_eq!(found, (&true.into(), &6.into()));
    let moved = line.replace("s.toml", "elsewhere/s.toml");
    let children = [(line, 1), (&moved, 2)].map(|(line, k)| {
        let mut command = folder.command(&format!("{line} d --shard {k}/3 --json"));
        command.env("PEELNET_WORKER", format!("node-{k}"));
        command.stdout(Stdio::piped()).spawn().unwrap()
    });
    for child in children {
        let output = child.wait_with_output().unwrap();
        let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["sealed"], false);
    }
    let missing = ["2 of 6 parts are missing", "--resume", "peelnet seal"];
    fails(&folder, "inspect d", &missing);
    fails(&folder, "seal d", &missing[..1]);
    // Without the third shard: what is missing is done by two others.
    folder.prints(&format!("{line} d --shard 1/2"));
    let last = folder.json(&format!("{line} d --resume"));
    assert_eq!(last["sealed"], true);
    assert!(last["parts_written"].as_u64().unwrap() <= 2);
    let sealed = folder.json("seal d");
    assert_eq!(sealed["rows"], whole["rows"]);
    folder.prints("inspect d");
    let nothing = folder.json(&format!("{line} d --resume"));
    assert_eq!(nothing["parts_written"], 0);
    for answer in [last, sealed, nothing] {
        assert_eq!(answer["hash"], whole["hash"]);
    }
}

#[test]
fn synthetic_lists_are_resumed() {
    let folder = Folder::new(&[]);
    let line = "extract --synthetic 3000 --seed 4 --out";
    let whole = folder.json(&format!("{line} a"));
    folder.prints(&format!("{line} b --resume"));
    for name in [
        "b/_peelnet/manifest.json",
        "b/_peelnet/parts/00001.json",
        "b/fragments-00001-synthetic-v1.parquet",
    ] {
        std::fs::remove_file(folder.at(name)).unwrap();
    }
    let missing = ["1 of 3 parts are missing", "the first is 1"];
    fails(&folder, "train b --out m", &missing);
    let rest = folder.json(&format!("{line} b --resume"));
    assert_eq!(rest["parts_written"], 1);
    assert_eq!(rest["hash"], whole["hash"]);
}
