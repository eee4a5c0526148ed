//! Every committed result of a machine, by one command.

use crate::{captured, product, root, run, setup::ensure_driver};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

/// What `cargo xtask measure` was asked for.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Options {
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
    /// Reads `--binary PATH`, `--name NAME`, `--into DIR` and `--only STEP,STEP`.
    pub fn parse(args: &[&str]) -> Result<Self, String> {
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
        let unknown = |name: &&String| !STEPS.iter().any(|s| s.name == name.as_str());
        match options.only.iter().find(unknown) {
            Some(name) => Err(format!(
                "measure: no step {name}; there are {}",
                STEPS.map(|s| s.name).join(", ")
            )),
            None => Ok(options),
        }
    }
}

/// A command of peelnet whose results are kept.
struct Step {
    /// Name of the folder that it writes below `out/measure`, and of the one that keeps its results.
    name: &'static str,
    /// The command, without `--out`; `HELD_OUT` and `VALIDATION` stand for scene files.
    args: &'static [&'static str],
    /// Files of its output that are kept. None: what it prints is, as JSON.
    keep: &'static [&'static str],
}

/// Scenes that no network learned from: the tables are of these.
const HELD_OUT: &str = "<held-out>";

/// Scenes that choose which setting stands for a family of methods; none of them is in a table.
const VALIDATION: &str = "<validation>";

const VALIDATION_SCENES: [&str; 3] = ["intersecting", "sixteen-050", "sixteen-random-color"];

/// One or two of each family: sixty frames of sixty settings would take an hour.
const PATH_METHODS: &str = "abuffer,painter-object,painter-triangle,wboit-eq9,mboit4,mboit6,wavelet-3:bounds=pixel,bins-8,avboit,kbuffer-4,stochastic-16,deep-thesis,nmt,dfaoit,deep-anchored-medium,deep-small,deep-medium,deep-large";

const BENCH_FILES: &[&str] = &[
    "results.json",
    "results.csv",
    "table.md",
    "pareto.svg",
    "pareto-mean.svg",
];

#[rustfmt::skip]
const STEPS: [Step; 11] = [
    Step {
        name: "stress",
        args: &["stress"],
        keep: &["stress.csv", "stress.md"],
    },
    Step {
        name: "held-out",
        args: &["bench", HELD_OUT, "--size", "512x384", "--views", "2", "--frames", "3"],
        keep: BENCH_FILES,
    },
    Step {
        name: "validation",
        args: &["bench", VALIDATION, "--size", "512x384", "--views", "1", "--frames", "3"],
        keep: &["results.json", "table.md"],
    },
    Step {
        name: "path",
        args: &["bench", "sixteen-held", "smoke-held", "--path", "--size", "256x192", "--methods", PATH_METHODS],
        keep: &["path.json", "path.csv", "path.md", "path-error.svg", "path-change.svg"],
    },
    Step {
        name: "samples",
        args: &["bench", "cups-held", "foliage-held", "--samples", "4", "--size", "256x192", "--views", "1", "--frames", "3", "--methods", PATH_METHODS],
        keep: &["results.json", "table.md"],
    },
    Step {
        name: "effects",
        args: &["bench", "--effects", "--size", "512x384", "--frames", "9"],
        keep: &["effects.json", "effects.md", "effects-layers.svg"],
    },
    Step {
        name: "scaling",
        args: &["bench", "--scaling", "--frames", "3"],
        keep: &["scaling.json", "scaling.csv", "scaling.md", "scaling-fragments.svg", "scaling-pixels.svg", "scaling-triangles.svg"],
    },
    Step {
        name: "thesis-full",
        // At a quarter of its pixels, with as many rows: the whole takes twenty minutes.
        args: &["run", "--full", "--size", "512x384"],
        keep: &["results.json", "table.md"],
    },
    Step {
        name: "extract-sbuffer",
        args: &["extract", "data/scenes/sixteen-050.toml", "--size", "1024x768", "--json"],
        keep: &[],
    },
    Step {
        name: "extract-dual",
        args: &["extract", "data/scenes/sixteen-050.toml", "--size", "1024x768", "--peel", "dual", "--json"],
        keep: &[],
    },
    Step {
        name: "extract-single",
        args: &["extract", "data/scenes/sixteen-050.toml", "--size", "1024x768", "--peel", "single", "--json"],
        keep: &[],
    },
];

/// Runs every step and puts what it keeps into a folder with the machine's name.
pub fn measure(options: &Options) -> Result<(), String> {
    let program = match &options.binary {
        // The caller's paths are relative to where it stands.
        Some(path) => fs::canonicalize(path).map_err(|e| format!("{}: {e}", path.display()))?,
        None => {
            ensure_driver()?;
            product::build()?
        }
    };
    let asked =
        |step: &&Step| options.only.is_empty() || options.only.iter().any(|n| n == step.name);
    let mut times: Vec<(&str, Duration)> = Vec::new();
    for step in STEPS.iter().filter(asked) {
        let start = Instant::now();
        take(&program, step)?;
        times.push((step.name, start.elapsed()));
    }
    let name = match &options.name {
        Some(name) => name.clone(),
        None => machine_name()?,
    };
    let into = options
        .into
        .clone()
        .unwrap_or_else(|| root().join("docs/results"));
    let into = into.join(name);
    for step in STEPS.iter().filter(asked) {
        keep(step, &into)?;
    }
    println!();
    for (name, time) in &times {
        println!("{:>7.1} s  {name}", time.as_secs_f64());
    }
    let all: Duration = times.iter().map(|t| t.1).sum();
    println!(
        "{:>7.1} s  together; results are in {}",
        all.as_secs_f64(),
        into.display()
    );
    println!(
        "next: PEELNET_UPDATE=1 cargo nextest run --workspace -E 'binary(figures) + binary(documents)', twice, puts them into the documents"
    );
    Ok(())
}

fn measured(name: &str) -> String {
    format!("out/measure/{name}")
}

/// Runs a step's command.
fn take(program: &Path, step: &Step) -> Result<(), String> {
    let out = measured(step.name);
    let _ = fs::remove_dir_all(root().join(&out));
    let mut args = Vec::new();
    for arg in step.args {
        match *arg {
            HELD_OUT => args.extend(product::held_out_scenes()?),
            VALIDATION => args.extend(VALIDATION_SCENES.map(|s| format!("data/scenes/{s}.toml"))),
            arg => args.push(arg.to_owned()),
        }
    }
    args.extend(["--out".to_owned(), out.clone(), "--quiet".to_owned()]);
    println!("\n== peelnet {}", args.join(" "));
    let mut command = Command::new(program);
    command.args(&args);
    if !step.keep.is_empty() {
        return run(&mut command, step.name);
    }
    let printed = captured(&mut command, step.name)?;
    fs::write(root().join(&out).with_extension("json"), printed)
        .map_err(|e| format!("{out}.json: {e}"))
}

/// Copies what is kept of a step.
fn keep(step: &Step, into: &Path) -> Result<(), String> {
    let copy = |from: PathBuf, to: PathBuf| {
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        fs::copy(&from, to).map_err(|e| format!("{}: {e}", from.display()))
    };
    let from = root().join(measured(step.name));
    if step.keep.is_empty() {
        let file = format!("{}.json", step.name);
        copy(from.with_extension("json"), into.join(file))?;
    }
    for file in step.keep {
        copy(from.join(file), into.join(step.name).join(file))?;
    }
    Ok(())
}

/// A name for this machine, from the first result that says what it was measured on.
fn machine_name() -> Result<String, String> {
    let files = STEPS.iter().flat_map(|s| {
        s.keep
            .iter()
            .map(|file| root().join(measured(s.name)).join(file))
    });
    for file in files.filter(|f| f.extension().is_some_and(|e| e == "json")) {
        if let Some(name) = fs::read_to_string(file).ok().as_deref().and_then(name_of) {
            return Ok(name);
        }
    }
    Err("measure: no result says which machine this is; give it a name with --name".to_owned())
}

/// `llvmpipe-epyc-2cores` for a software rasteriser, whose speed is the processor's; `nvidia-h100` for a GPU.
fn name_of(results: &str) -> Option<String> {
    let field = |key: &str| {
        let (_, rest) = results.split_once(&format!("\"{key}\": "))?;
        Some(
            rest.split(['"', ',', '\n'])
                .find(|part| !part.is_empty())?
                .to_owned(),
        )
    };
    let slug = |text: &str, words: usize| {
        let text = text.split('(').next().unwrap_or(text).to_lowercase();
        let parts = text.split(|c: char| !c.is_ascii_alphanumeric());
        let parts: Vec<_> = parts.filter(|p| !p.is_empty()).take(words).collect();
        parts.join("-")
    };
    let adapter = field("adapter")?;
    if field("adapter_kind")? != "software" {
        return Some(slug(&adapter, 4));
    }
    let cpu = field("cpu")?;
    // The maker's name says less than what it made.
    let cpu = ["AMD ", "Intel(R) ", "Intel ", "Apple "]
        .iter()
        .find_map(|maker| cpu.strip_prefix(maker))
        .unwrap_or(&cpu);
    Some(format!(
        "{}-{}-{}cores",
        slug(&adapter, 1),
        slug(cpu, 2),
        field("cores")?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_have_names() {
        let results = |cpu: &str, adapter: &str, kind: &str| {
            format!(
                "{{\n  \"machine\": {{\n    \"cpu\": \"{cpu}\",\n    \"cores\": 2,\n    \"adapter\": \"{adapter}\",\n    \"adapter_kind\": \"{kind}\"\n  }}\n}}"
            )
        };
        let llvmpipe = results("AMD EPYC", "llvmpipe (LLVM 15.0.6, 256 bits)", "software");
        assert_eq!(name_of(&llvmpipe).as_deref(), Some("llvmpipe-epyc-2cores"));
        let gpu = results("AMD EPYC", "NVIDIA H100 80GB HBM3", "discrete");
        assert_eq!(name_of(&gpu).as_deref(), Some("nvidia-h100-80gb-hbm3"));
        assert_eq!(name_of("{}"), None);
    }

    #[test]
    fn options_are_read() {
        let options = Options::parse(&["--binary", "p", "--only", "stress,effects"]);
        let want = Options {
            binary: Some("p".into()),
            only: vec!["stress".to_owned(), "effects".to_owned()],
            ..Options::default()
        };
        assert_eq!(options, Ok(want));
        for wrong in [&["--binary"][..], &["--fast", "1"], &["--only", "nothing"]] {
            assert!(Options::parse(wrong).is_err(), "{wrong:?}");
        }
    }
}
