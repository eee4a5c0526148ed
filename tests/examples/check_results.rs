//! Whether the committed tables are complete: `cargo xtask results --check`, before a release.
//!
//! A test compares the documents with the tables; that every method, hard case and effect has its rows is asked for here alone, so that adding a
//! method needs no benchmark.

use peelnet_eval::stress::{CASES, Subject};
use peelnet_render::{METHODS, MethodSpec};
use peelnet_scene::Effect;
use std::{error::Error, fs, path::Path, process::ExitCode};

fn main() -> ExitCode {
    match missing() {
        Ok(missing) if missing.is_empty() => {
            println!("the committed results are complete");
            ExitCode::SUCCESS
        }
        Ok(missing) => {
            println!("{}", missing.join("\n"));
            eprintln!("error: {} rows are missing", missing.len());
            ExitCode::FAILURE
        }
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}

/// Cells of a step's table, of whichever machine has it.
fn table(step: &str, file: &str) -> Result<Vec<Vec<String>>, Box<dyn Error>> {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    for machine in fs::read_dir(&results)? {
        let Ok(text) = fs::read_to_string(machine?.path().join(step).join(file)) else {
            continue;
        };
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect();
        let lines = text.lines().filter(|line| line.starts_with('|'));
        return Ok(lines.map(cells).collect());
    }
    Err(format!("{}: no machine has {step}/{file}", results.display()).into())
}

/// A line for every row that the committed results lack.
fn missing() -> Result<Vec<String>, Box<dyn Error>> {
    let mut lines = Vec::new();
    let mut require = |file: &str, column: usize, names: Vec<String>| {
        let (step, name) = file.split_once('/').unwrap_or((file, ""));
        let table = table(step, name)?;
        let has = |wanted: &String| table.iter().any(|row| row.get(column) == Some(wanted));
        let absent = names.into_iter().filter(|name| !has(name));
        lines.extend(absent.map(|name| format!("{file}: {name}")));
        Ok::<_, Box<dyn Error>>(())
    };
    let named = |specs: Vec<MethodSpec>| specs.iter().map(ToString::to_string).collect();
    require("held-out/table.md", 1, named(MethodSpec::compared()))?;
    // Every method once, whatever its settings.
    let drawn = METHODS.iter().filter(|m| m.cpu_only.is_none());
    let defaults = drawn.filter_map(|m| MethodSpec::points(m).next());
    require("scaling/scaling.md", 1, named(defaults.collect()))?;
    let effects = Effect::ALL.map(|e| e.name().to_owned()).to_vec();
    require("effects/effects.md", 2, effects)?;
    // Every method in every hard case that judges it: the cells of others are empty.
    let stress = table("stress", "stress.md")?;
    let [head, rows @ ..] = &stress[..] else {
        return Err("stress/stress.md has no table".into());
    };
    for method in Subject::all_methods() {
        let name = method.to_string();
        let row = rows.iter().find(|row| row.get(1) == Some(&name));
        for case in CASES.iter().filter(|case| case.judges(&method)) {
            let column = head.iter().position(|cell| cell == case.id);
            let cell = row.zip(column).and_then(|(row, k)| row.get(k));
            if cell.is_none_or(|cell| cell.is_empty()) {
                lines.push(format!("stress/stress.md: {name} in {}", case.id));
            }
        }
    }
    Ok(lines)
}
