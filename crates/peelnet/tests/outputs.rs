//! Outputs never destroy: what is replaced is said, and a signal leaves whole files or none. What is refused is in `command_line.rs`.

use crate::common::{Folder, SCENE};
use std::collections::BTreeMap;
use std::path::Path;

/// The file alone goes to stdout, the result to stderr; no file is called `-`.
#[test]
fn a_hyphen_is_stdout() {
    let folder = Folder::new(&[("two.toml", SCENE)]);
    folder.write_model("m.safetensors", peelnet::Recipe::SMALL);
    folder.prints("extract --synthetic 300 --out d");
    let before = folder.everything();
    for (line, start) in [
        ("render two.toml --size 8x8 --out -", &b"\x89PNG"[..]),
        ("render two.toml --size 8x8 --json --out -", b"\x89PNG"),
        ("export m.safetensors --out -", b"// A learned weight"),
        ("train d --epochs 1 --recipe small --out -", b""),
    ] {
        let output = folder.command(line).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {said}");
        assert!(output.stdout.starts_with(start), "{line}");
        assert!(!said.is_empty(), "{line}");
        if line.starts_with("train") {
            assert!(peelnet::Model::from_bytes(&output.stdout, "stdout").is_ok());
        }
    }
    assert_eq!(folder.everything(), before);
}

#[test]
fn what_is_replaced_is_said() {
    let foreign = [("two.toml", SCENE), ("notes.png", "a user's own")];
    let folder = Folder::new(&foreign);
    let render = "render two.toml --size 8x8 --out notes.png";
    folder.says(&format!("{render} --force"), 0);
    let said = folder.says(render, 0);
    assert!(said.contains("replacing notes.png (a PNG image of peelnet)"));
    // A texture of the scene that is drawn.
    let textured = format!("{SCENE}color_map = \"notes.png\"\n");
    folder.write("cut.toml", textured);
    folder.says("render cut.toml --size 8x8 --out notes.png --force", 0);
    let bench = "bench two.toml --methods wboit-eq9 --frames 0 --size 8x8 --out out";
    folder.says(bench, 0);
    let said = folder.says(bench, 0);
    assert!(said.contains("replacing out/") && said.contains("more files"));
    let printed = folder.prints("extract two.toml --size 8x8 --out d");
    assert!(printed.contains("1 part,"), "{printed}");
    let said = folder.says("extract two.toml --size 8x8 --out d", 0);
    assert!(said.contains("replacing d (a dataset)"), "{said}");
}

/// Two seconds are promised; the deadline here only ends a test that would hang.
#[cfg(unix)]
#[test]
fn signals_end_every_command() {
    use std::process::{Command, Stdio};
    let folder = Folder::new(&[]);
    folder.prints("extract --synthetic 3000 --out d");
    // What a training resumes from, and folders that stay empty.
    let kept = |path: &Path| path.starts_with("n.checkpoint") || folder.path().join(path).is_dir();
    let files = || -> BTreeMap<_, _> {
        let all = folder.everything().into_iter();
        all.filter(|(path, _)| !kept(path)).collect()
    };
    let before = files();
    const INT: (&str, i32) = ("INT", 130);
    const TERM: (&str, i32) = ("TERM", 143);
    for (line, (signal, code)) in [
        ("render sixteen-050 --size 4096x4096 --out a.png", INT),
        ("inspect vase --time", TERM),
        ("stress --out s", TERM),
        ("bench sixteen-050 --out b", INT),
        ("train d --epochs 1000000 --recipe small --out n", INT),
    ] {
        let mut command = folder.command(line);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped());
        let child = child.spawn().unwrap();
        // Long enough that the handler is there, short enough that no command has finished.
        std::thread::sleep(std::time::Duration::from_millis(400));
        let id = child.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(sent.unwrap().success());
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}: {text}");
        assert!(text.contains("interrupted"), "{line}: {text}");
        assert_eq!(files(), before, "{line}");
    }
}
