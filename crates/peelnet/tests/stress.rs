//! `peelnet stress` as its user sees it: exit codes, rows, pictures of what fails.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::path::Path;
use std::process::{Command, Output};

fn peelnet(line: &str, folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_peelnet"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn rows(output: &Output) -> Vec<serde_json::Value> {
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    answer["rows"].as_array().unwrap().clone()
}

/// Peeling that stops after a layer covers too little: not declared, so it fails, with the value, the place and pictures.
#[test]
fn a_failure_is_exit_code_1_with_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let line = "stress --methods depth-peel:passes=1,abuffer --cases deep,empty --out o --json";
    let output = peelnet(line, dir.path());
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains(" not hold; pictures of them are in o/images"),
        "{text}"
    );
    let rows = rows(&output);
    let failed: Vec<_> = rows.iter().filter(|r| r["result"] == "fail").collect();
    assert!(!failed.is_empty());
    for row in &failed {
        assert_eq!(
            (&row["method"], &row["case"]),
            (&"depth-peel:passes=1".into(), &"deep".into())
        );
        assert!(row["value"].as_f64().unwrap() > row["limit"].as_f64().unwrap());
        assert!(row["place"].as_str().unwrap().contains("pixel"));
    }
    let pictures = std::fs::read_dir(dir.path().join("o/images")).unwrap();
    assert_eq!(pictures.count(), 2, "what failed, and the exact image");
    for name in ["stress.json", "stress.csv", "stress.md", "stress.html"] {
        let text = std::fs::read_to_string(dir.path().join("o").join(name)).unwrap();
        assert!(text.contains("depth-peel:passes=1"), "{name}");
    }
}

/// A network of one's own is judged alone, in both precisions, and declared flaws that it does not have are no failures.
#[test]
fn a_network_of_ones_own_is_judged_alone() {
    let dir = tempfile::tempdir().unwrap();
    let model =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/anchored-small/model.safetensors");
    std::fs::copy(model, dir.path().join("m.safetensors")).unwrap();
    let line = "stress --model m.safetensors --cases coplanar,half-float --json";
    let output = peelnet(line, dir.path());
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mut methods: Vec<String> = rows(&output)
        .iter()
        .map(|r| r["method"].to_string())
        .collect();
    methods.dedup();
    methods.sort();
    methods.dedup();
    assert_eq!(
        methods,
        [
            "\"deep-anchored-small:targets=f16\"",
            "\"deep-anchored-small:targets=f32\""
        ]
    );
}

#[test]
fn an_unknown_case_is_wrong_usage() {
    let dir = tempfile::tempdir().unwrap();
    let output = peelnet("stress --cases shallow", dir.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("alpha-zero, alpha-tiny"));
}
