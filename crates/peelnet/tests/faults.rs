//! Faults from outside: killed at random moments, a full disk, folders that cannot be written. What is on disk is then complete
//! or absent, and running again gives what an undisturbed run gives.
//!
//! Each command is killed twice here, and as often as the environment's `PEELNET_KILLS` says (`cargo xtask faults`: fifty times).
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const SCENE: &str = r#"
name = "spheres"

[camera]
position = [0, 0, 4]
target = [0, 0, 0]
near = 0.1
far = 100.0

[orbit]
views = 6

[scatter]
count = 12
seed = 3
mesh = { shape = "sphere" }
min = [-1, -1, -1]
max = [1, 1, 1]
scale = [0.2, 0.4]
alpha = [0.2, 0.8]
"#;

/// Graphics libraries complain on stderr where this is not set, as in containers.
fn quiet(command: &mut Command) -> &mut Command {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    }
    command
}

fn command(line: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_peelnet"));
    command.args(line.split_whitespace()).current_dir(folder);
    // Records and plans have the name.
    command.env("PEELNET_WORKER", "test");
    quiet(&mut command);
    command
}

fn peelnet(line: &str, folder: &Path) -> Output {
    command(line, folder).output().unwrap()
}

fn must(line: &str, folder: &Path) {
    let output = peelnet(line, folder);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {text}");
}

/// Bytes of every file below a folder, by its name; `.` at the start of a name marks what is temporary.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(next).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if name.starts_with('.') {
                continue;
            }
            if path.is_dir() {
                open.push(path);
            } else {
                let bytes = std::fs::read(&path).unwrap();
                all.insert(path.strip_prefix(folder).unwrap().to_owned(), bytes);
            }
        }
    }
    all
}

/// Kills a command again and again, at moments spread evenly over the time it takes; `check` looks at what is left after each.
fn kill_again_and_again(line: &str, folder: &Path, out: &str, mut check: impl FnMut()) {
    let asked = std::env::var("PEELNET_KILLS").ok();
    let kills: u32 = asked.and_then(|n| n.parse().ok()).unwrap_or(2);
    let start = Instant::now();
    must(line, folder);
    let mut whole = start.elapsed().as_secs_f64();
    let (mut killed, mut finished) = (0, 0);
    while killed < kills {
        let _ = std::fs::remove_dir_all(folder.join(out));
        let mut child = command(line, folder)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Golden ratio steps: no two moments alike, and everywhere some.
        let share = (f64::from(killed + finished) * 0.618_033_988_75 + 0.37).fract();
        std::thread::sleep(Duration::from_secs_f64(whole * share));
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            finished += 1;
            // The machine was busier when the command was timed.
            whole *= share;
        } else {
            killed += 1;
        }
        check();
        assert!(
            finished < 10 + kills,
            "{finished} runs finished before they were killed"
        );
    }
    println!("{line}: killed {killed} times, finished before it {finished} times");
}

#[test]
fn an_extraction_that_is_killed_leaves_whole_parts_and_can_be_resumed() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), SCENE).unwrap();
    let line = "extract s.toml --out o --size 320x240 --seed 5";
    must(line, folder);
    let whole = contents(&folder.join("o"));
    let is_rows = |name: &Path| name.to_string_lossy().starts_with("fragments-");
    let mut resume = false;
    kill_again_and_again(line, folder, "o", || {
        let left = contents(&folder.join("o"));
        if left.contains_key(Path::new("_peelnet/manifest.json")) {
            assert_eq!(left, whole, "a dataset with a manifest is whole");
        }
        // Finished parts are whole, and stay.
        let stay = left.iter().filter(|(name, _)| is_rows(name));
        assert!(
            stay.clone()
                .all(|(name, bytes)| whole.get(name) == Some(bytes))
        );
        // Once by what is missing, once as a new dataset.
        resume = !resume;
        must(
            &format!("{line}{}", if resume { " --resume" } else { "" }),
            folder,
        );
        let mut again = contents(&folder.join("o"));
        let mut whole = whole.clone();
        if resume {
            // The plan has the command line of whoever made it.
            again.retain(|name, _| is_rows(name));
            whole.retain(|name, _| is_rows(name));
            must("inspect o", folder);
        }
        assert_eq!(again, whole, "again");
        for hidden in [folder.join("o"), folder.join("o/_peelnet")] {
            let hidden = std::fs::read_dir(hidden).unwrap();
            let hidden = hidden.filter(|e| {
                let name = e.as_ref().unwrap().file_name();
                name.to_string_lossy().starts_with(".partial")
            });
            assert_eq!(hidden.count(), 0, "what was abandoned is removed");
        }
    });
}

#[test]
fn training_that_is_killed_goes_on_to_the_same_weights() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    must("extract --synthetic 3000 --out d --seed 2", folder);
    let line = "train d --out o/m.safetensors --epochs 8 --loss-curve o/loss.csv";
    must(line, folder);
    let model = std::fs::read(folder.join("o/m.safetensors")).unwrap();
    kill_again_and_again(line, folder, "o", || {
        if folder.join("o/m.safetensors").exists() {
            must("inspect o/m.safetensors", folder);
        }
        // Killed before it was there, nothing can be resumed.
        let state = folder.join("o/m.safetensors.checkpoint/state.safetensors");
        let resume = if state.exists() { "--resume" } else { "" };
        must(&format!("{line} {resume}"), folder);
        let again = std::fs::read(folder.join("o/m.safetensors")).unwrap();
        assert!(again == model, "the same bytes after going on");
    });
}

#[test]
fn a_bench_that_is_killed_goes_on_to_the_same_errors() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), SCENE).unwrap();
    let line = "bench s.toml --out o --size 160x120 --frames 1 --methods mboit4,wboit-eq9";
    must(line, folder);
    let errors = || -> Vec<(String, u64, u64)> {
        let bytes = std::fs::read(folder.join("o/results.json")).unwrap();
        let results: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        let rows = results["rows"].as_array().unwrap().iter();
        rows.map(|r| {
            let mse = r["mse_linear"].as_f64().unwrap();
            (
                r["method"].to_string(),
                r["view"].as_u64().unwrap(),
                mse.to_bits(),
            )
        })
        .collect()
    };
    let whole = errors();
    kill_again_and_again(line, folder, "o", || {
        for (name, bytes) in contents(&folder.join("o")) {
            let ending = name.extension().unwrap().to_string_lossy().into_owned();
            match ending.as_str() {
                "json" => drop(serde_json::from_slice::<serde_json::Value>(&bytes).unwrap()),
                "png" => assert!(
                    bytes.ends_with(b"IEND\xaeB`\x82"),
                    "{} is whole",
                    name.display()
                ),
                _ => assert!(!bytes.is_empty(), "{}", name.display()),
            }
        }
        must(&format!("{line} --resume"), folder);
        assert_eq!(errors(), whole);
    });
}

/// What has come to its end is kept: going on says so, and with nothing to go on from it is an error.
#[test]
fn resuming_what_has_finished_says_so_and_keeps_it() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    let said = |line: &str, code: i32, words: &str| {
        let output = peelnet(line, folder);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}: {text}");
        assert!(text.contains(words), "{line}: {text}");
    };
    must("extract --synthetic 2000 --out d", folder);
    let line = "train d --out m-0.5 --epochs 2";
    said(
        &format!("{line} --resume"),
        1,
        "m-0.5.checkpoint/state.safetensors",
    );
    must(line, folder);
    let model = std::fs::read(folder.join("m-0.5")).unwrap();
    said(
        &format!("{line} --resume"),
        0,
        "already finished after epoch 2",
    );
    assert_eq!(std::fs::read(folder.join("m-0.5")).unwrap(), model);

    std::fs::write(folder.join("s.toml"), SCENE).unwrap();
    let line = "bench s.toml --out o --size 32x24 --frames 1 --methods wboit-eq9";
    must(line, folder);
    let results = std::fs::read(folder.join("o/results.json")).unwrap();
    said(
        &format!("{line} --resume"),
        0,
        "has finished with these settings",
    );
    assert_eq!(
        std::fs::read(folder.join("o/results.json")).unwrap(),
        results
    );
    said(
        &format!("{line} --views 1 --resume"),
        1,
        "leave out --resume",
    );
    assert_eq!(
        std::fs::read(folder.join("o/results.json")).unwrap(),
        results
    );
}

/// Files may grow to so many kilobytes and then every write fails, as on a full disk: one error, and nothing left.
#[cfg(unix)]
#[test]
fn a_full_disk_is_one_error_and_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), SCENE).unwrap();
    must("extract --synthetic 2000 --out d", folder);
    must("train d --out m.safetensors --epochs 1", folder);
    let before = contents(folder);
    for (line, kilobytes) in [
        ("extract s.toml --out o --size 320x240", 16),
        ("extract s.toml --out o --size 320x240 --format csv", 16),
        ("extract s.toml --out o --size 320x240 --format npy", 16),
        ("train d --out o/m.safetensors --epochs 2", 1),
        ("export m.safetensors --out o.wgsl", 1),
        ("render s.toml --out o.exr --size 64x48", 2),
        (
            "bench s.toml --out o --size 64x48 --frames 0 --methods blended",
            2,
        ),
    ] {
        // Ignored, the signal becomes an error of the write.
        let script = format!(
            "trap '' XFSZ; ulimit -f {kilobytes}; exec {} {line}",
            env!("CARGO_BIN_EXE_peelnet")
        );
        let output = quiet(&mut Command::new("bash"))
            .args(["-c", &script])
            .current_dir(folder)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        let errors = text.lines().filter(|l| l.starts_with("error: ")).count();
        assert_eq!(errors, 1, "{line}: {text}");
        // A bench may have finished pictures before its table did not fit; each is whole.
        let mut left = contents(folder);
        left.retain(|name, _| !before.contains_key(name));
        let whole = |bytes: &[u8]| bytes.ends_with(b"IEND\xaeB`\x82");
        assert!(
            left.values().all(|bytes| whole(bytes)),
            "{line}: {:?}",
            left.keys()
        );
        let hidden = std::fs::read_dir(folder).unwrap().filter(|e| {
            let name = e.as_ref().unwrap().file_name();
            name.to_string_lossy().starts_with('.')
        });
        assert_eq!(hidden.count(), 0, "{line} leaves no temporary file");
        let _ = std::fs::remove_dir_all(folder.join("o"));
    }
}

/// A folder in which nobody may write, not even root: one error that names it.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("s.toml"), SCENE).unwrap();
    must("extract --synthetic 2000 --out d", folder);
    must("train d --out m.safetensors --epochs 1", folder);
    for line in [
        "extract s.toml --out /proc/o --size 32x24",
        "train d --out /proc/o/m.safetensors --epochs 1",
        "export m.safetensors --out /proc/o.wgsl",
        "render s.toml --out /proc/o.png --size 32x24",
        "bench s.toml --out /proc/o --size 32x24 --frames 0 --methods blended",
        "stress --methods blended --cases empty --out /proc/o",
        "run s.toml --out /proc/o --size 32x24 --rows 500 --epochs 1",
    ] {
        let output = peelnet(line, folder);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        let errors: Vec<&str> = text.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "{line}: {text}");
        assert!(errors[0].contains("/proc/o"), "{line}: {text}");
    }
}
