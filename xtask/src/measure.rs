//! Every committed result of a machine, by one command.

use crate::{
    Outcome,
    product::{Program, held_out_scenes, scene_file},
    root, run,
};
use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

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

/// What `cargo xtask measure` was asked for.
#[derive(Default)]
struct Options {
    /// A program that was built elsewhere; built here otherwise.
    binary: Option<PathBuf>,
    /// The folder of results; made from the machine's adapter and processor otherwise.
    name: Option<String>,
    /// Where that folder lies; `docs/results` otherwise.
    into: Option<PathBuf>,
    /// The steps to take; all of them where there are none.
    only: Vec<String>,
}

impl Options {
    fn parse(args: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        for pair in args.chunks(2) {
            let &[flag, value] = pair else {
                return Err(format!("measure: {} needs a value", pair[0]));
            };
            match flag {
                "--binary" => options.binary = Some(value.into()),
                "--name" => options.name = Some(value.to_owned()),
                "--into" => options.into = Some(value.into()),
                "--only" => options.only = value.split(',').map(str::to_owned).collect(),
                _ => return Err(format!("measure: unknown option {flag}")),
            }
        }
        let names = STEPS.map(|s| s.name);
        let mut only = options.only.iter();
        match only.find(|name| !names.contains(&name.as_str())) {
            Some(name) => Err(format!(
                "measure: no step {name}; there are {}",
                names.join(", ")
            )),
            None => Ok(options),
        }
    }
}

/// Runs every step and puts what it keeps into a folder with the machine's name.
pub fn measure(args: &[&str]) -> Outcome {
    let options = Options::parse(args)?;
    let program = match &options.binary {
        // The caller's paths are relative to where it stands.
        Some(path) => {
            Program(fs::canonicalize(path).map_err(|e| format!("{}: {e}", path.display()))?)
        }
        None => Program::build()?,
    };
    let is_asked =
        |step: &&Step| options.only.is_empty() || options.only.iter().any(|n| n == step.name);
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
        times += &format!("{:>7.1} s  {}\n", begin.elapsed().as_secs_f64(), step.name);
    }
    let name = options.name.clone().map_or_else(machine_name, Ok)?;
    let into = options.into.clone();
    let into = into.unwrap_or_else(|| root().join("docs/results"));
    let into = into.join(name);
    for step in STEPS.iter().filter(is_asked) {
        keep(step, &into)?;
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

/// A name for this machine, from the first result that says what it was measured on.
fn machine_name() -> Result<String, String> {
    for step in &STEPS {
        let written = fs::read_dir(root().join(measured(step))).into_iter();
        let paths = written.flatten().flatten().map(|entry| entry.path());
        for file in paths.filter(|path| path.extension().is_some_and(|e| e == "json")) {
            if let Some(name) = fs::read_to_string(file).ok().as_deref().and_then(name_of) {
                return Ok(name);
            }
        }
    }
    Err("measure: no result says which machine this is; give it a name with --name".to_owned())
}

/// `llvmpipe-epyc-2cores` for a software rasteriser, whose speed is the processor's; `nvidia-h100` for a GPU.
fn name_of(results: &str) -> Option<String> {
    let field = |key: &str| {
        let (_, rest) = results.split_once(&format!("\"{key}\": "))?;
        rest.split(['"', ',', '\n']).find(|part| !part.is_empty())
    };
    let slug = |text: &str, words: usize| {
        let text = text.split('(').next().unwrap_or(text).to_lowercase();
        let parts = text.split(|c: char| !c.is_ascii_alphanumeric());
        let parts: Vec<_> = parts.filter(|p| !p.is_empty()).take(words).collect();
        parts.join("-")
    };
    let adapter = field("adapter")?;
    if field("adapter_kind")? != "software" {
        return Some(slug(adapter, 4));
    }
    let cpu = field("cpu")?;
    // The maker's name says less than what it made.
    let cpu = ["AMD ", "Intel(R) ", "Intel ", "Apple "]
        .iter()
        .find_map(|maker| cpu.strip_prefix(maker))
        .unwrap_or(cpu);
    Some(format!(
        "{}-{}-{}cores",
        slug(adapter, 1),
        slug(cpu, 2),
        field("cores")?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_have_names() {
        let name = |adapter: &str, kind: &str| {
            name_of(&format!(
                "{{\n  \"machine\": {{\n    \"cpu\": \"AMD EPYC\",\n    \"cores\": 2,\n    \"adapter\": \"{adapter}\",\n    \"adapter_kind\": \"{kind}\"\n  }}\n}}"
            ))
        };
        let llvmpipe = name("llvmpipe (LLVM 15.0.6, 256 bits)", "software");
        assert_eq!(llvmpipe.as_deref(), Some("llvmpipe-epyc-2cores"));
        let gpu = name("NVIDIA H100 80GB HBM3", "discrete");
        assert_eq!(gpu.as_deref(), Some("nvidia-h100-80gb-hbm3"));
        assert_eq!(name_of("{}"), None);
    }
}
