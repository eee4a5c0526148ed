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

/// A file for stdout that nobody gets is an error; `/dev/null`, where nobody wants it, is none.
#[cfg(target_os = "linux")]
#[test]
fn a_closed_stdout_is_an_error() {
    let folder = Folder::new(&[("two.toml", SCENE)]);
    let program = env!("CARGO_BIN_EXE_peelnet");
    for (to, code) in [(">&-", 1), (">/dev/null", 0)] {
        let line = format!("{program} render two.toml --size 8x8 --out - {to}");
        let mut shell = std::process::Command::new("sh");
        let output = shell
            .args(["-c", &line])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{to}: {said}");
        assert_eq!(said.contains("stdout is closed"), code == 1, "{said}");
    }
}

#[test]
fn what_is_replaced_is_said() {
    let foreign = [("two.toml", SCENE), ("notes.png", "a user's own")];
    let folder = Folder::new(&foreign);
    let render = "render two.toml --size 8x8 --out notes.png";
    folder.says(&format!("{render} --force"), 0);
    let said = folder.says(render, 0);
    assert!(said.contains("replaced notes.png (a PNG image of peelnet)"));
    // An error replaces nothing.
    let said = folder.says(&format!("{render} --view 9"), 2);
    assert!(!said.contains("replac"), "{said}");
    let said = folder.says("extract two.toml --size 8x8 --views 9 --out o", 2);
    assert!(!said.contains("replac"), "{said}");
    // A texture of the scene that is drawn.
    let textured = format!("{SCENE}color_map = \"notes.png\"\n");
    folder.write("cut.toml", textured);
    folder.says("render cut.toml --size 8x8 --out notes.png --force", 0);
    let bench = "bench two.toml --methods wboit-eq9 --frames 0 --size 8x8 --out out";
    folder.says(bench, 0);
    let said = folder.says(bench, 0);
    assert!(said.contains("replaced out/") && said.contains("more files"));
    let printed = folder.prints("extract two.toml --size 8x8 --out d");
    assert!(printed.contains("1 part,"), "{printed}");
    let said = folder.says("extract two.toml --size 8x8 --out d", 0);
    assert!(said.contains("replaced d (a dataset)"), "{said}");
}

/// Results and pictures of two runs never mix: one command at a time writes into a folder, and pictures that a later run left are known.
#[test]
fn a_folder_of_results_is_of_one_run() {
    let folder = Folder::new(&[("two.toml", SCENE)]);
    let bench = "bench two.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b";
    folder.prints(bench);
    // A key of the user's own stays.
    let results = String::from_utf8(folder.read("b/results.json")).unwrap();
    let own = results.replace("\n  \"command\"", "\n  \"note\": 1,\n  \"command\"");
    assert_ne!(own, results);
    folder.write("b/results.json", &own);
    folder.prints("bench redraw --out b");
    assert_eq!(folder.read("b/results.json"), own.as_bytes());
    folder.write("b/results.json", &results);
    // Nothing was timed, and all of it is of this program's shaders.
    assert!(results.contains("\"time_ms\": null") && !results.contains("\"time_ms\": 0"));
    folder.prints("bench redraw --check --out b");
    let shaders = results.split("\"shaders\": \"").nth(1).unwrap();
    folder.write("b/results.json", results.replace(&shaders[..64], "other"));
    let said = folder.says("bench redraw --check --out b", 1);
    assert!(
        said.contains("wboit-eq9") && said.contains("measure them again"),
        "{said}"
    );
    folder.write("b/results.json", results);
    let held = peelnet_train::OutputLock::take(&folder.at("b/.peelnet")).unwrap();
    for line in [
        bench,
        "bench redraw --out b",
        "bench scaling --methods wboit-eq9 --out b --force",
        "bench effects two.toml --out b --force",
        "bench path two.toml --methods wboit-eq9 --frames 1 --size 8x8 --out b --force",
        "stress --methods wboit-eq9 --out b",
        "run two.toml --out b --force",
    ] {
        let said = folder.says(line, 1);
        assert!(
            said.contains("b/.peelnet: another command writes"),
            "{said}"
        );
    }
    drop(held);
    folder.prints("render two.toml --size 4x4 --out b/images/two-wboit-eq9.png");
    for line in ["bench redraw --out b", &format!("{bench} --resume")] {
        let said = folder.says(line, 1);
        assert!(
            said.contains("two-wboit-eq9.png: is not the picture"),
            "{said}"
        );
    }
    std::fs::remove_dir_all(folder.at("b/images")).unwrap();
    folder.prints("bench redraw --out b");
    let results = String::from_utf8(folder.read("b/results.json")).unwrap();
    let long = "x".repeat(70_000);
    for (from, to, why) in [
        ("\"mse_linear\": ", "\"mse_linear\": -", "`mse_linear` is -"),
        (
            "wboit-eq9",
            "abuffer",
            "is a second one of abuffer on view 0 of two",
        ),
        ("wboit-eq9", &long, "`method` has 70000 characters"),
    ] {
        folder.write("b/results.json", results.replace(from, to));
        for line in ["bench redraw --out b", "recommend two.toml --results b"] {
            let said = folder.says(line, 1);
            let words = ["results.json: ", "rows[1]: ", why, "; make it with"];
            assert!(words.iter().all(|word| said.contains(word)), "{said}");
        }
    }
}

/// Pictures beside the rows of an interrupted bench are those rows'.
#[test]
fn an_interrupted_bench_keeps_its_folder() {
    let folder = Folder::new(&[("o/partial.json", "{\"sha256\":\"")]);
    let said = folder.says("bench path cups --size 8x8 --frames 2 --out o", 1);
    assert!(
        said.contains("partial.json in it is of another command"),
        "{said}"
    );
}

/// What peeling left out is lacking in what is learnt.
#[test]
fn a_training_says_what_its_dataset_lacks() {
    let folder = Folder::new(&[]);
    folder.prints("extract cups --size 64x48 --views 1 --peel single --max-passes 2 --out d -q");
    let said = folder.says(
        "train d --recipe thesis --epochs 1 --out m.safetensors -q",
        0,
    );
    assert!(
        said.contains("d lacks ") && said.contains(" fragments"),
        "{said}"
    );
}

/// The curve beside an older model stays that model's.
#[cfg(unix)]
#[test]
fn an_interrupted_training_leaves_the_loss_curve() {
    let folder = Folder::new(&[]);
    folder.prints("extract --synthetic 3000 --out d");
    let line = "train d --recipe small --out n --loss-curve n.csv --epochs";
    folder.prints(&format!("{line} 1"));
    let before = folder.read("n.csv");
    // A model is known by its content.
    assert_eq!(folder.json("inspect n")["kind"], "model");
    let mut child = folder.command(&format!("{line} 1000000")).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(400));
    let id = child.id().to_string();
    let sent = std::process::Command::new("kill").arg(&id).status();
    assert!(sent.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert_eq!(folder.read("n.csv"), before);
}

/// A file that its reader did not take is not written.
#[test]
fn a_pipe_without_a_reader_is_an_error() {
    let folder = Folder::new(&[("two.toml", SCENE)]);
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut command = folder.command("render two.toml --size 8x8 --out -");
    let output = command.stdout(writer).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("pipe"), "{said}");
}

/// Programs that start others open `/dev/null` for reading, too, where they want none of what is printed.
#[cfg(target_os = "linux")]
#[test]
fn json_that_nobody_wants_is_no_error() {
    let folder = Folder::new(&[]);
    folder.prints("extract --synthetic 3000 --out d");
    let line = format!(
        "'{}' inspect d --json 1<>/dev/null",
        env!("CARGO_BIN_EXE_peelnet")
    );
    let mut shell = std::process::Command::new("sh");
    let output = shell
        .args(["-c", &line])
        .current_dir(folder.path())
        .output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
}

/// Until a signal has ended a command that nobody waits for: a second is promised, and machines that run tests are slow.
#[cfg(unix)]
const SIGNAL_DEADLINE: std::time::Duration = std::time::Duration::from_secs(5);

/// Also where nobody reads what is written to stderr.
#[cfg(unix)]
#[test]
fn signals_end_every_command() {
    use std::io::Write as _;
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
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
        for is_read in [true, false] {
            let (unread, mut full) = std::io::pipe().unwrap();
            let stderr = match is_read {
                true => Stdio::piped(),
                false => full.try_clone().unwrap().into(),
            };
            // Ends once nothing reads the pipe any more.
            let filled = std::thread::spawn(move || while full.write(&[0; 4096]).is_ok() {});
            let mut command = folder.command(line);
            let mut child = command
                .stdout(Stdio::null())
                .stderr(stderr)
                .spawn()
                .unwrap();
            drop(command);
            // Long enough that the handler is there, short enough that no command has finished.
            std::thread::sleep(Duration::from_millis(400));
            let id = child.id().to_string();
            let sent = Command::new("kill").args(["-s", signal, &id]).status();
            assert!(sent.unwrap().success());
            let sent = Instant::now();
            while child.try_wait().unwrap().is_none() {
                if sent.elapsed() > SIGNAL_DEADLINE {
                    child.kill().unwrap();
                    panic!("{line}: goes on, stderr read: {is_read}");
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            let output = child.wait_with_output().unwrap();
            let text = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(code), "{line}: {text}");
            assert_eq!(text.contains("interrupted"), is_read, "{line}: {text}");
            assert_eq!(files(), before, "{line}");
            drop(unread);
            filled.join().unwrap();
        }
    }
}

/// Who starts a command to ignore a signal, as `nohup` does, has it ignored.
#[cfg(target_os = "linux")]
#[test]
fn ignored_signals_stay_ignored() {
    use std::time::Duration;
    let folder = Folder::new(&[]);
    folder.prints("extract --synthetic 3000 --out d");
    let command = folder.command("train d --epochs 1000000 --recipe small --out n");
    let mut ignoring = std::process::Command::new("sh");
    ignoring.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]);
    ignoring.arg(command.get_program()).args(command.get_args());
    let mut child = ignoring.current_dir(folder.path()).spawn().unwrap();
    let send = |signal: &str| {
        std::thread::sleep(Duration::from_millis(400));
        let id = child.id().to_string();
        let sent = std::process::Command::new("kill")
            .args(["-s", signal, &id])
            .status();
        assert!(sent.unwrap().success());
    };
    send("HUP");
    send("TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

/// Mesa's drivers say what they miss in the environment on stderr.
#[cfg(target_os = "linux")]
#[test]
fn nothing_is_said_where_nothing_is_wrong() {
    let folder = Folder::new(&[("two.toml", SCENE)]);
    let mut command = folder.command("render two.toml --size 8x8 --out a.png -q");
    let output = command.env_remove("XDG_RUNTIME_DIR").output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert!(output.status.success());
}
