//! Commands as a whole: random arguments over a folder of random files. Whatever happens, a command ends, does not panic, says nothing
//! that acts on a terminal, and changes no file that is not a named output of its own kind.
//!
//! Nothing guides the search: what a command covers is not seen across processes. The workspace's tests run some seeds; with the variable
//! `PEELNET_FUZZ_SECONDS`, which `cargo xtask fuzz` sets, new ones are tried for so long.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{SCENE, everything};
use peelnet_core::random::Random;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Command lines that every test run tries.
const COMMANDS: u64 = 60;

/// No command here needs longer, on any machine, by a factor of ten.
const LONGEST: Duration = Duration::from_secs(300);

/// Files that peelnet wrote, made once: a dataset, a network, a measurement, an image, a loss curve, a shader.
struct Ours(tempfile::TempDir);

/// Files that a user wrote.
const FOREIGN: [(&str, &[u8]); 10] = [
    ("s.toml", SCENE.as_bytes()),
    ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("notes.txt", b"a user's own"),
    ("photo.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR a user's own"),
    ("curve.svg", b"<svg>a user's own</svg>"),
    ("table.csv", b"epoch,loss\n1,2\n"),
    ("f/keep.txt", b"a user's own"),
    ("f/report.html", b"<!DOCTYPE html>a user's own"),
    ("g/manifest.json", b"{}"),
    ("g/fragments-1.csv", b"a user's own"),
];

/// What inputs and outputs are called: files of the folder, some that do not exist, and some that are no files.
const NAMES: [&str; 36] = [
    "s.toml",
    "a.obj",
    "notes.txt",
    "photo.png",
    "curve.svg",
    "table.csv",
    "f",
    "g",
    "f/keep.txt",
    "d",
    "d/_peelnet/manifest.json",
    "m.safetensors",
    "n",
    "n.checkpoint",
    "b",
    "b/results.json",
    "b/images",
    "image.png",
    "w.wgsl",
    "loss.csv",
    "loss.svg",
    "link.png",
    "link.toml",
    "dangling.png",
    "circle",
    "empty.png",
    "pipe",
    "new.png",
    "new.exr",
    "new/deep/x.npy",
    "new.wgsl",
    "new",
    "-",
    "/dev/null",
    "cups",
    "",
];

/// Values of flags, sound and not.
const VALUES: [&str; 14] = [
    "1",
    "0",
    "-1",
    "2",
    "8x8",
    "all",
    "1e30",
    "nan",
    "4294967295",
    "99999999999999999999",
    "csv",
    "npy",
    "thesis",
    "mboit4:bias=1e-6",
];

fn ours() -> Ours {
    let dir = tempfile::tempdir().unwrap();
    for (name, bytes) in &FOREIGN[..2] {
        std::fs::write(dir.path().join(name), bytes).unwrap();
    }
    let model = peelnet::Model::shipped(peelnet::Recipe::SMALL).unwrap();
    model.save(dir.path().join("m.safetensors")).unwrap();
    for line in [
        "extract --synthetic 300 --out d",
        "train d --epochs 1 --recipe small --out n --loss-curve loss.csv --loss-curve loss.svg",
        "bench s.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b",
        "render s.toml --size 8x8 --out image.png",
        "export m.safetensors --out w.wgsl",
    ] {
        let arguments: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let output = run(dir.path(), &arguments);
        assert!(output.status.success(), "{line}: {output:?}");
    }
    Ours(dir)
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap().path();
        let target = to.join(entry.file_name().unwrap());
        if entry.is_dir() {
            std::fs::create_dir_all(&target).unwrap();
            copy(&entry, &target);
        } else {
            std::fs::copy(&entry, &target).unwrap();
        }
    }
}

/// A folder with all of these, links, a pipe, and sometimes a file with wrong bytes in it.
fn folder(ours: &Ours, random: &mut Random) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    copy(ours.0.path(), dir.path());
    for (name, bytes) in FOREIGN {
        std::fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        std::fs::write(at(name), bytes).unwrap();
    }
    std::fs::write(at("empty.png"), "").unwrap();
    for (target, link) in [
        ("notes.txt", "link.png"),
        ("s.toml", "link.toml"),
        ("f/far.png", "dangling.png"),
        ("circle", "circle"),
    ] {
        symlink(target, at(link)).unwrap();
    }
    assert!(
        Command::new("mkfifo")
            .arg(at("pipe"))
            .status()
            .unwrap()
            .success()
    );
    if random.below(3) == 0 {
        let damaged = [
            "s.toml",
            "a.obj",
            "m.safetensors",
            "d/_peelnet/manifest.json",
            "b/results.json",
            "n.checkpoint/state.safetensors",
        ];
        let path = at(damaged[random.below(damaged.len())]);
        let mut bytes = std::fs::read(&path).unwrap();
        let k = random.below(bytes.len());
        match random.below(3) {
            0 => bytes.truncate(k),
            1 => bytes[k] ^= 1 << random.below(8),
            _ => drop(bytes.splice(k..k, *b"\x1b[2J99999999999")),
        }
        std::fs::write(path, bytes).unwrap();
    }
    dir
}

/// Flags of `train`, and the curve among its outputs.
fn train_flags(random: &mut Random, line: &mut Vec<String>, outputs: &mut Vec<String>) {
    const CURVES: [&str; 7] = [
        "loss.csv",
        "curve.svg",
        "table.csv",
        "new.svg",
        "d/_peelnet/manifest.json",
        "m.safetensors",
        "-",
    ];
    line.extend(["--epochs".to_owned(), "1".to_owned()]);
    if random.below(2) == 0 {
        let curve = CURVES[random.below(CURVES.len())].to_owned();
        line.extend(["--loss-curve".to_owned(), curve.clone()]);
        outputs.push(curve);
    }
    if random.below(4) == 0 {
        line.push("--resume".to_owned());
    }
}

/// A command line, and what it names as outputs.
fn line(random: &mut Random) -> (Vec<String>, Vec<String>) {
    const COMMANDS: [(&str, &[&str], &[&str]); 11] = [
        (
            "render",
            &["s.toml", "link.toml", "cups"],
            &["--method", "--view", "--time", "--highlight"],
        ),
        (
            "extract",
            &["s.toml", "cups"],
            &[
                "--views",
                "--format",
                "--pixels",
                "--augment",
                "--seed",
                "--shard",
            ],
        ),
        ("extract --synthetic 30", &[], &["--format", "--seed"]),
        (
            "train",
            &["d"],
            &[
                "--recipe",
                "--batch",
                "--hidden",
                "--max-rows",
                "--patience",
                "--seed",
            ],
        ),
        (
            "export",
            &["m.safetensors", "n"],
            &["--lang", "--precision"],
        ),
        ("bench", &["s.toml"], &["--views", "--models"]),
        ("run", &["s.toml"], &["--seed"]),
        ("inspect", &["s.toml", "d", "m.safetensors", "cups"], &[]),
        ("seal", &["d", "g"], &[]),
        ("stress --cases deep", &[], &["--models"]),
        ("doctor", &[], &["--adapter"]),
    ];
    let pick = |random: &mut Random, from: &[&str]| from[random.below(from.len())].to_owned();
    let (command, inputs, flags) = COMMANDS[random.below(COMMANDS.len())];
    let mut line: Vec<String> = command.split(' ').map(str::to_owned).collect();
    if !inputs.is_empty() {
        // Mostly what is meant.
        let from = if random.below(4) == 0 {
            &NAMES[..]
        } else {
            inputs
        };
        line.push(pick(random, from));
    }
    let mut outputs = Vec::new();
    if !matches!(command, "inspect" | "doctor" | "seal") {
        // Who writes to a pipe waits for its reader.
        let names = NAMES.map(|name| if name == "pipe" { "new2" } else { name });
        let out = pick(random, &names);
        line.extend(["--out".to_owned(), out.clone()]);
        outputs.push(out);
    }
    match command {
        "render" | "extract" => {
            line.extend(["--size".to_owned(), "8x8".to_owned()]);
            if command == "extract" && random.below(3) == 0 {
                line.push("--resume".to_owned());
            }
        }
        "extract --synthetic 30" if random.below(3) == 0 => line.push("--resume".to_owned()),
        "train" => train_flags(random, &mut line, &mut outputs),
        "bench" => {
            let size = ["--methods", "wboit-eq9", "--frames", "0", "--size", "8x8"];
            line.extend(size.map(str::to_owned));
        }
        "run" => {
            let little = ["--size", "8x8", "--rows", "100", "--epochs", "1"];
            line.extend(little.map(str::to_owned));
        }
        "stress --cases deep" => line.extend(["--methods", "wboit-eq9"].map(str::to_owned)),
        _ => {}
    }
    if !flags.is_empty() && random.below(2) == 0 {
        line.extend([pick(random, flags), pick(random, &VALUES)]);
    }
    for flag in ["--json", "--quiet", "--force"] {
        if random.below(4) == 0 {
            line.push(flag.to_owned());
        }
    }
    (line, outputs)
}

/// Runs a command, but not for ever.
fn run(folder: &Path, arguments: &[String]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_peelnet"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(std::fs::File::create(folder.with_extension("out")).unwrap())
        .stderr(std::fs::File::create(folder.with_extension("err")).unwrap())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > LONGEST {
            child.kill().unwrap();
            panic!("{arguments:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let take = |ending: &str| {
        let path = folder.with_extension(ending);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        bytes
    };
    let (stdout, stderr) = (take("out"), take("err"));
    Output {
        status,
        stdout,
        stderr,
    }
}

/// Where the bytes of a named output go, in the folder.
fn target(folder: &Path, name: &str) -> Option<PathBuf> {
    let resolved = folder.join(name).canonicalize().ok()?;
    Some(
        resolved
            .strip_prefix(folder.canonicalize().ok()?)
            .ok()?
            .to_owned(),
    )
}

fn check(ours: &Ours, seed: u64) -> i32 {
    let mut random = Random::new(seed, &[]);
    let dir = folder(ours, &mut random);
    let (line, outputs) = line(&mut random);
    let before = everything(dir.path());
    let output = run(dir.path(), &line);
    let after = everything(dir.path());
    let said = String::from_utf8_lossy(&output.stderr);
    let what = format!("seed {seed}: peelnet {}\n{said}", line.join(" "));

    let code = output.status.code();
    assert!(matches!(code, Some(0..=2)), "{code:?} from {what}");
    assert!(!said.contains("panicked"), "{what}");
    let is_text = !outputs.iter().any(|o| o == "-");
    for stream in [&output.stdout, &output.stderr] {
        let text = String::from_utf8_lossy(stream);
        let hidden = text.chars().find(|c| c.is_control() && *c != '\n');
        assert!(hidden.is_none() || !is_text, "{what}");
    }
    if code != Some(0) {
        assert!(said.contains("error: "), "{what}");
    }

    let force = line.iter().any(|a| a == "--force");
    let named: Vec<PathBuf> = outputs
        .iter()
        .filter_map(|o| target(dir.path(), o))
        .collect();
    let foreign = |path: &Path| FOREIGN.iter().any(|(name, _)| Path::new(name) == path);
    for (path, was) in &before {
        // A folder of results is replaced file by file; a model brings its training's state.
        let of = |out: &PathBuf| {
            let checkpoint = format!("{}.checkpoint", out.display());
            path.starts_with(out) || path.starts_with(checkpoint)
        };
        let may_change = named.iter().any(of) && (force || !foreign(path));
        let is = after.get(path);
        assert!(
            is == Some(was) || (may_change && is.is_none_or(|(kind, _)| *kind == was.0)),
            "{} became {is:?}: {what}",
            path.display()
        );
        if code == Some(2) {
            assert_eq!(is, Some(was), "{}: {what}", path.display());
        }
    }
    for path in after.keys() {
        let name = path.file_name().unwrap().to_string_lossy();
        assert!(
            !name.starts_with(".peelnet") && !name.starts_with(".partial") && name != "-",
            "{} is left: {what}",
            path.display()
        );
        if code == Some(2) {
            assert!(
                before.contains_key(path),
                "{} is new: {what}",
                path.display()
            );
        }
    }
    code.unwrap()
}

#[test]
fn commands_change_nothing_but_their_outputs() {
    let ours = ours();
    let mut codes = [0; 3];
    for seed in 0..COMMANDS {
        codes[check(&ours, seed) as usize] += 1;
    }
    // The generator makes lines of every kind.
    assert!(codes.iter().all(|n| *n > 0), "{codes:?}");
    let Ok(seconds) = std::env::var("PEELNET_FUZZ_SECONDS") else {
        return;
    };
    let start = Instant::now();
    // Other seeds each time.
    let mut seed = std::time::UNIX_EPOCH.elapsed().unwrap().as_secs() << 20;
    while start.elapsed().as_secs() < seconds.parse().unwrap() {
        codes[check(&ours, seed) as usize] += 1;
        seed += 1;
    }
    eprintln!(
        "commands: {} done, {} failed, {} wrong usage",
        codes[0], codes[1], codes[2]
    );
}
