//! Every committed result of a machine, by one command.

use crate::{
    Outcome,
    product::{Program, held_out_scenes, scene_file},
    root, run,
};
use std::{fs, path::Path, time::Instant};

/// A command of peelnet whose results are kept.
struct Step {
    /// Name of the folder that it writes below `out/measure`, and of the one that keeps its results.
    name: &'static str,
    /// The command, without `--out`; the names in angle brackets stand for what [`filled`] puts there.
    line: &'static str,
    /// Files of its output that are kept. None: what it prints is, as JSON.
    keep: &'static str,
}

const fn step(name: &'static str, line: &'static str, keep: &'static str) -> Step {
    Step { name, line, keep }
}

/// Scenes that choose which setting stands for a family of methods; none of them is in a table.
const VALIDATION_SCENES: [&str; 3] = ["intersecting", "sixteen-050", "sixteen-random-color"];

/// One or two of each family: sixty frames of sixty settings would take an hour.
const PATH_METHODS: &str = "abuffer,painter-object,painter-triangle,wboit-eq9,mboit4,mboit6,wavelet-3:bounds=pixel,bins-8,avboit,kbuffer-4,stochastic-16,deep-thesis,nmt,dfaoit,deep-anchored-medium,deep-small,deep-medium,deep-large";

const STEPS: [Step; 11] = [
    step("stress", "stress", "stress.csv.xz stress.md"),
    step(
        "held-out",
        "bench <held-out> --size 512x384 --views 2 --frames 3",
        "results.json.xz table.md pareto.svg pareto-mean.svg",
    ),
    step(
        "validation",
        "bench <validation> --size 512x384 --views 1 --frames 3",
        "results.json.xz table.md",
    ),
    step(
        "path",
        "bench sixteen-held smoke-held --path --size 256x192 --methods <path>",
        "path.csv path.md path-error.svg path-change.svg",
    ),
    step(
        "samples",
        "bench cups-held foliage-held --samples 4 --size 256x192 --views 1 --frames 3 --methods <path>",
        "table.md",
    ),
    step(
        "effects",
        "bench --effects --size 512x384 --frames 9",
        "effects.md effects-layers.svg",
    ),
    step(
        "scaling",
        "bench --scaling --frames 3",
        "scaling.md scaling-fragments.svg scaling-pixels.svg scaling-triangles.svg",
    ),
    // At a quarter of its pixels, with as many rows: the whole takes twenty minutes.
    step(
        "thesis-full",
        "run --full --size 512x384",
        "results.json.xz table.md",
    ),
    step("extract-sbuffer", "<extract>", ""),
    step("extract-dual", "<extract> --peel dual", ""),
    step("extract-single", "<extract> --peel single", ""),
];

/// A step's command with scenes and methods in their places.
fn filled(step: &Step) -> Result<String, String> {
    let extract = "extract data/scenes/sixteen-050.toml --size 1024x768 --json";
    let line = step
        .line
        .replace("<held-out>", &held_out_scenes()?.join(" "))
        .replace("<validation>", &VALIDATION_SCENES.map(scene_file).join(" "))
        .replace("<path>", PATH_METHODS)
        .replace("<extract>", extract);
    Ok(format!("{line} --out {} --quiet", measured(step)))
}

fn measured(step: &Step) -> String {
    format!("out/measure/{}", step.name)
}

/// Runs the steps of these names, or every step, and puts what they keep into a folder of the machine's name. PEELNET_BINARY is a program that
/// is built already.
pub fn measure(machine: &str, names: &[&str]) -> Outcome {
    let known = STEPS.map(|s| s.name);
    if let Some(unknown) = names.iter().find(|name| !known.contains(name)) {
        let known = known.join(", ");
        return Err(format!("measure has no step {unknown}: {known}"));
    }
    let program = Program::given_or_built("")?;
    let is_asked = |step: &&Step| names.is_empty() || names.contains(&step.name);
    let into = root().join("docs/results").join(machine);
    let mut times = String::new();
    let begin = Instant::now();
    for step in STEPS.iter().filter(is_asked) {
        let begin = Instant::now();
        let out = root().join(measured(step));
        let _ = fs::remove_dir_all(&out);
        let line = filled(step)?;
        if step.keep.is_empty() {
            let printed = program.captured(&line)?;
            let file = out.with_extension("json");
            fs::write(&file, printed).map_err(|e| format!("{}: {e}", file.display()))?;
        } else {
            program.run(&line)?;
        }
        keep(step, &into)?;
        times += &format!("{:>7.1} s  {}\n", begin.elapsed().as_secs_f64(), step.name);
    }
    let together = begin.elapsed().as_secs_f64();
    println!(
        "\n{times}{together:>7.1} s  together; results are in {}",
        into.display()
    );
    println!(
        "next: PEELNET_UPDATE=1 cargo nextest run -p peelnet_tests generated_tables puts them into the documents"
    );
    Ok(())
}

/// Copies what is kept of a step.
fn keep(step: &Step, into: &Path) -> Outcome {
    let from = root().join(measured(step));
    let mut files: Vec<_> = step
        .keep
        .split(' ')
        .map(|file| (from.join(file), into.join(step.name).join(file)))
        .collect();
    if step.keep.is_empty() {
        let file = format!("{}.json", step.name);
        files = vec![(from.with_extension("json"), into.join(file))];
    }
    for (from, to) in files {
        let folder = to.parent().unwrap_or(into);
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        // Rows are kept packed: a name of that kind stands for the file that was written.
        let [from, plain] = [from, to.clone()].map(|path| match path.extension() {
            Some(end) if end == "xz" => path.with_extension(""),
            _ => path,
        });
        fs::copy(&from, &plain).map_err(|e| format!("{}: {e}", from.display()))?;
        if plain != to {
            run(&format!("xz -9 --force {}", plain.display()))?;
        }
    }
    Ok(())
}
