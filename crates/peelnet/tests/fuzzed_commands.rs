//! Commands as a whole: random arguments over a folder of random files. Whatever happens, a command ends, does not panic, says nothing
//! that acts on a terminal, and changes no file that is not a named output of its own kind.
//!
//! Nothing guides the search: what a command covers is not seen across processes. The workspace's tests run some seeds; with the variable
//! `PEELNET_FUZZ_SECONDS`, which `cargo xtask fuzz` sets, new ones are tried for so long.

use crate::common::{Folder, SCENE};
use crate::foreign_text::assert_plain;
use peelnet_core::random::Random;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Command lines that every test run tries.
const COMMANDS: u64 = 60;

/// No command here needs longer, on any machine, by a factor of ten.
const LONGEST: Duration = Duration::from_secs(300);

/// Files that a user wrote.
const FOREIGN: [(&str, &str); 10] = [
    ("s.toml", SCENE),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("notes.txt", "a user's own"),
    ("photo.png", "\u{89}PNG\r\n a user's own"),
    ("curve.svg", "<svg>a user's own</svg>"),
    ("table.csv", "epoch,loss\n1,2\n"),
    ("f/keep.txt", "a user's own"),
    ("f/report.html", "<!DOCTYPE html>a user's own"),
    ("g/manifest.json", "{}"),
    ("g/fragments-1.csv", "a user's own"),
];

/// What inputs and outputs are called: files of the folder, some that do not exist, and some that are no files; the last is empty.
const NAMES: &str = "s.toml a.obj notes.txt photo.png curve.svg table.csv f g f/keep.txt d d/_peelnet/manifest.json m.safetensors \
    n n.checkpoint b b/results.json b/images image.png w.wgsl loss.csv loss.svg link.png link.toml dangling.png circle empty.png \
    pipe new.png new.exr new/deep/x.npy new.wgsl new - /dev/null cups ";

/// Values of flags, sound and not.
const VALUES: &str =
    "1 0 -1 2 8x8 all 1e30 nan 4294967295 99999999999999999999 csv npy thesis mboit4:bias=1e-6";

const CURVES: &str =
    "loss.csv curve.svg table.csv new.svg d/_peelnet/manifest.json m.safetensors -";

/// Commands with flags that keep them short, their inputs, and flags that get a value.
const LINES: &str = "
    render --size 8x8 | s.toml link.toml cups | --method --view --time --highlight
    extract --size 8x8 | s.toml cups | --views --format --pixels --augment --seed --shard
    extract --synthetic 30 | | --format --seed
    train --epochs 1 | d | --recipe --batch --hidden --max-rows --patience --seed
    export | m.safetensors n | --lang --precision
    bench --methods wboit-eq9 --frames 0 --size 8x8 | s.toml | --views --models
    run --size 8x8 --rows 100 --epochs 1 | s.toml | --seed
    inspect | s.toml d m.safetensors cups |
    seal | d g |
    stress --cases deep --methods wboit-eq9 | | --models
    doctor | | --adapter";

fn pick(random: &mut Random, from: &str) -> String {
    let all: Vec<&str> = from.split(' ').collect();
    all[random.below(all.len())].to_owned()
}

/// Files that peelnet wrote, made once: a dataset, a network, a measurement, an image, a loss curve, a shader.
fn ours() -> Folder {
    let folder = Folder::new(&FOREIGN[..2]);
    folder.write_model("m.safetensors", peelnet::Recipe::SMALL);
    for line in [
        "extract --synthetic 300 --out d",
        "train d --epochs 1 --recipe small --out n --loss-curve loss.csv --loss-curve loss.svg",
        "bench s.toml --methods wboit-eq9 --frames 0 --size 8x8 --out b",
        "render s.toml --size 8x8 --out image.png",
        "export m.safetensors --out w.wgsl",
    ] {
        folder.prints(line);
    }
    folder
}

/// A folder with all of these, links, a pipe, and sometimes a file with wrong bytes in it.
fn folder(ours: &Folder, random: &mut Random) -> Folder {
    let folder = Folder::new(&[]);
    for (path, (kind, _)) in ours.everything() {
        if kind == "file" {
            let bytes = std::fs::read(ours.path().join(&path)).unwrap();
            folder.write(path.to_str().unwrap(), bytes);
        }
    }
    for (name, text) in FOREIGN.into_iter().chain([("empty.png", "")]) {
        folder.write(name, text);
    }
    for (target, link) in [
        ("notes.txt", "link.png"),
        ("s.toml", "link.toml"),
        ("f/far.png", "dangling.png"),
        ("circle", "circle"),
    ] {
        symlink(target, folder.at(link)).unwrap();
    }
    let made = Command::new("mkfifo").arg(folder.at("pipe")).status();
    assert!(made.unwrap().success());
    if random.below(3) == 0 {
        let names = "s.toml a.obj m.safetensors d/_peelnet/manifest.json b/results.json n.checkpoint/state.safetensors";
        let name = pick(random, names);
        let mut bytes = folder.read(&name);
        let k = random.below(bytes.len());
        match random.below(3) {
            0 => bytes.truncate(k),
            1 => bytes[k] ^= 1 << random.below(8),
            _ => drop(bytes.splice(k..k, *b"\x1b[2J99999999999")),
        }
        folder.write(&name, bytes);
    }
    folder
}

/// A command line, and what it names as outputs.
fn line(random: &mut Random) -> (Vec<String>, Vec<String>) {
    let lines: Vec<&str> = LINES.trim().lines().collect();
    let mut fields = lines[random.below(lines.len())].split('|').map(str::trim);
    let [start, inputs, flags] = [(); 3].map(|()| fields.next().unwrap());
    let mut line: Vec<String> = start.split(' ').map(str::to_owned).collect();
    let command = line[0].clone();
    let (mut more, mut outputs) = (Vec::new(), Vec::new());
    if !inputs.is_empty() {
        // Mostly what is meant.
        let from = if random.below(4) == 0 { NAMES } else { inputs };
        line.push(pick(random, from));
    }
    if !matches!(command.as_str(), "inspect" | "doctor" | "seal") {
        outputs.push(pick(random, NAMES));
        more.extend(["--out".to_owned(), outputs[0].clone()]);
    }
    if command == "train" && random.below(2) == 0 {
        outputs.push(pick(random, CURVES));
        more.extend(["--loss-curve".to_owned(), outputs[1].clone()]);
    }
    if !flags.is_empty() && random.below(2) == 0 {
        more.extend([pick(random, flags), pick(random, VALUES)]);
    }
    if matches!(command.as_str(), "train" | "extract") && random.below(3) == 0 {
        more.push("--resume".to_owned());
    }
    let switches = ["--json", "--quiet", "--force"].into_iter();
    more.extend(switches.filter(|_| random.below(4) == 0).map(str::to_owned));
    line.extend(more);
    (line, outputs)
}

/// Runs a command, but not for ever.
fn run(folder: &Folder, arguments: &[String]) -> Output {
    let mut command = folder.command_of(arguments);
    command.stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let (done, output) = mpsc::channel();
    std::thread::spawn(move || done.send(child.wait_with_output()));
    let output = output.recv_timeout(LONGEST);
    let output = output.unwrap_or_else(|_| panic!("{arguments:?} does not end"));
    output.unwrap()
}

fn check(ours: &Folder, seed: u64) -> i32 {
    let mut random = Random::new(seed, &[]);
    let folder = folder(ours, &mut random);
    let (line, outputs) = line(&mut random);
    let before = folder.everything();
    let output = run(&folder, &line);
    let after = folder.everything();
    let said = String::from_utf8_lossy(&output.stderr);
    let what = format!("seed {seed}: peelnet {}\n{said}", line.join(" "));

    let code = output.status.code();
    assert!(matches!(code, Some(0..=2)), "{code:?} from {what}");
    assert!(!said.contains("panicked"), "{what}");
    assert!(code == Some(0) || said.contains("error: "), "{what}");
    if !outputs.iter().any(|o| o == "-") {
        assert_plain(&output, &what);
    }

    let force = line.iter().any(|a| a == "--force");
    // Where the bytes of a named output go, in the folder.
    let root = folder.path().canonicalize().unwrap();
    let targets = outputs.iter().filter_map(|out| {
        // A link stays, and so does what it leads to.
        let path = Some(folder.at(out)).filter(|path| !path.is_symlink());
        let resolved = path?.canonicalize().ok()?;
        Some(resolved.strip_prefix(&root).ok()?.to_owned())
    });
    let targets: Vec<PathBuf> = targets.collect();
    let is_foreign = |path: &Path| FOREIGN.iter().any(|(name, _)| Path::new(name) == path);
    for (path, was) in &before {
        // A folder of results is replaced file by file; a model brings its training's state.
        let is_of = |out: &PathBuf| {
            let checkpoint = format!("{}.checkpoint", out.display());
            path.starts_with(out) || path.starts_with(checkpoint)
        };
        let may_change =
            code != Some(2) && targets.iter().any(is_of) && (force || !is_foreign(path));
        let is = after.get(path);
        assert!(
            is == Some(was) || (may_change && is.is_none_or(|(kind, _)| *kind == was.0)),
            "{} became {is:?}: {what}",
            path.display()
        );
    }
    for path in after.keys() {
        let name = path.file_name().unwrap().to_string_lossy();
        let is_left = name.starts_with(".peelnet") || name.starts_with(".partial") || name == "-";
        let is_new = code == Some(2) && !before.contains_key(path);
        assert!(!is_left && !is_new, "{} is left: {what}", path.display());
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
    let [done, failed, wrong] = codes;
    eprintln!("commands: {done} done, {failed} failed, {wrong} wrong usage");
}
