//! The special measurements: the commands of `bench`, `--samples`, and `stress`.

use crate::common::{Folder, SCENE, SPHERES, rows_of};
use serde_json::Value;

fn rows(answer: &Value) -> &[Value] {
    answer["rows"].as_array().unwrap()
}

const DESIGNS: &str = r#"
[training]
epochs = 2
learning_rate = 0.016

[[design]]
name = "small"
ends = [0.49, 0.77, 1.0]
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

/// Each design has its row, in the order of the file, and a run replaces the files of an earlier one. Without a network the figures are
/// those of the renderer, which draws the same design with its shaders, within a fifth: colours in 16-bit targets, of errors this small.
#[test]
fn designs_are_measured_as_they_are_drawn() {
    let one_view = SPHERES.replace("views = 2", "views = 1");
    let folder = Folder::new(&[("s.toml", &one_view), ("f.toml", DESIGNS)]);
    folder.prints("extract --synthetic 1000 --out d");
    let line = "bench designs d s.toml --file f.toml --size 96x64 --out o";
    folder.prints(line);
    let found = folder.json(line);
    for (row, name, bytes) in [(0, "small", 29), (1, "three", 35)] {
        let row = &rows(&found)[row];
        assert!(row["design"] == name && row["bytes"] == bytes, "{row}");
        assert!(row["seconds"].as_f64().unwrap() > 0.0, "{row}");
        assert_ne!(row["network"], row["middle"], "{row}");
    }
    assert_eq!(rows(&found)[1]["topology"], "9-4-1");
    assert!(found["epochs"] == 2 && found["judged_on"][0] == "three-spheres");
    assert!(folder.at("o/designs.json").exists() && folder.at("o/designs.md").exists());
    let drawn = folder.json(
        "bench s.toml --methods mboit4,kbuffer-4,slabs:keep=small --frames 0 --size 96x64 --out b",
    );
    let of = |method: &str, field: &str| rows_of(&drawn, method)[0][field].as_f64().unwrap();
    let small = of("slabs:keep=small", "mse_linear");
    for (field, expected) in [
        ("to_moments", small / of("mboit4", "mse_linear")),
        ("to_kbuffer", small / of("kbuffer-4", "mse_linear")),
        ("contour_pairs", of("slabs:keep=small", "contour_pairs")),
    ] {
        let found = rows(&found)[0]["middle"][field].as_f64().unwrap();
        let is_near = (found - expected).abs() <= 0.2 * expected;
        assert!(is_near, "{field}: {found}, drawn {expected}");
    }
}

/// Every file is there, a row for each method and one for each of its frames; exact compositing has no error. A second run replaces the
/// files of the first.
#[test]
fn a_path_is_measured() {
    let second = "[[object]]\nmesh = { shape = \"quad\", size = [1, 1] }\ntranslate = [0.2, 0.1, -0.5]\n[object.material]\n\
        color = [0.1, 0.8, 0.1]\nalpha = 0.5\n";
    let folder = Folder::new(&[("s.toml", &format!("{SCENE}{second}"))]);
    let line = "bench path s.toml --frames 3 --size 24x16 --methods abuffer,depth-peel,weighted-sum --out out";
    folder.prints(line);
    let answer = folder.json(line);
    let [exact, blended] = rows(&answer) else {
        panic!("{answer}");
    };
    assert!(exact["method"] == "depth-peel" && blended["method"] == "weighted-sum");
    let figure = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert_eq!(figure(exact, "jod"), 10.0);
    assert_eq!(figure(exact, "contour_pairs"), 0.0);
    assert!(figure(exact, "mse_linear") < 1e-10);
    assert!(figure(blended, "jod") < 10.0 && figure(blended, "change") > 0.0);
    assert!(blended["contour_pairs"].is_number());
    let frames = answer["by_frame"].as_array().unwrap();
    assert_eq!(frames.len(), 6);
    assert!(frames[0]["change"].is_null() && !frames[1]["change"].is_null());
    let files =
        "path.json path.csv path-frames.csv path.md path-error.svg path-change.svg report.html";
    for name in files.split(' ') {
        assert!(folder.at("out").join(name).exists(), "{name}");
    }
    // Three frames side by side and that of the largest change, errors above changes.
    for (name, size) in [
        ("two-weighted-sum", (4 * 24, 2 * 16)),
        ("two-abuffer", (3 * 24, 16)),
    ] {
        let strip = folder.at(&format!("out/images/{name}.png"));
        assert_eq!(image::image_dimensions(strip).unwrap(), size, "{name}");
    }
}

/// A row for each step: nine of fragments, five of pixels, five of triangles.
#[test]
fn growth_is_measured() {
    let folder = Folder::new(&[]);
    let answer = folder.json("bench scaling --methods weighted-sum --frames 1 --out o");
    let steps = rows(&answer);
    assert!(steps.len() == 19 && steps[18]["series"] == "triangles");
    for name in ["scaling.json", "scaling.md", "scaling-pixels.svg"] {
        assert!(folder.at("o").join(name).exists(), "{name}");
    }
}

/// A frame of four samples says so, with the fragments of all samples.
#[test]
fn samples_are_drawn_and_reported() {
    let folder = Folder::new(&[("s.toml", SCENE)]);
    let fragments = |samples: u32| {
        let line = format!("render s.toml --out a.npy --size 32x24 --samples {samples}");
        let answer = folder.json(&line);
        assert_eq!(answer["samples"], samples);
        answer["fragments"].as_f64().unwrap()
    };
    // Four times as many, but for those along the edges.
    let ratio = fragments(4) / fragments(1);
    assert!((3.5..=4.5).contains(&ratio), "{ratio}");
    let bench = "bench s.toml --out out --size 16x12 --frames 1 --samples 4 --methods mboit4";
    let answer = folder.json(bench);
    assert!(rows(&answer).iter().all(|r| r["samples"] == 4));
}

/// Peeling that stops after a layer covers too little: not declared, so it fails, with the value, the place and pictures.
#[test]
fn a_failure_is_exit_code_1_with_pictures() {
    let folder = Folder::new(&[]);
    let line = "stress --methods depth-peel:passes=1,abuffer --cases deep,empty --out o --json";
    let output = folder.command(line).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let words = " not hold; pictures of them are in o/images";
    assert!(text.contains(words), "{text}");
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let failed = rows(&answer).iter().filter(|r| r["result"] == "fail");
    assert!(failed.clone().count() > 0);
    for row in failed {
        let is_known = row["method"] == "depth-peel:passes=1" && row["case"] == "deep";
        assert!(is_known, "{row}");
        assert!(row["value"].as_f64().unwrap() > row["limit"].as_f64().unwrap());
        assert!(row["place"].as_str().unwrap().contains("pixel"));
    }
    let pictures = std::fs::read_dir(folder.at("o/images")).unwrap();
    assert_eq!(pictures.count(), 2, "what failed, and the exact image");
    for name in ["stress.json", "stress.csv", "stress.md", "stress.html"] {
        let text = String::from_utf8(folder.read(&format!("o/{name}"))).unwrap();
        assert!(text.contains("depth-peel:passes=1"), "{name}");
    }
}

/// A network of one's own is checked alone, in both precisions, and known failures that it does not have are no failures.
#[test]
fn a_network_of_ones_own_is_checked_alone() {
    let folder = Folder::new(&[]);
    folder.write_model("m.safetensors", peelnet::Recipe::ANCHORED_SMALL);
    let answer = folder.json("stress --model m.safetensors --cases coplanar,half-float");
    let methods = rows(&answer).iter().map(|r| r["method"].as_str().unwrap());
    let methods: std::collections::BTreeSet<&str> = methods.collect();
    let recipe = peelnet::Recipe::ANCHORED_SMALL.method;
    let expected = ["f16", "f32"].map(|p| format!("{recipe}:targets={p}"));
    assert!(methods.into_iter().eq(&expected));
}
