//! `peelnet run` on a small scene of its own: every file that it promises, and figures that hold for any weights.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str = r#"
name = "three-spheres"
background = [1.0, 1.0, 1.0]

[camera]
position = [0, 0, 4]
target = [0, 0, 0]
up = [0, 1, 0]
fov_y = 45.0
near = 0.1
far = 100.0

[orbit]
views = 2

[[object]]
mesh = { shape = "sphere" }
translate = [0, 0, 0.4]
[object.material]
color = [0.9, 0.1, 0.1]
alpha = 0.5
lighting = "unlit"

[[object]]
mesh = { shape = "sphere" }
translate = [0.3, 0.2, 0]
[object.material]
color = [0.1, 0.8, 0.1]
alpha = 0.4
lighting = "unlit"

[[object]]
mesh = { shape = "sphere" }
translate = [-0.3, 0.1, -0.5]
[object.material]
color = [0.1, 0.2, 0.9]
alpha = 0.7
lighting = "unlit"
"#;

fn peelnet(line: &str, folder: &Path) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_peelnet"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{line}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

#[test]
fn a_run_writes_everything_it_promises() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), SCENE).unwrap();
    let output = peelnet(
        "run s.toml --out o --size 64x48 --rows 4000 --epochs 2 --json",
        dir.path(),
    );
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let out = dir.path().join("o");
    for name in [
        "dataset/_peelnet/manifest.json",
        "dataset-summary.json",
        "dataset-summary.txt",
        "loss.csv",
        "loss.svg",
        "model.safetensors",
        "model.wgsl",
        "images/three-spheres-abuffer.png",
        "images/three-spheres-deep-thesis.png",
        "table.md",
        "results.json",
        "report.html",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let written: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("results.json")).unwrap()).unwrap();
    assert_eq!(written, answer, "--json prints what results.json holds");
    let rows = answer["rows"].as_array().unwrap();
    let of = |method: &str| {
        rows.iter()
            .filter(|r| r["method"] == method)
            .collect::<Vec<_>>()
    };
    for method in ["abuffer", "deep-thesis", "wboit-papakostas", "wboit-eq9"] {
        assert_eq!(of(method).len(), 2, "a row for each view of {method}");
    }
    for row in rows {
        assert!(row["mse_linear"].as_f64().unwrap().is_finite(), "{row}");
        assert_eq!(row["non_finite_pixels"], 0, "{row}");
        assert!(row["fragments"].as_u64().unwrap() > 0, "{row}");
    }
    assert!(of("abuffer").iter().all(|r| r["mse255"] == 0.0));
    assert!(
        of("wboit-eq9")
            .iter()
            .all(|r| r["mse255"].as_f64().unwrap() > 0.0)
    );

    // The run's files are what the other commands take.
    peelnet("inspect o/dataset -q", dir.path());
    peelnet("inspect o/model.safetensors", dir.path());
    peelnet("export o/model.safetensors --out again.wgsl", dir.path());
    assert_eq!(
        std::fs::read(out.join("model.wgsl")).unwrap(),
        std::fs::read(dir.path().join("again.wgsl")).unwrap(),
        "the same model gives the same text"
    );
    peelnet(
        "render s.toml --method deep-thesis --model o/model.safetensors --size 64x48 --out again.png",
        dir.path(),
    );
    assert_eq!(
        std::fs::read(out.join("images/three-spheres-deep-thesis.png")).unwrap(),
        std::fs::read(dir.path().join("again.png")).unwrap(),
        "run and render draw the same picture"
    );
}

/// Synthetic lists, a network from them, its export, and a bench of it against another method: from the command line, end to
/// end.
#[test]
fn a_network_from_synthetic_lists_is_benched() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), SCENE).unwrap();
    peelnet("extract --synthetic 2000 --out d -q", dir.path());
    peelnet(
        "train d --recipe medium --epochs 2 --hidden 4 --out m.safetensors -q",
        dir.path(),
    );
    peelnet("export m.safetensors --out w.wgsl -q", dir.path());
    let output = peelnet(
        "bench s.toml --out o --size 64x48 --frames 2 --methods wboit-eq9,mboit4 --models m.safetensors --json",
        dir.path(),
    );
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = answer["rows"].as_array().unwrap();
    for method in ["abuffer", "wboit-eq9", "mboit4", "deep-medium"] {
        let of: Vec<_> = rows.iter().filter(|r| r["method"] == method).collect();
        assert_eq!(of.len(), 2, "a row for each view of {method}");
        for row in of {
            assert_eq!(row["non_finite_pixels"], 0, "{row}");
            let [least, median, most] =
                ["time_ms_min", "time_ms", "time_ms_p90"].map(|k| row[k].as_f64().unwrap());
            assert!(0.0 < least && least <= median && median <= most, "{row}");
            assert_eq!(row["mse_linear"] == 0.0, method == "abuffer", "{row}");
        }
    }
    // What times are ratios to is always there; a pass that took time has a name.
    let base = rows
        .iter()
        .find(|r| r["method"] == "painter-object:sort=off")
        .unwrap();
    assert!(
        base["time_by_pass"].as_str().unwrap().contains("blend="),
        "{base}"
    );
    for name in [
        "report.html",
        "pareto.svg",
        "pareto-mean.svg",
        "results.csv",
        "table.md",
    ] {
        assert!(dir.path().join("o").join(name).exists(), "{name}");
    }
    assert!(!dir.path().join("o/partial.json").exists());
    // The same rows give the same files again.
    let chart = std::fs::read(dir.path().join("o/pareto.svg")).unwrap();
    std::fs::remove_file(dir.path().join("o/pareto.svg")).unwrap();
    peelnet("bench --redraw --out o -q", dir.path());
    assert_eq!(
        std::fs::read(dir.path().join("o/pareto.svg")).unwrap(),
        chart
    );
    // What is exact is named where nothing bounds it, and what is small where bytes do.
    let named = |flags: &str| {
        let line = format!("recommend s.toml --results o --json {flags}");
        let answer: serde_json::Value =
            serde_json::from_slice(&peelnet(&line, dir.path()).stdout).unwrap();
        answer["method"].as_str().unwrap().to_owned()
    };
    assert_eq!(named(""), "abuffer");
    let small = named("--max-bytes 12");
    assert!(
        ["wboit-eq9", "painter-object:sort=off"].contains(&small.as_str()),
        "{small}"
    );
    let mean = |method: &str| -> f64 {
        rows.iter()
            .filter(|r| r["method"] == method)
            .map(|r| r["mse_linear"].as_f64().unwrap())
            .sum()
    };
    // Three spheres are six layers at most: the anchors alone do better than a fixed weight.
    assert!(mean("deep-medium") < mean("wboit-eq9"));
    for name in [
        "results.json",
        "results.csv",
        "table.md",
        "images/three-spheres-deep-medium.png",
    ] {
        assert!(dir.path().join("o").join(name).is_file(), "{name}");
    }
}
