//! The program itself: exit codes and one-line errors for wrong usage and bad files. Nothing here needs a GPU.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::path::Path;
use std::process::{Command, Output};

fn peelnet(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_peelnet"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let dir = tempfile::tempdir().unwrap();
    for line in [
        "",
        "no-such-command",
        "extract --out d",
        "extract a.toml",
        "extract a.toml --out d --size 0x4",
        "extract a.toml --out d --size big",
        "extract a.toml --out d --views 0",
        "extract a.toml --out d --pixels 2",
        "extract a.toml --out d --shard 5/4",
        "extract a.toml --out d --format xml",
        "extract a.toml --out d --peel onion",
        "train d --out m --recipe huge",
        "train d --out m --loss-curve loss.png",
        "train d --out m --epochs 0",
        "train d --out m --lr -1",
        "export m --out w --lang cuda",
        "export m --out w --lang glsl",
        "export m --out w --precision f16",
        "render a.toml --out a.gif",
        "render a.toml --out a.png --method wbiot",
        "render a.toml --out a.png --method abuffer:speed=9",
        "doctor --frobnicate",
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(&arguments, dir.path());
        assert_eq!(output.status.code(), Some(2), "{line}: {}", stderr(&output));
        assert!(output.stdout.is_empty(), "{line}");
        assert!(!output.stderr.is_empty(), "{line}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn help_and_version_go_to_stdout() {
    let dir = tempfile::tempdir().unwrap();
    for line in [
        "--help",
        "--version",
        "help extract",
        "run --help",
        "doctor --help",
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(&arguments, dir.path());
        assert_eq!(output.status.code(), Some(0), "{line}");
        assert!(
            !output.stdout.is_empty() && output.stderr.is_empty(),
            "{line}"
        );
    }
    let help = peelnet(&["extract", "--help"], dir.path());
    let text = String::from_utf8(help.stdout).unwrap();
    assert!(
        text.contains("Examples:") && text.contains("--adapter"),
        "{text}"
    );
}

/// Each: exit code 1, one line that begins with `error: ` and names the file, nothing on stdout, no file left.
#[test]
fn bad_files_are_exit_code_1_and_one_line() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    file("empty.toml", "");
    file("key.toml", "name = \"a\"\nspeed = 3\n");
    file("not-toml.toml", "= = =\n");
    file("empty.safetensors", "");
    file("text.safetensors", "this is not a model");
    std::fs::create_dir(dir.path().join("folder")).unwrap();
    let before = std::fs::read_dir(dir.path()).unwrap().count();
    for (line, named) in [
        ("render missing.toml --out a.png", "missing.toml"),
        ("render key.toml --out a.png", "key.toml"),
        ("render not-toml.toml --out a.png", "not-toml.toml"),
        ("extract empty.toml --out d", "empty.toml"),
        ("run missing.toml --out o", "missing.toml"),
        ("inspect missing", "missing"),
        ("inspect folder", "folder"),
        ("inspect key.toml", "key.toml"),
        ("inspect text.safetensors", "text.safetensors"),
        (
            "export missing.safetensors --out w.wgsl",
            "missing.safetensors",
        ),
        ("export empty.safetensors --out w.wgsl", "empty.safetensors"),
        ("train folder --out m.safetensors", "folder"),
        ("train missing --out m.safetensors", "missing"),
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(&arguments, dir.path());
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        assert!(output.stdout.is_empty(), "{line}");
        let errors: Vec<&str> = text
            .lines()
            .filter(|l| !l.starts_with("warning: "))
            .collect();
        assert_eq!(errors.len(), 1, "{line}: {text}");
        assert!(
            errors[0].starts_with("error: ") && errors[0].contains(named),
            "{line}: {text}"
        );
        assert_eq!(
            std::fs::read_dir(dir.path()).unwrap().count(),
            before,
            "{line}"
        );
    }
}

#[test]
fn a_file_of_unknown_kind_is_wrong_usage() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("a.txt"), "x").unwrap();
    let output = peelnet(&["inspect", "a.txt"], dir.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("a.txt"));
}

/// With or without a driver, `doctor --json` is JSON, and its exit code says whether an adapter can be used.
#[test]
fn doctor_answers_in_json() {
    let dir = tempfile::tempdir().unwrap();
    let output = peelnet(&["doctor", "--json"], dir.path());
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let usable = answer["used"].is_string();
    assert_eq!(output.status.code(), Some(i32::from(!usable)));
    assert_eq!(
        answer["install"].is_string(),
        answer["adapters"] == serde_json::json!([])
    );
}

/// An adapter that does not exist: the error lists those that do.
#[test]
fn an_unknown_adapter_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let output = peelnet(&["doctor", "--adapter", "abacus 3000"], dir.path());
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("error: "));
}
