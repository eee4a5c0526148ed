//! `peelnet stress`: the hard cases.

use super::{Context, bench::chosen};
use crate::cli::StressArgs;
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::parse::{MethodList, command_line, shown};
use crate::progress::Bar;
use peelnet_eval::{
    EvalError, Machine,
    stress::{CASES, Case, Outcome, Stressed, Subject, stress},
};
use peelnet_render::MethodSpec;
use peelnet_report::Results;
use serde_json::json;
use std::sync::atomic::Ordering;

pub(super) fn run(context: &Context<'_>, args: &StressArgs) -> Result<(), Failure> {
    let cases = cases(&args.cases)?;
    if let Some(out) = &args.out {
        let mut outputs = Outputs::new(context, &args.models);
        outputs.results("--out", out, Results::<Stressed>::FILES)?;
        outputs.pictures("--out", &out.join("images"))?;
        outputs.begin(&[])?;
    }
    let gpu = context.gpu()?;
    let own_only = !args.models.is_empty() && matches!(args.methods, MethodList::All);
    let all = || -> Vec<MethodSpec> {
        let all = Subject::all_methods().into_iter();
        // A user's own network is judged alone.
        all.filter(|m| !own_only || m.needs_model()).collect()
    };
    let chosen = chosen(context, &gpu, &args.methods, &args.models, all)?;
    let own: Vec<&str> = if own_only {
        let loaded = chosen.models.iter().take(args.models.len());
        loaded.map(|m| m.meta.recipe.method).collect()
    } else {
        Vec::new()
    };
    let subjects: Vec<Subject> = chosen
        .methods
        .iter()
        .filter(|m| !own_only || own.contains(&m.name()))
        .map(|method| {
            let networks = chosen.learned.iter().zip(&chosen.models);
            let mut networks = networks.filter(|(l, _)| l.recipe.method == method.name());
            let learned = networks.next().map(|(l, m)| (l.clone(), m.clone()));
            Subject::new(method.clone(), learned)
        })
        .collect();
    let steps = (cases.len() * subjects.len()) as u64;
    let bar = Bar::new(context.console, "stress", steps);
    let mut rows = Vec::new();
    let images = args.out.as_ref().map(|out| out.join("images"));
    for (case, k) in cases.iter().zip(0..) {
        let mut drawn = 0;
        let first = k * subjects.len() as u64;
        // A declared flaw must fail with the shipped networks only.
        let strict = args.models.is_empty();
        let mut notify = |method: &str| {
            if context.stop.load(Ordering::Relaxed) {
                return Err(EvalError::Interrupted);
            }
            // A case may draw every method several times.
            drawn = (drawn + 1).min(subjects.len() as u64);
            bar.set(first + drawn, steps, format!("{} with {method}", case.id));
            Ok(())
        };
        rows.extend(stress(
            &gpu,
            case,
            &subjects,
            strict,
            images.as_deref(),
            &mut notify,
        )?);
    }
    drop(bar);
    let results = Results::new(Machine::of(&gpu), command_line(), Stressed { rows });
    if let Some(out) = &args.out {
        results.write(out)?;
    }
    context
        .console
        .result(|| text(&results), || json!(results))?;
    let failures = results.measured.of(Outcome::Fail).count();
    if failures > 0 {
        let see = match &args.out {
            Some(out) => format!("pictures of them are in {}", shown(&out.join("images"))),
            None => "name a folder with --out for pictures of them".to_owned(),
        };
        return Err(Failure::Failed(format!(
            "{failures} {} not hold; {see}",
            if failures == 1 {
                "property does"
            } else {
                "properties do"
            }
        )));
    }
    Ok(())
}

/// The matrix, the flaws with their reasons, and the failures.
fn text(results: &Results<Stressed>) -> String {
    let mut text = String::new();
    let mut matrix = results.matrix();
    // Letters, so that the table fits a terminal.
    for (heading, letter) in matrix.headings.iter_mut().skip(1).zip('a'..) {
        text.push_str(&format!("{letter} {heading}\n"));
        *heading = letter.to_string();
    }
    text.push('\n');
    text.push_str(&matrix.plain());
    text.push_str("\n· all properties hold   d declared flaws   F failures\n");
    let flaws = results.flaws().rows;
    if !flaws.is_empty() {
        text.push_str("\nDeclared flaws\n");
    }
    for c in flaws {
        text.push_str(&format!(
            "- {} ({}): {}\n    in {}\n",
            c[0], c[3], c[1], c[2]
        ));
    }
    let failures = results.failures();
    if !failures.rows.is_empty() {
        text.push_str(&format!("\nFailures\n{}", failures.plain()));
    }
    text.push_str(&format!("\n{}\n", results.measured.summary()));
    text
}

/// The cases of these names; all without any.
fn cases(names: &[String]) -> Result<Vec<&'static Case>, Failure> {
    let known = |name: &String| {
        CASES.iter().find(|c| c.id == name).ok_or_else(|| {
            let ids: Vec<&str> = CASES.iter().map(|c| c.id).collect();
            Failure::Usage(format!(
                "there is no case '{name}'; there are: {}",
                ids.join(", ")
            ))
        })
    };
    if names.is_empty() {
        return Ok(CASES.iter().collect());
    }
    names.iter().map(known).collect()
}
