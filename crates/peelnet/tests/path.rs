//! `peelnet bench --path`, and `--samples`.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{SCENE, ends_with, peelnet};
use serde_json::Value;

/// Every file is there, a row for each method and one for each of its frames; exact compositing has no error, and hardware blending of one
/// wall in front of another one is exact, too. A second run replaces the files of the first.
#[test]
fn a_path_is_measured() {
    let dir = tempfile::tempdir().unwrap();
    let second = "[[object]]\nmesh = { shape = \"quad\", size = [1, 1] }\ntranslate = [0.2, 0.1, -0.5]\n[object.material]\n\
        color = [0.1, 0.8, 0.1]\nalpha = 0.5\n";
    std::fs::write(dir.path().join("s.toml"), format!("{SCENE}{second}")).unwrap();
    let line = "bench s.toml --path --frames 3 --size 24x16 --methods abuffer,depth-peel,weighted-sum --out out --json";
    for _ in 0..2 {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(dir.path(), &arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{message}");
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rows = answer["rows"].as_array().unwrap();
        let methods: Vec<&str> = rows.iter().map(|r| r["method"].as_str().unwrap()).collect();
        assert_eq!(methods, ["depth-peel", "weighted-sum"]);
        assert_eq!(answer["by_frame"].as_array().unwrap().len(), 6);
        assert_eq!(rows[0]["jod"], 10.0);
        assert!(rows[0]["mse_linear"].as_f64().unwrap() < 1e-10);
        assert!(rows[1]["jod"].as_f64().unwrap() < 10.0);
        assert!(rows[1]["change"].as_f64().unwrap() > 0.0);
        assert_eq!(rows[0]["contour_pairs"], 0.0);
        assert!(rows[1]["contour_pairs"].is_number());
        let frames = answer["by_frame"].as_array().unwrap();
        assert!(frames[0]["change"].is_null() && !frames[1]["change"].is_null());
    }
    for name in [
        "path.json",
        "path.csv",
        "path-frames.csv",
        "path.md",
        "path-error.svg",
        "path-change.svg",
        "report.html",
    ] {
        assert!(dir.path().join("out").join(name).exists(), "{name}");
    }
    let strip = image_size(&dir.path().join("out/images/two-weighted-sum.png"));
    // Three frames side by side and that of the largest change, errors above changes.
    assert_eq!(strip, [4 * 24, 2 * 16]);
    assert_eq!(
        image_size(&dir.path().join("out/images/two-abuffer.png")),
        [3 * 24, 16]
    );
}

/// Width and height of a PNG file, from its header.
fn image_size(path: &std::path::Path) -> [u32; 2] {
    let bytes = std::fs::read(path).unwrap();
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
fn paths_that_cannot_be_measured() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), SCENE).unwrap();
    let text = ends_with(dir.path(), "bench s.toml --path --frames 0 --out out", 2);
    assert!(text.contains("at least one frame"), "{text}");
    let long = "bench s.toml --path --frames 1000 --methods abuffer --out out";
    let text = ends_with(dir.path(), long, 1);
    assert!(
        text.contains("1000 frames of 1024x768") && text.contains("--size"),
        "{text}"
    );
}

/// A frame of four samples says so in text and JSON, with the fragments of all samples.
#[test]
fn samples_are_drawn_and_reported() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), SCENE).unwrap();
    let render = |samples: &str| -> Value {
        let line =
            format!("render s.toml --out {samples}.npy --size 32x24 --samples {samples} --json");
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(dir.path(), &arguments);
        assert!(output.status.success());
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (one, four) = (render("1"), render("4"));
    assert_eq!(
        (one["samples"].as_u64(), four["samples"].as_u64()),
        (Some(1), Some(4))
    );
    let fragments = |v: &Value| v["fragments"].as_f64().unwrap();
    // Four times as many, but for those along the edges.
    let ratio = fragments(&four) / fragments(&one);
    assert!((3.5..=4.5).contains(&ratio), "{ratio}");
    let bench =
        "bench s.toml --out out --size 16x12 --frames 1 --samples 4 --methods mboit4 --json";
    let arguments: Vec<&str> = bench.split_whitespace().collect();
    let output = peelnet(dir.path(), &arguments);
    assert!(output.status.success());
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        answer["rows"]
            .as_array()
            .unwrap()
            .iter()
            .all(|r| r["samples"] == 4)
    );
}
