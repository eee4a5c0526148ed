//! What runs the program itself: the demo, and the shipped networks.

use crate::setup::ensure_driver;
use crate::{captured, cargo, root, run};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiles the release build of `peelnet`, with cargo's own progress, and returns the program.
pub fn build() -> Result<PathBuf, String> {
    let args = ["build", "--release", "--package", "peelnet"];
    run(cargo().args(args), "cargo build")?;
    // This program lies in target/debug.
    let here = env::current_exe().map_err(|e| format!("this program cannot be found: {e}"))?;
    let target = here.ancestors().nth(2).unwrap_or(&here);
    let program = format!("peelnet{}", env::consts::EXE_SUFFIX);
    Ok(target.join("release").join(program))
}

pub fn demo(full: bool) -> Result<(), String> {
    ensure_driver()?;
    println!("Compiling peelnet: minutes the first time.");
    let program = build()?;
    let out = if full { "out/full" } else { "out/demo" };
    let mut command = Command::new(program);
    command.args(["run", "--out", out]);
    if full {
        command.arg("--full");
    }
    run(&mut command, "demo")?;
    println!(
        "\nThe report: {}",
        root().join(out).join("report.html").display()
    );
    Ok(())
}

/// Training against PyTorch, transparency against VTK and pygfx.
pub fn peers() -> Result<(), String> {
    ["train", "transparency"].into_iter().try_for_each(|name| {
        let script = format!("benches/peers/{name}.py");
        run(Command::new("python3").arg(script), "peers")
    })
}

/// The recipes, each with the budget that a search (benches/budgets.py) chose where it is not the recipe's own. All learn from the same data.
const RECIPES: [(&str, &[&str]); 8] = [
    // The recipe's own are shorter, for networks of one's own scenes in a minute.
    ("small", &["--epochs", "40"]),
    ("medium", &["--epochs", "80"]),
    ("large", &["--epochs", "80"]),
    ("anchored-small", &["--lr", "0.016", "--epochs", "80"]),
    ("anchored-medium", &["--lr", "0.016", "--epochs", "80"]),
    ("nmt", &["--max-rows", "6000000"]),
    ("dfaoit", &[]),
    // The recipe's own are the thesis's published settings, which `peelnet run` repeats.
    ("thesis", &THESIS_BUDGET),
];

const THESIS_BUDGET: [&str; 10] = [
    "--max-rows",
    "2000000",
    "--schedule",
    "one-cycle",
    "--batch",
    "8192",
    "--lr",
    "0.004",
    "--epochs",
    "80",
];

/// Where the table of designs is kept, and the one that judges them on the five other scenes.
const DESIGNS: [&str; 2] = [
    "docs/results/llvmpipe-xeon-2cores/designs",
    "docs/results/llvmpipe-xeon-2cores/designs/across",
];

/// Training scenes of five kinds, which judge designs that were trained without them.
const ACROSS: [&str; 5] = ["boxes", "cups", "foliage", "panes", "smoke-30"];

/// Rows that the search of designs uses of its datasets, at most.
const SEARCH_ROWS: &str = "1200000";

/// Scenes of the search: those that are trained on, and every fourth, that choices are made by. Held-out scenes choose nothing.
fn search_scenes() -> Result<[Vec<String>; 2], String> {
    let all = scene_files()?;
    let all = all.into_iter().filter(|s| !s.ends_with("-held.toml"));
    let (validation, training): (Vec<_>, Vec<_>) = all.enumerate().partition(|(k, _)| k % 4 == 3);
    Ok([training, validation].map(|list| list.into_iter().map(|(_, scene)| scene).collect()))
}

fn step(program: &Path, args: &[&str]) -> Result<(), String> {
    println!("\n== peelnet {}", args.join(" "));
    run(Command::new(program).args(args), args[0])
}

fn peel_for_search(program: &Path, scenes: &[String], folder: &str) -> Result<(), String> {
    let mut args = vec!["extract"];
    args.extend(scenes.iter().map(String::as_str));
    args.extend(["--size", "128x96", "--augment", "3", "--pixels", "0.25"]);
    args.extend(["--out", folder]);
    step(program, &args)
}

/// Where the datasets that designs learn from lie.
const SEARCH_DATA: [&str; 2] = ["out/search/synthetic", "out/search/peeled"];

/// Compares designs of slabs, on the data and scenes of the search.
pub fn designs() -> Result<(), String> {
    ensure_driver()?;
    let program = build()?;
    let _ = std::fs::remove_dir_all(root().join("out/search"));
    let [training, validation] = search_scenes()?;
    let [synthetic, peeled] = SEARCH_DATA;
    let lists = ["extract", "--synthetic", "204800", "--out", synthetic];
    step(&program, &lists)?;
    peel_for_search(&program, &training, peeled)?;
    let data = SEARCH_DATA.join(",");
    judge_designs(&program, &validation, &data, DESIGNS[0])?;
    // The validation scenes resemble one another. These five do not, and are apart from what is trained on in a second run.
    let (across, peeled) = (ACROSS.map(scene_file), "out/search/peeled-across");
    let all = training.into_iter().chain(validation);
    let others: Vec<String> = all.filter(|s| !across.contains(s)).collect();
    peel_for_search(&program, &others, peeled)?;
    let data = [synthetic, peeled].join(",");
    judge_designs(&program, &across, &data, DESIGNS[1])
}

fn judge_designs(
    program: &Path,
    scenes: &[String],
    data: &str,
    folder: &str,
) -> Result<(), String> {
    let mut args = vec!["bench"];
    args.extend(scenes.iter().map(String::as_str));
    args.extend(["--designs", data, "--max-rows", SEARCH_ROWS]);
    args.extend(["--size", "256x192", "--out", folder]);
    step(program, &args)
}

/// Held-out scenes of which no training scene has a sibling.
const FAMILIES: [&str; 4] = ["clouds-held", "hair-held", "interior-held", "text-held"];

/// Makes everything in `models/` from the shipped scenes and the seed.
pub fn train_models() -> Result<(), String> {
    ensure_driver()?;
    // Built once: networks that change on the way would make cargo build it again.
    let program = build()?;
    // What an earlier run left would be in the way of extraction.
    let _ = std::fs::remove_dir_all(root().join("out/models"));
    let scenes = scene_files()?;
    // Families of their own are left out altogether: a view's number decides which of its pixels are drawn, so that further
    // scenes would change the rows of all.
    let families = FAMILIES.map(scene_file);
    let scenes: Vec<String> = scenes
        .into_iter()
        .filter(|s| !families.contains(s))
        .collect();
    let (synthetic, peeled) = ("out/models/synthetic", "out/models/peeled");
    let lists = ["extract", "--synthetic", "600000", "--out", synthetic];
    step(&program, &lists)?;
    let mut peel = vec!["extract"];
    peel.extend(scenes.iter().map(String::as_str));
    // Many small views teach more than few large ones.
    peel.extend(["--size", "256x192", "--augment", "5", "--pixels", "0.12"]);
    peel.extend(["--out", peeled]);
    step(&program, &peel)?;
    for (recipe, budget) in RECIPES {
        finish(&program, recipe, &[synthetic, peeled], budget)?;
    }
    println!(
        "\nmodels/ is complete; compare with: cargo run --release -- bench data/scenes/*-held.toml --out out/bench"
    );
    Ok(())
}

/// The languages of exported texts, and how their files end.
const LANGUAGES: [(&str, &str); 5] = [
    ("wgsl", "wgsl"),
    ("glsl-es", "es.glsl"),
    ("glsl", "glsl"),
    ("hlsl", "hlsl"),
    ("msl", "metal"),
];

/// Trains a recipe in `out/models` and puts the model, its texts and its figures into `models`.
fn finish(program: &Path, recipe: &str, data: &[&str], more: &[&str]) -> Result<(), String> {
    let made = format!("out/models/{recipe}/model.safetensors");
    let shipped = root().join("models").join(recipe);
    let io = |e: std::io::Error| format!("models/{recipe}: {e}");
    std::fs::create_dir_all(root().join(format!("out/models/{recipe}"))).map_err(io)?;
    std::fs::create_dir_all(&shipped).map_err(io)?;
    let mut args = vec!["train"];
    args.extend(data);
    // All scenes train: what the networks do on others, the scenes that are held out say.
    args.extend([
        "--recipe", recipe, "--out", &made, "--json", "--split", "pixel",
    ]);
    args.extend(more);
    println!("\n== peelnet {}", args.join(" "));
    let metrics = captured(
        Command::new(program).args(&args),
        &format!("training {recipe}"),
    )?;
    for (lang, extension) in LANGUAGES {
        let text = format!("models/{recipe}/model.{extension}");
        let args = ["export", &made, "--out", &text, "--lang", lang];
        println!("== peelnet {}", args.join(" "));
        run(Command::new(program).args(args), "export")?;
    }
    std::fs::write(shipped.join("metrics.json"), metrics).map_err(io)?;
    std::fs::copy(root().join(made), shipped.join("model.safetensors")).map_err(io)?;
    Ok(())
}

/// The shipped scenes that no network learns from.
pub fn held_out_scenes() -> Result<Vec<String>, String> {
    let mut files = scene_files()?;
    files.retain(|file| file.ends_with("-held.toml"));
    Ok(files)
}

fn scene_file(name: &str) -> String {
    format!("data/scenes/{name}.toml")
}

/// The shipped scenes, relative to the root, in the order of their names.
fn scene_files() -> Result<Vec<String>, String> {
    let folder = root().join("data/scenes");
    let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<String> = entries
        .flatten()
        .filter_map(|e| e.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .map(|name| format!("data/scenes/{name}"))
        .collect();
    files.sort();
    Ok(files)
}
