//! `peelnet run`, and its stages as commands, on a small scene: every file that is promised, and figures that hold for any weights.

use crate::common::{Folder, SPHERES, rows_of};
use serde_json::Value;
use std::process::Stdio;
use std::time::Duration;

fn sum(answer: &Value, method: &str, figure: &str) -> f64 {
    let rows = rows_of(answer, method).into_iter();
    rows.map(|row| row[figure].as_f64().unwrap()).sum()
}

#[test]
fn a_run_writes_everything_it_promises() {
    let held_out = SPHERES.replace("\"three-spheres\"", "\"held\"\nheld_out = true");
    let copy = held_out.clone();
    let held_out = held_out.replace("alpha = 0.7", "alpha = 0.6");
    let folder = Folder::new(&[
        ("s.toml", SPHERES),
        ("h.toml", &held_out),
        ("c.toml", &copy),
    ]);
    let said = folder.says(
        "run s.toml c.toml --out c --size 64x48 --rows 4000 --epochs 2",
        1,
    );
    assert!(
        said.contains("'three-spheres' (s.toml) and 'held' (c.toml) show the same"),
        "{said}"
    );
    let answer = folder.json("run s.toml h.toml --out o --size 64x48 --rows 4000 --epochs 2");
    let files = "dataset/_peelnet/manifest.json dataset-summary.json dataset-summary.txt loss.csv loss.svg model.json table.md \
        report.html images/three-spheres-abuffer.png";
    for name in files.split(' ') {
        assert!(folder.at("o").join(name).is_file(), "{name}");
    }
    let curve = String::from_utf8(folder.read("o/loss.csv")).unwrap();
    assert_eq!(curve.lines().count(), 1 + 2, "headings and epochs: {curve}");
    assert!(folder.read("o/loss.svg").starts_with(b"<svg"));
    let written: Value = serde_json::from_slice(&folder.read("o/results.json")).unwrap();
    assert_eq!(written, answer, "--json prints what results.json holds");
    for method in ["abuffer", "deep-thesis", "wboit-papakostas", "wboit-eq9"] {
        assert_eq!(rows_of(&answer, method).len(), 4, "{method}: views");
    }
    for row in answer["rows"].as_array().unwrap() {
        assert!(row["mse_linear"].as_f64().unwrap().is_finite(), "{row}");
        assert_eq!(row["non_finite_pixels"], 0, "{row}");
        assert!(row["fragments"].as_u64().unwrap() > 0, "{row}");
    }
    assert_eq!(sum(&answer, "abuffer", "mse255"), 0.0);
    assert!(sum(&answer, "wboit-eq9", "mse255") > 0.0);

    // The run's files are what the other commands take, and those write and draw the same.
    folder.prints("inspect o/dataset -q");
    folder.prints("inspect o/model.safetensors");
    folder.prints("export o/model.safetensors --out again.wgsl");
    let text = folder.read("o/model.wgsl");
    assert!(text == folder.read("again.wgsl"));
    let learned = "--method deep-thesis --model o/model.safetensors";
    folder.prints(&format!("render s.toml {learned} --size 64x48 --out a.png"));
    let picture = folder.read("o/images/three-spheres-deep-thesis.png");
    assert!(picture == folder.read("a.png"));
}

/// Synthetic lists, a network from them (without a recipe, of medium), its export, and a bench of it
/// against another method.
#[test]
fn a_network_from_synthetic_lists_is_benched() {
    let folder = Folder::new(&[("s.toml", SPHERES)]);
    folder.prints("extract --synthetic 2000 --out d -q");
    folder.prints("train d --epochs 2 --hidden 4 --out m.safetensors -q");
    folder.prints("export m.safetensors --out w.wgsl -q");
    let answer = folder.json(
        "bench s.toml --out o --size 64x48 --frames 2 --methods wboit-eq9,mboit4 --models m.safetensors",
    );
    for method in ["abuffer", "wboit-eq9", "mboit4", "deep-medium"] {
        let rows = rows_of(&answer, method);
        assert_eq!(rows.len(), 2, "a row for each view of {method}");
        for row in rows {
            assert_eq!(row["non_finite_pixels"], 0, "{row}");
            let [least, median, most] =
                ["time_ms_min", "time_ms", "time_ms_p90"].map(|k| row[k].as_f64().unwrap());
            assert!(0.0 < least && least <= median && median <= most, "{row}");
            assert_eq!(row["mse_linear"] == 0.0, method == "abuffer", "{row}");
        }
    }
    // What times are ratios to is always there; a pass that took time has a name.
    let base = rows_of(&answer, "painter-object:sort=off")[0];
    let passes = base["time_by_pass"].as_str().unwrap();
    assert!(passes.contains("blend="), "{base}");
    // Three spheres are six layers at most: the anchors alone do better than a fixed weight.
    let error = |method: &str| sum(&answer, method, "mse_linear");
    assert!(error("deep-medium") < error("wboit-eq9"));
    let files =
        "report.html pareto-mean.svg results.csv table.md images/three-spheres-deep-medium.png";
    for name in files.split(' ') {
        assert!(folder.at("o").join(name).exists(), "{name}");
    }
    assert!(!folder.at("o/partial.json").exists());
    // The same rows give the same files again.
    let chart = folder.read("o/pareto.svg");
    std::fs::remove_file(folder.at("o/pareto.svg")).unwrap();
    folder.prints("bench redraw --out o -q");
    assert!(folder.read("o/pareto.svg") == chart);
    // What is exact is named where nothing bounds it, and what is small where bytes do.
    let named = |flags: &str| {
        let answer = folder.json(&format!("recommend s.toml --results o {flags}"));
        answer["method"].as_str().unwrap().to_owned()
    };
    assert_eq!(named(""), "abuffer");
    let small = named("--max-bytes 12");
    assert!(["wboit-eq9", "painter-object:sort=off"].contains(&small.as_str()));
    // A scene is what it shows, whatever it is called.
    folder.write("renamed.toml", SPHERES.replace("three-spheres", "other"));
    folder.write(
        "changed.toml",
        SPHERES.replace("alpha = 0.7", "alpha = 0.6"),
    );
    let of = |scene: &str| folder.says(&format!("recommend {scene} --results o --max-error 1"), 0);
    assert_eq!(of("renamed.toml"), "");
    let said = of("changed.toml");
    assert!(
        said.contains("do not show that their scene 'three-spheres' is this one"),
        "{said}"
    );
}

/// The files of a run belong together: a second one into its folder is refused.
#[test]
fn two_runs_into_one_folder_exclude_one_another() {
    let folder = Folder::new(&[("s.toml", SPHERES)]);
    let line = "run s.toml --out o --size 64x48 --rows 4000 --epochs";
    let mut first = folder.command(&format!("{line} 1000000"));
    let first = first.stdout(Stdio::null()).stderr(Stdio::null());
    let mut first = first.spawn().unwrap();
    let lock = folder.at("o/model.safetensors.lock");
    let is_there = (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        lock.exists()
    });
    let output = folder.command(&format!("{line} 2")).output().unwrap();
    first.kill().unwrap();
    first.wait().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(is_there && output.status.code() == Some(1), "{said}");
    assert!(said.contains("another command writes there"), "{said}");
}

#[test]
fn a_scene_without_transparency_is_a_warning() {
    let opaque = SPHERES
        .replace("alpha = 0.5", "alpha = 1")
        .replace("alpha = 0.4", "alpha = 1")
        .replace("alpha = 0.7", "alpha = 1");
    let folder = Folder::new(&[
        ("s.toml", SPHERES),
        ("o.toml", &opaque.replace("three-", "opaque-")),
    ]);
    let said = folder.says("extract s.toml o.toml --size 8x8 --out d -q", 0);
    assert!(
        said.contains("nothing transparent is seen in opaque-spheres;"),
        "{said}"
    );
    for line in [
        "bench o.toml --size 8x8 --methods mboit4 --out b -q",
        "recommend o.toml --results b -q",
    ] {
        let said = folder.says(line, 0);
        let words = "nothing transparent is seen in opaque-spheres, so";
        assert!(said.contains(words), "{said}");
    }
}
