//! Faults from outside: killed at random moments, or a full disk. What is on disk is then complete or absent, and running again gives what
//! an undisturbed run gives.
//!
//! Each command is killed twice here, and as often as the environment's `PEELNET_KILLS` says (`cargo xtask faults`: fifty times).

use crate::common::{Folder, SPHERES};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Six views of the spheres.
fn folder() -> Folder {
    Folder::new(&[("s.toml", &SPHERES.replace("views = 2", "views = 6"))])
}

/// The files below a folder with hashes of what they hold.
fn files(folder: &Folder) -> BTreeMap<PathBuf, u64> {
    let all = folder.everything().into_iter();
    let files = all.filter(|(_, (kind, _))| kind == "file");
    files.map(|(path, (_, hash))| (path, hash)).collect()
}

/// Whether a path is of something temporary: a part of it begins with a dot.
fn is_hidden(path: &Path) -> bool {
    let mut names = path.components();
    names.any(|name| name.as_os_str().to_string_lossy().starts_with('.'))
}

/// Whether anything temporary is left.
fn holds_hidden(folder: &Folder) -> bool {
    folder.everything().keys().any(|path| is_hidden(path))
}

fn is_whole(png: &[u8]) -> bool {
    png.ends_with(b"IEND\xaeB`\x82")
}

/// Kills a command again and again, at moments spread evenly over the time it takes; `check` looks at what is left in `o` after each.
fn kill_again_and_again(line: &str, folder: &Folder, mut check: impl FnMut()) {
    let asked = std::env::var("PEELNET_KILLS").ok();
    let kills: u32 = asked.and_then(|n| n.parse().ok()).unwrap_or(2);
    let start = Instant::now();
    folder.prints(line);
    let mut whole = start.elapsed().as_secs_f64();
    let (mut killed, mut finished) = (0, 0);
    while killed < kills {
        let _ = std::fs::remove_dir_all(folder.at("o"));
        let mut command = folder.command(line);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
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
        assert!(finished < 10 + kills, "{finished} finished before");
    }
    println!("{line}: killed {killed} times, finished before it {finished} times");
}

#[test]
fn an_extraction_that_is_killed_leaves_whole_parts_and_can_be_resumed() {
    let folder = folder();
    let line = "extract s.toml --out o --size 320x240 --seed 5";
    folder.prints(line);
    let whole = files(&folder);
    let is_rows = |path: &Path| path.to_string_lossy().contains("fragments-") && !is_hidden(path);
    let mut resume = false;
    kill_again_and_again(line, &folder, || {
        let mut left = files(&folder);
        left.retain(|path, _| !is_hidden(path));
        if folder.at("o/_peelnet/manifest.json").exists() {
            assert_eq!(left, whole, "a dataset with a manifest is whole");
        }
        // Finished parts are whole, and stay.
        let mut stay = left.iter().filter(|(path, _)| is_rows(path));
        assert!(stay.all(|(path, hash)| whole.get(path) == Some(hash)));
        // Once by what is missing, once as a new dataset.
        resume = !resume;
        let flag = if resume { "--resume" } else { "" };
        folder.prints(&format!("{line} {flag}"));
        let (mut again, mut whole) = (files(&folder), whole.clone());
        assert!(!holds_hidden(&folder));
        if resume {
            // The plan has the command line of whoever made it.
            again.retain(|path, _| is_rows(path));
            whole.retain(|path, _| is_rows(path));
            folder.prints("inspect o");
        }
        assert_eq!(again, whole, "again");
    });
}

#[test]
fn training_that_is_killed_goes_on_to_the_same_weights() {
    let folder = Folder::new(&[]);
    folder.prints("extract --synthetic 3000 --out d --seed 2");
    let line = "train d --recipe thesis --out o/m.safetensors --epochs 8 --loss-curve o/loss.csv";
    folder.prints(line);
    let model = folder.read("o/m.safetensors");
    kill_again_and_again(line, &folder, || {
        if folder.at("o/m.safetensors").exists() {
            folder.prints("inspect o/m.safetensors");
        }
        // Killed before it was there, nothing can be resumed.
        let state = folder.at("o/m.safetensors.checkpoint/state.safetensors");
        let resume = if state.exists() { "--resume" } else { "" };
        folder.prints(&format!("{line} {resume}"));
        assert!(folder.read("o/m.safetensors") == model, "the same bytes");
    });
}

#[test]
fn a_bench_that_is_killed_goes_on_to_the_same_errors() {
    let folder = folder();
    let line = "bench s.toml --out o --size 160x120 --frames 1 --methods mboit4,wboit-eq9";
    folder.prints(line);
    let errors = || -> Vec<String> {
        let results: serde_json::Value =
            serde_json::from_slice(&folder.read("o/results.json")).unwrap();
        let rows = results["rows"].as_array().unwrap().iter();
        rows.map(|r| format!("{} {} {}", r["method"], r["view"], r["mse_linear"]))
            .collect()
    };
    let whole = errors();
    kill_again_and_again(line, &folder, || {
        let left = files(&folder).into_keys();
        for path in left.filter(|path| path.starts_with("o") && !is_hidden(path)) {
            let bytes = folder.read(path.to_str().unwrap());
            let is_sound = match path.extension().unwrap().to_str() {
                Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
                Some("png") => is_whole(&bytes),
                _ => !bytes.is_empty(),
            };
            assert!(is_sound, "{}", path.display());
        }
        folder.prints(&format!("{line} --resume"));
        assert_eq!(errors(), whole);
    });
}

/// What has come to its end is kept: going on says so, and with nothing to go on from it is an error.
#[test]
fn resuming_what_has_finished_says_so_and_keeps_it() {
    let folder = folder();
    folder.prints("extract --synthetic 2000 --out d");
    let train = "train d --recipe thesis --out m-0.5 --epochs 2";
    let bench = "bench s.toml --out o --size 32x24 --frames 1 --methods wboit-eq9";
    let text = folder.says(&format!("{train} --resume"), 1);
    let state = "m-0.5.checkpoint/state.safetensors";
    assert!(text.contains(state), "{text}");
    folder.prints(train);
    folder.prints(bench);
    for (line, code, words) in [
        (train, 0, "already finished after epoch 2"),
        (bench, 0, "has finished with these settings"),
        (&format!("{bench} --views 1"), 1, "leave out --resume"),
    ] {
        let before = ["m-0.5", "o/results.json"].map(|file| folder.read(file));
        let text = folder.says(&format!("{line} --resume"), code);
        assert!(text.contains(words), "{line}: {text}");
        let after = ["m-0.5", "o/results.json"].map(|file| folder.read(file));
        assert!(after == before, "{line}");
    }
}

/// Files may grow to so many kilobytes and then every write fails, as on a full disk: one error, and nothing left.
#[cfg(unix)]
#[test]
fn a_full_disk_is_one_error_and_leaves_nothing() {
    let folder = folder();
    folder.prints("extract --synthetic 2000 --out d");
    folder.prints("train d --recipe thesis --out m.safetensors --epochs 1");
    let before = files(&folder);
    for (kilobytes, line) in [
        (16, "extract s.toml --out o --size 320x240"),
        (16, "extract s.toml --out o --size 320x240 --format csv"),
        (16, "extract s.toml --out o --size 320x240 --format npy"),
        (
            1,
            "train d --recipe thesis --out o/m.safetensors --epochs 2",
        ),
        (1, "export m.safetensors --out o.wgsl"),
        (2, "render s.toml --out o.exr --size 64x48"),
        (
            2,
            "bench s.toml --out o --size 64x48 --frames 0 --methods blended",
        ),
    ] {
        // Ignored, the signal becomes an error of the write.
        let program = env!("CARGO_BIN_EXE_peelnet");
        let script = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec {program} {line}");
        let mut command = std::process::Command::new("bash");
        command.args(["-c", &script]).current_dir(folder.path());
        let output = command.output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        let errors = text.lines().filter(|l| l.starts_with("error: "));
        let errors = errors.filter(|l| !l.contains("XDG_RUNTIME_DIR"));
        assert_eq!(errors.count(), 1, "{line}: {text}");
        // A bench may have finished pictures before its table did not fit; each is whole.
        for path in files(&folder).into_keys() {
            let is_old = before.contains_key(&path);
            let is_whole = || is_whole(&folder.read(path.to_str().unwrap()));
            assert!(is_old || is_whole(), "{line}");
        }
        assert!(!holds_hidden(&folder), "{line}");
        let _ = std::fs::remove_dir_all(folder.at("o"));
    }
}
