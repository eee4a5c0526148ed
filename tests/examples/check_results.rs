//! Whether the committed results are complete: `cargo xtask results --check`, before a release.
//!
//! Tests compare the documents with the committed rows; that every method, hard case and effect has its rows is asked for here alone,
//! so that adding a method needs no benchmark.

use peelnet_eval::{
    bench::Bench,
    effects::Effects,
    scaling::Scaling,
    stress::{CASES, Subject},
};
use peelnet_render::MethodSpec;
use peelnet_report::{ReportError, Results};
use peelnet_scene::Effect;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::ExitCode,
};

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    match missing(&root) {
        Ok(missing) if missing.is_empty() => {
            println!("the committed results are complete");
            ExitCode::SUCCESS
        }
        Ok(missing) => {
            for line in &missing {
                println!("{line}");
            }
            eprintln!("error: {} rows are missing", missing.len());
            ExitCode::FAILURE
        }
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}

/// A line for everything that the committed results of any machine lack.
fn missing(root: &Path) -> Result<Vec<String>, ReportError> {
    let results = root.join("docs/results");
    let mut machines: Vec<PathBuf> = std::fs::read_dir(&results)
        .map_err(|source| ReportError::Io {
            path: results.clone(),
            action: "read",
            source,
        })?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir())
        .collect();
    machines.sort();
    let mut lines = Vec::new();
    for machine in machines {
        let mut add = |file: &str, what: Vec<String>| {
            let file = machine.join(file);
            let shown = file.strip_prefix(root).unwrap_or(&file).display();
            lines.extend(what.iter().map(|what| format!("{shown}: {what}")));
        };
        add("held-out/results.json", bench(&machine)?);
        add("stress/stress.csv", stress(&machine)?);
        add("effects/effects.json", effects(&machine, root)?);
        add("scaling/scaling.json", scaling(&machine)?);
    }
    Ok(lines)
}

fn text(path: &Path) -> Result<String, ReportError> {
    std::fs::read_to_string(path).map_err(|source| ReportError::Io {
        path: path.to_owned(),
        action: "read",
        source,
    })
}

/// Every method on every point of its curve.
fn bench(machine: &Path) -> Result<Vec<String>, ReportError> {
    let run = Results::<Bench>::read(&machine.join("held-out/results.json"))?;
    let there: BTreeSet<&str> = run
        .measured
        .rows
        .iter()
        .map(|r| r.method.as_str())
        .collect();
    let all = MethodSpec::compared().into_iter().map(|m| m.to_string());
    Ok(all.filter(|m| !there.contains(m.as_str())).collect())
}

/// Every method in every hard case that judges it.
fn stress(machine: &Path) -> Result<Vec<String>, ReportError> {
    let rows = text(&machine.join("stress/stress.csv"))?;
    let mut lines = Vec::new();
    for method in Subject::all_methods() {
        for case in CASES {
            if case.judges(&method) && !rows.contains(&format!("\n{method},{},", case.id)) {
                lines.push(format!("{method} in {}", case.id));
            }
        }
    }
    Ok(lines)
}

/// Every effect, in the measurement and in the table of docs/effects.md.
fn effects(machine: &Path, root: &Path) -> Result<Vec<String>, ReportError> {
    let run = Results::<Effects>::read(&machine.join("effects/effects.json"))?;
    let page = text(&root.join("docs/effects.md"))?;
    let mut lines = Vec::new();
    for effect in Effect::ALL.map(Effect::name) {
        if !run.measured.costs.iter().any(|c| c.effect == effect) {
            lines.push(effect.to_owned());
        }
        if !page.contains(&format!("`{effect}`")) {
            lines.push(format!("{effect} is not in docs/effects.md"));
        }
    }
    Ok(lines)
}

/// Every method once, whatever its settings.
fn scaling(machine: &Path) -> Result<Vec<String>, ReportError> {
    let run = Results::<Scaling>::read(&machine.join("scaling/scaling.json"))?;
    let measured = run.measured.rows.iter().map(|r| &r.method);
    let left_out = run.measured.left_out.iter().map(|l| &l.method);
    let there: BTreeSet<&String> = measured.chain(left_out).collect();
    let mut all = MethodSpec::curve();
    all.dedup_by_key(|m| m.name());
    let names = all.into_iter().map(|m| m.to_string());
    Ok(names.filter(|name| !there.contains(name)).collect())
}
