//! Text from strangers, in files and arguments, reaches neither a terminal nor a shader unescaped.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{SCENE, peelnet};
use std::ffi::OsStr;
use std::process::Output;

/// Clears a screen, starts lines that look like ours, and turns the writing direction, in every way a terminal knows.
const HOSTILE: &str = "x\u{1b}[2J\u{9b}31m\r\u{7}\u{202e}\u{85}y";

/// Neither stream holds what acts on a terminal. Returns whether the name is there in its escaped form.
fn assert_plain(output: &Output, what: &str) -> bool {
    let mut escaped = false;
    for stream in [&output.stdout, &output.stderr] {
        let text = String::from_utf8_lossy(stream);
        let hidden = text
            .chars()
            .find(|c| (c.is_control() && *c != '\n') || matches!(c, '\u{202a}'..='\u{202e}'));
        assert_eq!(hidden, None, "{what}: {text:?}");
        escaped |= text.contains("\\u{1b}[2J") || text.contains("\\u001b[2J");
    }
    escaped
}

#[test]
fn names_in_files_are_printed_escaped() {
    let dir = tempfile::tempdir().unwrap();
    let name = serde_json::to_string(HOSTILE)
        .unwrap()
        .replace('\u{9b}', "\\u009b");
    let name = name
        .replace('\u{85}', "\\u0085")
        .replace('\u{202e}', "\\u202e");
    let scene = SCENE.replace("\"two\"", &name);
    let scene = scene.replace("[[object]]\n", &format!("[[object]]\nname = {name}\n"));
    std::fs::write(dir.path().join("s.toml"), scene).unwrap();
    let mut model = peelnet::Model::shipped(peelnet::Recipe::SMALL).unwrap();
    model.meta.tool_version = HOSTILE.to_owned();
    model.meta.held_out.insert(HOSTILE.to_owned(), 0.5);
    for input in &mut model.meta.inputs {
        input.unit = HOSTILE.to_owned();
    }
    model.save(dir.path().join("m.safetensors")).unwrap();
    for line in [
        "inspect s.toml",
        "inspect s.toml --json",
        "inspect m.safetensors",
        "inspect m.safetensors --json",
        "render s.toml --size 8x8 --view 9 --out a.png",
        "render s.toml --size 8x8 --out a.png --json",
        "extract s.toml --size 8x8 --out d",
        "inspect d",
        "inspect d --json",
        "bench s.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b --json",
        "export m.safetensors --out -",
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = peelnet(dir.path(), &arguments);
        let shown = assert_plain(&output, line);
        assert!(
            shown || line.starts_with("render") || line.starts_with("extract"),
            "{line}"
        );
    }
    for file in [
        "b/report.html",
        "b/table.md",
        "b/results.json",
        "b/results.csv",
    ] {
        let text = std::fs::read_to_string(dir.path().join(file)).unwrap();
        let escape = text.find('\u{1b}').filter(|_| !file.ends_with(".csv"));
        assert_eq!(escape, None, "{file}");
    }
}

/// The names of files are whatever somebody called them.
#[test]
fn arguments_are_printed_escaped() {
    let dir = tempfile::tempdir().unwrap();
    for before in [
        &["render"][..],
        &["inspect"],
        &["export", "--out", "w.wgsl"],
        &["train", "--out", "m"],
        &["render", "s", "--out", "a.png", "--method"],
        &["extract", "s", "--out", "d", "--format"],
        &["stress", "--cases"],
        &["doctor", "--adapter"],
    ] {
        let arguments: Vec<&str> = before.iter().copied().chain([HOSTILE]).collect();
        let mut arguments = arguments;
        if before == ["render"] {
            arguments.extend(["--out", "a.png"]);
        }
        let output = peelnet(dir.path(), &arguments);
        assert!(!output.status.success(), "{before:?}");
        // The parser of arguments leaves out what it knows as colours.
        let shown = assert_plain(&output, &format!("{before:?}"));
        assert!(shown || before.len() > 3, "{before:?}");
    }
}

/// Bytes that are no text are shown as well as can be, and never end a command.
#[cfg(unix)]
#[test]
fn paths_that_are_no_text_do_not_end_a_command() {
    use std::os::unix::ffi::OsStrExt as _;
    let dir = tempfile::tempdir().unwrap();
    let odd = OsStr::from_bytes(b"caf\xe9");
    let at = |ending: &str| {
        let mut name = odd.to_owned();
        name.push(ending);
        name
    };
    let scene = peelnet_data::find("cups").unwrap().text;
    std::fs::write(dir.path().join(at(".toml")), scene).unwrap();
    let model = peelnet::Model::shipped(peelnet::Recipe::SMALL).unwrap();
    model.save(dir.path().join(at(".safetensors"))).unwrap();
    let [toml, network, image, shader, rows, trained] =
        [".toml", ".safetensors", ".png", ".wgsl", "-d", "-m"].map(at);
    let text = OsStr::new;
    let lines: [&[&OsStr]; 6] = [
        &[
            text("render"),
            &toml,
            text("--size"),
            text("8x8"),
            text("--out"),
            &image,
        ],
        &[text("export"), &network, text("--out"), &shader],
        &[text("inspect"), &toml],
        &[text("inspect"), &network],
        &[
            text("extract"),
            text("--synthetic"),
            text("300"),
            text("--out"),
            &rows,
        ],
        &[
            text("train"),
            &rows,
            text("--epochs"),
            text("1"),
            text("--out"),
            &trained,
        ],
    ];
    for line in lines {
        for json in [false, true] {
            let more = json.then_some(text("--json"));
            let arguments: Vec<&OsStr> = line.iter().copied().chain(more).collect();
            let output = peelnet(dir.path(), &arguments);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{arguments:?}: {said}");
            let result = String::from_utf8_lossy(&output.stdout);
            assert!(result.contains('\u{fffd}'), "{arguments:?}: {result}");
        }
    }
}
