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
        "extract a.toml --out d --shard 0/4",
        "extract --synthetic 99999999999 --out d",
        "extract a.toml --out d --format xml",
        "extract a.toml --out d --peel onion",
        "train d --out m --recipe huge",
        "train d --out m --loss-curve loss.png",
        "train d --out m --epochs 0",
        "train d --out m --epochs 4294967295",
        "train d --out m --batch 4294967295",
        "train d --out m --hidden 1000000000,8",
        "train d --out m --max-rows 0",
        "train d --out m --lr -1",
        "export m --out w --lang cuda",
        "export m --out w --lang spirv",
        "export m --out w --precision f64",
        "render a.toml --out a.gif",
        "render a.toml --out a.png --method wbiot",
        "render a.toml --out a.png --method abuffer:speed=9",
        "render a.toml --out a.png --method mboit4:bias=9",
        "render a.toml --out a.png --method mboit4:bias=0,bias=1",
        "bench a.toml --out d --methods mboit4:bios=1",
        "stress --methods mboit4:overestimation=-5",
        "render a.toml --out a.png --method wboit-eq9 --highlight 1",
        "render a.toml --out a.png --increasing",
        "render a.toml --out a.png --layers printed",
        "render a.toml --out a.png --highlight 1 --layers ours",
        "bench a.toml --out d --effects --scaling",
        "bench a.toml --out d --path --scaling",
        "bench a.toml --out d --samples 2",
        "render a.toml --out a.png --samples 8",
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

const CAMERA: &str =
    "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100.0\n";

/// Scenes whose meshes or cameras are broken.
fn broken_scenes(folder: &Path) {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (name, obj) in [
        ("nan", format!("{quad}v 0 nan 0\nf 1 2 3\n")),
        ("normal", format!("{quad}vn 0 inf 1\nf 1//1 2//1 3//1\n")),
        ("beyond", format!("{quad}f 1 2 9\n")),
        ("cut", format!("{quad}f 1 2")),
        ("empty", String::new()),
    ] {
        write(&format!("{name}.obj"), &obj);
        write(
            &format!("{name}.toml"),
            &format!("{CAMERA}[[object]]\nmesh = '{name}.obj'\n"),
        );
    }
    write("planes.toml", &CAMERA.replace("near = 0.1", "near = 200"));
}

/// Datasets that are broken in one place each.
fn broken_datasets(folder: &Path) {
    let made = peelnet(
        &[
            "extract",
            "--synthetic",
            "40",
            "--format",
            "csv",
            "--out",
            "sound",
        ],
        folder,
    );
    assert!(made.status.success(), "{}", stderr(&made));
    // One of its files changed; lengths are those of the manifest again.
    let spoil = |name: &str, change: &dyn Fn(String) -> String| {
        std::fs::create_dir_all(folder.join(name).join("_peelnet")).unwrap();
        let meta = ["_peelnet/manifest.json", "_peelnet/plan.json"].map(str::to_owned);
        let rows = std::fs::read_dir(folder.join("sound")).unwrap();
        let rows = rows.map(|e| e.unwrap().file_name().to_string_lossy().into_owned());
        // The manifest first: lengths are changed in its copy.
        for file in meta.into_iter().chain(rows.filter(|n| n.ends_with(".csv"))) {
            let text = std::fs::read_to_string(folder.join("sound").join(&file)).unwrap();
            let changed = if file.ends_with(".csv") {
                change(text.clone())
            } else {
                text.clone()
            };
            std::fs::write(folder.join(name).join(&file), &changed).unwrap();
            if changed.len() != text.len() {
                let manifest = folder.join(name).join("_peelnet/manifest.json");
                let sound = folder.join("sound/_peelnet/manifest.json");
                let length = |n: usize| format!("\"bytes\": {n}");
                let text = std::fs::read_to_string(sound)
                    .unwrap()
                    .replace(&length(text.len()), &length(changed.len()));
                std::fs::write(manifest, text).unwrap();
            }
        }
    };
    // The depth of the third row.
    let third = |value: &str, text: String| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut fields: Vec<&str> = lines[3].split(',').collect();
        fields[1] = value;
        lines[3] = fields.join(",");
        lines.join("\n") + "\n"
    };
    spoil("d-nan", &|text| third("NaN", text));
    spoil("d-column", &|text| {
        text.replacen("transmittance", "transmission", 1)
    });
    spoil("d-cut", &|text| text[..text.len() / 2].to_owned());
}

/// Model files: one cut off, one with a shape in its header that the weights do not have.
fn broken_models(folder: &Path) {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/anchored-small/model.safetensors");
    let mut model = std::fs::read(root).unwrap();
    let half = model.len() / 2;
    std::fs::write(folder.join("cut.safetensors"), &model[..half]).unwrap();
    let text = String::from_utf8_lossy(&model).into_owned();
    let at = text
        .find("\"shape\":[8,5]")
        .expect("the first layer's shape");
    model[at..at + 13].copy_from_slice(b"\"shape\":[5,9]");
    std::fs::write(folder.join("shape.safetensors"), &model).unwrap();
}

/// Hard input in every kind of file: exit code 1, one line that names the file, the place in it and the fix, and nothing written.
#[test]
fn hard_input_is_refused_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    broken_scenes(folder);
    broken_datasets(folder);
    broken_models(folder);
    let before = std::fs::read_dir(folder).unwrap().count();
    for (line, words) in [
        (
            "render nan.toml --out a.png",
            vec!["nan.obj:5", "'v 0 nan 0' holds no finite", "repair"],
        ),
        (
            "render normal.toml --out a.png",
            vec!["normal.obj:5", "'vn 0 inf 1' holds", "repair"],
        ),
        (
            "extract beyond.toml --out d",
            vec!["beyond.obj:5", "'f 1 2 9'"],
        ),
        ("bench cut.toml --out d", vec!["cut.obj:5", "cut off"]),
        (
            "render empty.toml --out a.exr",
            vec!["empty.obj", "no faces"],
        ),
        (
            "render planes.toml --out a.png",
            vec!["planes.toml", "camera.near", "below far"],
        ),
        (
            "train d-nan --out m.safetensors",
            vec!["d-nan", "row 3", "linear_depth", "NaN"],
        ),
        (
            "train d-column --out m.safetensors",
            vec!["d-column", "column transmittance is missing"],
        ),
        ("train d-cut --out m.safetensors", vec!["d-cut"]),
        (
            "export cut.safetensors --out w.wgsl",
            vec!["cut.safetensors"],
        ),
        ("inspect shape.safetensors", vec!["shape.safetensors"]),
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(&arguments, folder);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        assert!(output.stdout.is_empty(), "{line}");
        let errors: Vec<&str> = text.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "{line}: {text}");
        for word in words {
            assert!(errors[0].contains(word), "{line}: no '{word}' in {text}");
        }
        let there = std::fs::read_dir(folder).unwrap().count();
        assert_eq!(there, before, "{line} leaves nothing");
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
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("error: "));
}

/// The shipped vase: each layer highlighted at a time of its own, what there is not is refused, and `inspect` and the measurement of
/// effects list what it needs.
#[test]
fn the_vase_shows_its_layers_and_its_age() {
    let dir = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/effects");
    let vase = data.join("vase.toml").display().to_string();
    let run = |line: &str| {
        let mut arguments: Vec<&str> = line.split_whitespace().collect();
        arguments.insert(1, &vase);
        peelnet(&arguments, dir.path())
    };
    let mut files = Vec::new();
    for (k, line) in [
        "render --size 64x48 --highlight 0 --time 0",
        "render --size 64x48 --highlight 1 --time 40",
        "render --size 64x48 --highlight 1 --time 55 --increasing",
        "render --size 64x48 --time 55",
        "render --size 64x48 --highlight 1 --time 40 --layers printed",
    ]
    .iter()
    .enumerate()
    {
        let output = run(&format!("{line} --out {k}.png --json"));
        let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        let layer = words.iter().position(|w| *w == "--highlight");
        let printed = if words.contains(&"printed") {
            " (formula as printed)"
        } else {
            ""
        };
        let method = layer.map_or("abuffer".to_owned(), |at| {
            format!("layer {}{printed}", words[at + 1])
        });
        assert_eq!(answer["method"], method, "{line}");
        assert!(answer["time"].is_number(), "{line}");
        files.push(std::fs::read(dir.path().join(format!("{k}.png"))).unwrap());
    }
    for (i, a) in files.iter().enumerate() {
        assert!(
            files[..i].iter().all(|b| a != b),
            "picture {i} is like an earlier one"
        );
    }
    for (line, word) in [
        ("render --highlight 9 --out no.png", "[0, 1, 2]"),
        ("render --time 61 --out no.png", "from 0 to 60"),
    ] {
        let output = run(line);
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
    assert!(!dir.path().join("no.png").exists());
    let output = run("inspect --json");
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let on = |name: &str| {
        let effects = answer["effects"].as_array().unwrap().iter();
        effects
            .clone()
            .any(|e| e["name"] == name && e["on"] == true)
    };
    assert!(
        ["layers", "ageing", "pbr", "normal-map"]
            .iter()
            .all(|name| on(name))
    );
    assert!(!on("cutout") && !on("monochrome"));
    let mist = data.join("mist.toml").display().to_string();
    let output = peelnet(
        &[
            "bench",
            "--effects",
            &mist,
            "--size",
            "32x24",
            "--frames",
            "1",
            "--out",
            "e",
            "--json",
        ],
        dir.path(),
    );
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let costs = answer["costs"].as_array().unwrap();
    // Unlit: nothing is shaded that could be left out.
    assert_eq!(answer["parts"].as_array().map(Vec::len), Some(0));
    let names: Vec<&str> = costs.iter().filter_map(|c| c["effect"].as_str()).collect();
    assert_eq!(names, ["opaque", "monochrome", "low-resolution"]);
    let page = std::fs::read_to_string(dir.path().join("e/report.html")).unwrap();
    assert!(page.matches("data:image/png").count() == 6 && page.contains("low-resolution"));
}
