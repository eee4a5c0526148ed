use super::{Context, bench::compared, command_line};
use crate::cli::StressArgs;
use crate::progress::Bar;
use peelnet::{Failure, MethodSpec, Model};
use peelnet_bench::report::Results;
use peelnet_bench::{
    EvalError, Machine,
    stress::{CASES, Outcome, Stressed, Subject, stress},
};
use peelnet_core::files::shown;
use serde_json::json;
use std::sync::atomic::Ordering;

pub(super) fn run(context: &Context<'_>, args: &StressArgs) -> Result<(), Failure> {
    let cases = match args.cases.clone() {
        none if none.is_empty() => CASES.iter().collect(),
        cases => cases,
    };
    let _begun = match &args.out {
        Some(out) => {
            let outputs = context.results::<Stressed>(&args.models, out)?;
            Some(context.begin_in(out, outputs, &[])?)
        }
        None => None,
    };
    let gpu = context.gpu()?;
    let own_only = !args.models.is_empty() && args.methods.is_none();
    let all = |own: &[Model]| {
        let all = Subject::all_methods().into_iter();
        // A user's own network is checked alone.
        let is_own = |m: &MethodSpec| own.iter().any(|own| own.meta.recipe.method == m.name());
        all.filter(|m| !own_only || is_own(m)).collect()
    };
    let named = args.methods.as_deref();
    let (compared, learned) = compared(context, &gpu, named, &args.models, all)?;
    let subjects: Vec<Subject> = compared
        .methods
        .iter()
        .map(|method| {
            let mut networks = learned.iter().zip(&compared.models);
            let network = networks.find(|(l, _)| l.recipe.method == method.name());
            Subject::new(method.clone(), network.map(|(l, m)| (l.clone(), m.clone())))
        })
        .collect();
    let steps = (cases.len() * subjects.len()) as u64;
    let bar = Bar::new(context.console, "stress", steps);
    let mut rows = Vec::new();
    let images = args.out.as_ref().map(|out| out.join("images"));
    // A known failure must fail with the shipped networks only.
    let strict = args.models.is_empty();
    for (case, k) in cases.iter().zip(0..) {
        let mut drawn = 0;
        let first = k * subjects.len() as u64;
        let mut notify = |method: &str| {
            if context.stop.load(Ordering::Relaxed) {
                return Err(EvalError::Interrupted);
            }
            // A case may draw every method several times.
            drawn = (drawn + 1).min(subjects.len() as u64);
            bar.set(first + drawn, steps, format!("{} with {method}", case.id));
            Ok(())
        };
        let images = images.as_deref();
        rows.extend(stress(&gpu, case, &subjects, strict, images, &mut notify)?);
    }
    drop(bar);
    let results = Results::new(Machine::describe(&gpu), command_line(), Stressed { rows });
    if let Some(out) = &args.out {
        results.write(out)?;
    }
    let console = context.console;
    console.result(|| text(&results), || json!(results))?;
    let what = match results.measured.rows_with(Outcome::Fail).count() {
        0 => return Ok(()),
        1 => "1 property does".to_owned(),
        n => format!("{n} properties do"),
    };
    let see = match &images {
        Some(images) => format!("pictures of them are in {}", shown(images)),
        None => "name a folder with --out for pictures of them".to_owned(),
    };
    Err(Failure::failed(format!("{what} not hold; {see}")))
}

/// The matrix, the known failures with their reasons, and the failures.
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
    text.push_str("\n· all properties hold   d known failures   F failures\n");
    let known = results.known_failures().rows;
    if !known.is_empty() {
        text.push_str("\nKnown failures\n");
    }
    for c in known {
        let [what, reason, place, case] = [&c[0], &c[1], &c[2], &c[3]];
        text.push_str(&format!("- {what} ({case}): {reason}\n    in {place}\n"));
    }
    let failures = results.failures();
    if !failures.rows.is_empty() {
        text.push_str(&format!("\nFailures\n{}", failures.plain()));
    }
    text + &format!("\n{}\n", results.measured.summary())
}
