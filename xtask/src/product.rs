//! What runs the program itself: the demo, and the shipped networks.

use crate::{
    Outcome, apart, captured, program, program_in_root, root, run, setup::ensure_driver, start,
};
use std::{env, fs, path::PathBuf, process::Command};

/// `peelnet` as cargo builds it, for commands whose words are parted by spaces.
pub struct Program(pub PathBuf);

impl Program {
    /// The program that PEELNET_BINARY names, or the release build with these features, compiled with cargo's own progress.
    pub fn given_or_built(features: &str) -> Result<Self, String> {
        ensure_driver()?;
        if let Some(path) = env::var_os("PEELNET_BINARY") {
            // The caller's path is relative to where it stands.
            let found = fs::canonicalize(&path);
            let found = found.map_err(|e| format!("{}: {e}", path.to_string_lossy()));
            return found.map(Self);
        }
        run(&format!(
            "cargo build --release --package peelnet --features={features}"
        ))?;
        Ok(Self(program("release")))
    }

    fn command(&self, line: &str) -> Command {
        println!("\n== peelnet {line}");
        program_in_root(&self.0, line)
    }

    pub fn run(&self, line: &str) -> Outcome {
        start(&mut self.command(line))
    }

    pub fn captured(&self, line: &str) -> Result<Vec<u8>, String> {
        captured(&mut self.command(line))
    }
}

pub fn demo(out: &str, full: &str) -> Outcome {
    println!("Compiling peelnet: minutes the first time.");
    Program::given_or_built("")?.run(&format!("run --out {out} {full}"))?;
    let report = root().join(out).join("report.html");
    println!("\nThe report: {}", report.display());
    Ok(())
}

/// The recipes, each with the budget that a search (benches/budgets.py) chose where it is not the recipe's own. All learn from the same data.
const RECIPES: [(&str, &str); 10] = [
    // The recipe's own are shorter, for networks of one's own scenes in a minute.
    ("small", "--epochs 40"),
    ("medium", "--epochs 80"),
    ("large", "--epochs 80"),
    ("one", "--epochs 40"),
    ("one-wide", "--epochs 40"),
    ("anchored-small", "--lr 0.016 --epochs 80"),
    ("anchored-medium", "--lr 0.016 --epochs 80"),
    ("nmt", ""),
    ("dfaoit", "--epochs 160"),
    // The recipe's own are the thesis's published settings, which `peelnet run` repeats.
    (
        "thesis",
        "--max-rows 2000000 --schedule one-cycle --batch 8192 --lr 0.004 --epochs 80",
    ),
];

const LANGUAGES: [(&str, &str); 5] = [
    ("wgsl", "wgsl"),
    ("glsl-es", "es.glsl"),
    ("glsl", "glsl"),
    ("hlsl", "hlsl"),
    ("msl", "metal"),
];

/// Held-out scenes of which no training scene has a sibling. They are left out of training altogether: a view's number decides which of its
/// pixels are drawn, so that further scenes would change the rows of all.
const FAMILIES: [&str; 8] = [
    "backdrop-held",
    "clouds-held",
    "hair-held",
    "interior-held",
    "text-held",
    "visor-held",
    "water-held",
    "window-held",
];

/// Makes everything in `models/` from the shipped scenes and the seed.
pub fn train_models() -> Outcome {
    // Built once: networks that change on the way would make cargo build it again.
    let program = Program::given_or_built("")?;
    // What an earlier run left would be in the way of extraction.
    let _ = fs::remove_dir_all(root().join("out/models"));
    program.run("extract --synthetic 600000 --out out/models/synthetic")?;
    let scenes = scene_files(|name| !FAMILIES.contains(&name))?.join(" ");
    // Many small views teach more than few large ones.
    program.run(&format!(
        "extract {scenes} --size 256x192 --augment 5 --pixels 0.12 --out out/models/peeled"
    ))?;
    for (recipe, budget) in RECIPES {
        train(&program, recipe, budget)?;
    }
    println!(
        "\nmodels/ is complete; compare with: cargo run --release -- bench data/scenes/*-held.toml --out out/bench"
    );
    Ok(())
}

/// Trains a recipe in `out/models` and puts the model, its texts and its figures into `models`.
fn train(program: &Program, recipe: &str, budget: &str) -> Outcome {
    let (folder, shipped) = (format!("out/models/{recipe}"), format!("models/{recipe}"));
    let trained = format!("{folder}/model.safetensors");
    let io = |e: std::io::Error| format!("{shipped}: {e}");
    for folder in [&folder, &shipped] {
        fs::create_dir_all(root().join(folder)).map_err(io)?;
    }
    // All scenes train: what the networks do on others, the scenes that are held out say.
    let metrics = program.captured(&format!(
        "train out/models/synthetic out/models/peeled --recipe {recipe} --out {trained} --json --split pixel {budget}"
    ))?;
    for (lang, extension) in LANGUAGES {
        program.run(&format!(
            "export {trained} --out {shipped}/model.{extension} --lang {lang}"
        ))?;
    }
    let shipped = root().join(&shipped);
    fs::write(shipped.join("metrics.json"), metrics).map_err(io)?;
    fs::copy(root().join(trained), shipped.join("model.safetensors")).map_err(io)?;
    Ok(())
}

/// Compares designs of slabs by what networks of them do on every fourth scene that is not held out, and on the same with a surface apart; they
/// learn from the others.
pub fn designs() -> Outcome {
    let program = Program::given_or_built("")?;
    let _ = fs::remove_dir_all(root().join("out/search"));
    program.run("extract --synthetic 204800 --out out/search/synthetic")?;
    let all = scene_files(|name| !name.ends_with("-held"))?;
    let (judges, training): (Vec<_>, Vec<_>) =
        all.into_iter().enumerate().partition(|(k, _)| k % 4 == 3);
    let [judges, training] =
        [judges, training].map(|list| list.into_iter().map(|(_, file)| file).collect::<Vec<_>>());
    program.run(&format!(
        "extract {} --size 128x96 --augment 3 --pixels 0.25 --out out/search/peeled",
        training.join(" ")
    ))?;
    let mut apart = Vec::new();
    for (kind, _, alpha) in apart::KINDS {
        if alpha > 0.0 {
            apart.extend(apart::scenes(kind, judges.clone())?);
        }
    }
    for (judges, out, views) in [
        (judges, "designs", ""),
        (apart, "designs/apart", "--views 1"),
    ] {
        program.run(&format!(
            "bench designs out/search/synthetic,out/search/peeled {} --max-rows 1200000 --size 256x192 {views} \
             --out docs/results/llvmpipe-xeon-2cores/{out}",
            judges.join(" ")
        ))?;
    }
    Ok(())
}

pub fn scene_file(name: &str) -> String {
    format!("data/scenes/{name}.toml")
}

/// The shipped scenes of some names, relative to the root, in the order of their names.
pub fn scene_files(is_asked: impl Fn(&str) -> bool) -> Result<Vec<String>, String> {
    files_in("data/scenes", is_asked)
}

/// The scene files of some names in a folder, as [`scene_files`].
pub fn files_in(folder: &str, is_asked: impl Fn(&str) -> bool) -> Result<Vec<String>, String> {
    let (from, folder) = (folder, root().join(folder));
    let entries = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let file = |entry: fs::DirEntry| {
        let file = entry.file_name();
        let name = file.to_str()?.strip_suffix(".toml")?;
        is_asked(name).then(|| format!("{from}/{name}.toml"))
    };
    let mut files: Vec<String> = entries.flatten().filter_map(file).collect();
    files.sort();
    Ok(files)
}
