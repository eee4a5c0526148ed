//! Text from strangers, in files and arguments, reaches neither a terminal nor a shader unescaped.

use crate::common::{Folder, SCENE};
use std::process::Output;

/// Clears a screen, starts lines that look like ours, and turns the writing direction, in every way a terminal knows.
const HOSTILE: &str = "x\u{1b}[2J\u{9b}31m\r\u{7}\u{202e}\u{85}y";

/// Neither stream holds what acts on a terminal. Returns whether the name is there in its escaped form.
pub fn assert_plain(output: &Output, what: &str) -> bool {
    let mut escaped = false;
    for stream in [&output.stdout, &output.stderr] {
        let text = String::from_utf8_lossy(stream);
        let acts = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
        assert!(!text.contains(acts), "{what}: {text:?}");
        escaped |= text.contains("\\u{1b}[2J") || text.contains("\\u001b[2J");
    }
    escaped
}

#[test]
fn names_in_files_are_printed_escaped() {
    let folder = Folder::new(&[]);
    let escaped = |c: char| match c {
        ' '..='~' => c.to_string(),
        _ => format!("\\u{:04x}", u32::from(c)),
    };
    let name: String = HOSTILE.chars().map(escaped).collect();
    let scene = SCENE.replace("\"two\"", &format!("\"{name}\""));
    let named = format!("[[object]]\nname = \"{name}\"\n");
    folder.write("s.toml", scene.replace("[[object]]\n", &named));
    let mut model = peelnet::Model::shipped(peelnet::Recipe::SMALL).unwrap();
    model.meta.tool_version = HOSTILE.to_owned();
    model.meta.held_out.insert(HOSTILE.to_owned(), 0.5);
    for input in &mut model.meta.inputs {
        input.unit = HOSTILE.to_owned();
    }
    model.save(folder.at("m.safetensors")).unwrap();
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
        "inspect d --html d.html",
        "extract s.toml --size 8x8 --out p --preview",
        "bench s.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b --json",
        "export m.safetensors --out -",
    ] {
        let shown = assert_plain(&folder.command(line).output().unwrap(), line);
        let names_none =
            line.starts_with("render") || line.starts_with("extract s.toml --size 8x8 --out d");
        assert!(shown || names_none, "{line}");
    }
    for file in [
        "b/report.html",
        "d.html",
        "p/preview.html",
        "b/table.md",
        "b/results.json",
        "b/results.csv",
    ] {
        assert!(!folder.read(file).contains(&0x1b), "{file}");
    }
}

/// The names of files are whatever somebody called them.
#[test]
fn arguments_are_printed_escaped() {
    let folder = Folder::new(&[]);
    for before in [
        "render --out a.png",
        "inspect",
        "export --out w.wgsl",
        "train --out m",
        "render s --out a.png --method",
        "extract s --out d --format",
        "stress --cases",
        "doctor --adapter",
    ] {
        let output = folder.command(before).arg(HOSTILE).output().unwrap();
        assert!(!output.status.success(), "{before}");
        // The parser of arguments leaves out what it knows as colours.
        let is_parsed = before.contains(" s ") || before.ends_with("--cases");
        let shown = assert_plain(&output, before);
        assert!(shown || is_parsed, "{before}");
    }
}

/// Bytes that are no text are shown as well as can be, and never end a command.
#[cfg(unix)]
#[test]
fn paths_that_are_no_text_do_not_end_a_command() {
    use std::ffi::OsString;
    use std::os::unix::ffi::OsStringExt as _;
    let folder = Folder::new(&[]);
    // In the lines here, `@` stands for it.
    let odd = |word: &str| {
        let parts: Vec<&[u8]> = word.split('@').map(str::as_bytes).collect();
        OsString::from_vec(parts.join(&b"caf\xe9"[..]))
    };
    let scene = peelnet_shipped_scenes::find("cups").unwrap().text;
    std::fs::write(folder.path().join(odd("@.toml")), scene).unwrap();
    folder.write_model(odd("@.safetensors"), peelnet::Recipe::SMALL);
    for line in [
        "render @.toml --size 8x8 --out @.png",
        "export @.safetensors --out @.wgsl",
        "inspect @.toml",
        "inspect @.safetensors",
        "extract --synthetic 300 --out @-d",
        "train @-d --recipe thesis --epochs 1 --out @-m",
    ] {
        for line in [line, &format!("{line} --json")] {
            let words: Vec<OsString> = line.split(' ').map(odd).collect();
            let output = folder.command_of(&words).output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{line}: {said}");
            let result = String::from_utf8_lossy(&output.stdout);
            assert!(result.contains('\u{fffd}'), "{line}: {result}");
        }
    }
}
