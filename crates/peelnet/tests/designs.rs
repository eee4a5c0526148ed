//! `peelnet bench --designs`.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{ends_with, peelnet};
use serde_json::Value;
use std::path::Path;

/// Three spheres: up to six layers.
fn scene(name: &str) -> String {
    let mut text = format!(
        "name = \"{name}\"\n[camera]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov_y = 45\nnear = 0.1\nfar = 100\n"
    );
    for (place, color, alpha) in [
        ("[0, 0, 0.4]", "[0.9, 0.1, 0.1]", 0.5),
        ("[0.3, 0.2, 0]", "[0.1, 0.8, 0.1]", 0.4),
        ("[-0.3, 0.1, -0.5]", "[0.1, 0.2, 0.9]", 0.7),
    ] {
        text += &format!(
            "[[object]]\nmesh = {{ shape = \"sphere\" }}\ntranslate = {place}\n[object.material]\ncolor = {color}\nalpha = {alpha}\nlighting = \"unlit\"\n"
        );
    }
    text
}

const DESIGNS: &str = r#"
[training]
epochs = 2
learning_rate = 0.016

[[design]]
name = "small"
ends = [0.15, 0.5, 1.0]
means = [true, true, true]
farthest = [true, false, false]

[[design]]
name = "three"
ends = [0.2, 0.6, 1.0]
means = [true, true, false]
farthest = [true, false, false]
apart = true
hidden = [4]
"#;

fn answer(folder: &Path, line: &str) -> Value {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let output = peelnet(folder, &arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Each design has its row, in the order of the file, and a run replaces the files of an earlier one. Without a network the figures are
/// those of the renderer, which draws the same design with its shaders, within a tenth: colours in 16-bit targets.
#[test]
fn designs_are_measured_as_they_are_drawn() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), scene("spheres")).unwrap();
    std::fs::write(folder.join("f.toml"), DESIGNS).unwrap();
    answer(folder, "extract --synthetic 1000 --out d --json");
    let line = "bench s.toml --designs d --designs-file f.toml --size 96x64 --out o --json";
    answer(folder, line);
    let found = answer(folder, line);
    let rows = found["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|r| r["design"].as_str().unwrap()).collect();
    assert_eq!(names, ["small", "three"]);
    assert_eq!(
        (&rows[0]["bytes"], &rows[1]["bytes"]),
        (&30.into(), &36.into())
    );
    assert_eq!(rows[1]["topology"], "9-4-1");
    assert_eq!(found["epochs"], 2);
    assert_eq!(found["judged_on"][0], "spheres");
    for row in rows {
        assert!(row["seconds"].as_f64().unwrap() > 0.0, "{row}");
        assert_ne!(row["network"], row["middle"], "{row}");
    }
    for name in ["designs.json", "designs.md"] {
        assert!(folder.join("o").join(name).exists(), "{name}");
    }
    let drawn = answer(
        folder,
        "bench s.toml --methods mboit4,kbuffer-4,slabs:keep=small --frames 0 --size 96x64 --out b --json",
    );
    let of = |method: &str, field: &str| -> f64 {
        let mut rows = drawn["rows"].as_array().unwrap().iter();
        let row = rows.find(|r| r["method"] == method).unwrap();
        row[field].as_f64().unwrap()
    };
    let small = of("slabs:keep=small", "mse_linear");
    let middle = &rows[0]["middle"];
    for (field, expected) in [
        ("to_moments", small / of("mboit4", "mse_linear")),
        ("to_kbuffer", small / of("kbuffer-4", "mse_linear")),
        ("contour_pairs", of("slabs:keep=small", "contour_pairs")),
    ] {
        let found = middle[field].as_f64().unwrap();
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{field}: {found}, drawn {expected}"
        );
    }
}

/// A scene that was trained on may not judge, and a wrong file is refused before anything is trained.
#[test]
fn what_cannot_judge_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), scene("spheres")).unwrap();
    std::fs::write(
        folder.join("f.toml"),
        DESIGNS.replace("0.2, 0.6, 1.0", "0.2, 0.6, 0.9"),
    )
    .unwrap();
    answer(folder, "extract s.toml --size 24x16 --out d --json");
    let message = ends_with(folder, "bench s.toml --designs d --out o", 2);
    assert!(
        message.contains("scene 'spheres'") && message.contains("without it"),
        "{message}"
    );
    let line = "bench s.toml --designs d --designs-file f.toml --out o";
    let message = ends_with(folder, line, 1);
    for part in ["f.toml", "design 2 (\"three\")", "must end at 1"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(!folder.join("o").exists());
}
