//! `peelnet bench`: error against time for many methods, and its commands: how that grows, what effects
//! cost, and methods along a path.

mod designs;

use super::{Context, command_line, few};
use crate::cli::{BenchArgs, BenchCommand, CompareArgs, EffectsArgs, PathArgs, ScalingArgs};
use crate::progress::Bar;
use peelnet::{Compared, Failure, Model};
use peelnet_bench::report::{Measurement, Results};
use peelnet_bench::{
    EvalError, Machine, Partial,
    bench::{Bench, Progress, bench_watched},
    compare::{Plan, check_pictures, drawn_otherwise},
    effects::{self, Effects},
    json_hash,
    path::{self, Along},
    rows::Rows,
    scaling::{self, Scaling},
};
use peelnet_core::files::{error_line, shown};
use peelnet_render::gpu::Gpu;
use peelnet_render::{LearnedWeight, MethodSpec};
use peelnet_scene::{Scene, suite};
use serde_json::json;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    match &args.command {
        Some(BenchCommand::Path(args)) => along_path(context, args),
        Some(BenchCommand::Scaling(args)) => scale(context, args),
        Some(BenchCommand::Effects(args)) => measure_effects(context, args),
        Some(BenchCommand::Designs(args)) => designs::run(context, args),
        Some(BenchCommand::Redraw { out, check }) => redraw(context, out, *check),
        None => (args.comparison.iter()).try_for_each(|args| compare(context, args)),
    }
}

fn compare(context: &Context<'_>, args: &CompareArgs) -> Result<(), Failure> {
    let pictures = &args.pictures;
    let (out, models) = (&pictures.compared.out, &pictures.compared.models);
    let mut outputs = context.results::<Bench>(pictures.scenes.iter().chain(models), out)?;
    outputs.folder("--out", out, [(Partial::FILE, Partial::KIND)])?;
    let scenes = context.scenes(&pictures.scenes)?;
    let _begun = context.begin_in(out, outputs, &scenes)?;
    let plan = Plan {
        samples: pictures.samples,
        views: args.views.map(|n| n as usize),
        frames: args.frames,
        ..Plan::new(pictures.size, &[])
    };
    let named = pictures.compared.methods.as_deref();
    let folder = Some((out.as_path(), args.resume));
    let results = measure(context, &scenes, named, models, plan, folder)?;
    results.write(out)?;
    Partial::discard(out);
    warn_of_opaque(context, &results);
    print(context, &results)
}

const RESULTS: &str = "results.json";

/// Draws older results again. That ends no interrupted run: its finished views stay.
fn redraw(context: &Context<'_>, out: &Path, check: bool) -> Result<(), Failure> {
    if check {
        let results = read(out)?;
        let others = drawn_otherwise(&results.measured.rows);
        return match &others[..] {
            [] => print(context, &results),
            _ => Err(Failure::failed(format!(
                "{}: of other shaders or networks than this program's: {}; measure them again",
                shown(&out.join(RESULTS)),
                others.join(", ")
            ))),
        };
    }
    let mut outputs = context.results::<Bench>(&[], out)?;
    outputs.folder("--out", out, [(Partial::FILE, Partial::KIND)])?;
    let _begun = context.begin_in(out, outputs, &[])?;
    let results = read(out)?;
    check_pictures(&results.measured.rows, out)?;
    // What else a user put into that file stays.
    results.write_but(RESULTS, out)?;
    print(context, &results)
}

fn print(context: &Context<'_>, results: &Results<Bench>) -> Result<(), Failure> {
    let console = context.console;
    let note = Rows::new(&results.measured.rows).note();
    note.iter().for_each(|note| console.warn(note));
    console.result(|| results.table().plain(), || json!(results))
}

/// Writes what was measured into a folder, and shows it.
pub(super) fn report<T: Measurement>(
    context: &Context<'_>,
    gpu: &Gpu,
    out: &Path,
    measured: T,
    text: impl FnOnce(&Results<T>) -> String,
) -> Result<(), Failure> {
    let results = Results::new(Machine::describe(gpu), command_line(), measured);
    results.write(out)?;
    context.console.result(|| text(&results), || json!(results))
}

/// Shows the frames of a comparison on a bar of this name, and warns of methods that are left out.
pub(super) fn show<'a>(context: &'a Context<'_>, name: &'static str) -> impl FnMut(Progress) + 'a {
    let bar = Bar::new(context.console, name, 0);
    move |event| match event {
        Progress::Drawn { done, total, what } => bar.set(done, total, what),
        Progress::LeftOut(what) => context.console.warn(what),
    }
}

fn scale(context: &Context<'_>, args: &ScalingArgs) -> Result<(), Failure> {
    let (out, models) = (&args.compared.out, &args.compared.models);
    let outputs = context.results::<Scaling>(models, out)?;
    let _begun = context.begin_in(out, outputs, &[])?;
    let gpu = context.gpu()?;
    // Parameters change what a method costs, but hardly how that grows.
    let named = args.compared.methods.as_deref();
    let (Compared { methods, .. }, learned) =
        compared(context, &gpu, named, models, |_| one_of_each())?;
    // Every step has a size of its own.
    let plan = Plan {
        learned: &learned,
        frames: args.frames,
        ..Plan::new([1, 1], &methods)
    };
    let scaling = scaling::measure(&gpu, &plan, context.stop, &mut show(context, "scaling"))?;
    report(context, &gpu, out, scaling, |r| r.table().plain())
}

fn measure_effects(context: &Context<'_>, args: &EffectsArgs) -> Result<(), Failure> {
    let out = &args.out;
    let outputs = context.results::<Effects>(&args.scenes, out)?;
    let scenes = if args.scenes.is_empty() {
        let shipped = suite::EFFECTS.iter();
        let shipped = shipped.map(|file| suite::load_file(file, None));
        shipped.collect::<Result<_, _>>()?
    } else {
        context.scenes(&args.scenes)?
    };
    let _begun = context.begin_in(out, outputs, &scenes)?;
    let settings = effects::Settings {
        method: args.method.clone(),
        size: args.size,
        frames: args.frames,
    };
    let gpu = context.gpu()?;
    let show = &mut show(context, "effects");
    let found = effects::measure(&gpu, &scenes, &settings, out, context.stop, show)?;
    report(context, &gpu, out, found, |results| {
        let tables: Vec<String> = results.tables().iter().map(|(.., t)| t.plain()).collect();
        tables.join("\n")
    })
}

fn along_path(context: &Context<'_>, args: &PathArgs) -> Result<(), Failure> {
    let pictures = &args.pictures;
    let (out, models) = (&pictures.compared.out, &pictures.compared.models);
    let outputs = context.results::<Along>(pictures.scenes.iter().chain(models), out)?;
    let scenes = context.scenes(&pictures.scenes)?;
    let _begun = context.begin_in(out, outputs, &scenes)?;
    let gpu = context.gpu()?;
    // A path costs as much as sixty views.
    let named = pictures.compared.methods.as_deref();
    let (Compared { methods, .. }, learned) =
        compared(context, &gpu, named, models, |_| one_of_each())?;
    let images = out.join("images");
    let plan = Plan {
        samples: pictures.samples,
        frames: args.frames,
        learned: &learned,
        lenient: named.is_none(),
        images: Some(&images),
        ..Plan::new(pictures.size, &methods)
    };
    let found = {
        let show = &mut show(context, "path");
        path::measure(&gpu, &scenes, &plan, context.stop, show)?
    };
    context.warn_of_memory(&gpu);
    report(context, &gpu, out, found, |r| {
        r.note().iter().for_each(|note| context.console.warn(note));
        r.table().plain()
    })
}

/// Compares methods on scenes: those named, or all, with these model files. `out` is where pictures and the rows of finished views go, and
/// whether a run there is resumed; `plan` has the rest.
pub(super) fn measure(
    context: &Context<'_>,
    scenes: &[Scene],
    named: Option<&[MethodSpec]>,
    files: &[PathBuf],
    plan: Plan<'_>,
    out: Option<(&Path, bool)>,
) -> Result<Results<Bench>, Failure> {
    let gpu = context.gpu()?;
    let (chosen, learned) = compared(context, &gpu, named, files, |_| MethodSpec::compared())?;
    let chosen = chosen.with_base()?;
    let images = out.map(|(folder, _)| folder.join("images"));
    let plan = Plan {
        methods: &chosen.methods,
        learned: &learned,
        models: &chosen.models,
        lenient: named.is_none(),
        images: images.as_deref(),
        ..plan
    };
    // What must be the same for an interrupted run to be resumed.
    let names: Vec<String> = plan.methods.iter().map(ToString::to_string).collect();
    let machine = Machine::describe(&gpu);
    let settings = json!({
        "machine": machine,
        "size": plan.size,
        "samples": plan.samples,
        "frames": plan.frames,
        "views": plan.views,
        "methods": names,
        "models": plan.learned.iter().map(|l| &l.wgsl).collect::<Vec<_>>(),
        "scenes": scenes.iter().map(|s| &s.hash).collect::<Vec<_>>(),
    });
    let hash = json_hash(&settings);
    let partial = match out {
        Some((folder, true)) => {
            if let Some(finished) = finished(context, folder, &hash)? {
                return Ok(finished);
            }
            Partial::resume(folder, settings)?
        }
        out => Partial::new(out.map(|(folder, _)| folder), settings),
    };
    let mut measured = {
        let show = &mut show(context, "bench");
        bench_watched(&gpu, scenes, &plan, partial, context.stop, show)?
    };
    measured.settings = Some(hash);
    context.warn_of_memory(&gpu);
    Ok(Results::new(machine, command_line(), measured))
}

/// The results in a folder of a run with these settings that came to its end; nothing where no run ended there.
///
/// # Errors
/// Results of other settings: going on would replace them.
fn finished(
    context: &Context<'_>,
    folder: &Path,
    settings: &str,
) -> Result<Option<Results<Bench>>, Failure> {
    let file = folder.join(RESULTS);
    if Partial::is_in(folder) {
        return Ok(None);
    }
    if !file.exists() {
        let message = format!("{}: no run to resume, so one starts", shown(folder));
        context.console.message(message);
        return Ok(None);
    }
    let results = read(&file)?;
    if results.measured.settings.as_deref() != Some(settings) {
        return Err(EvalError::Resume {
            path: file,
            why: "a run with other settings came to its end here".to_owned(),
        }
        .into());
    }
    check_pictures(&results.measured.rows, folder)?;
    context.console.message(format!(
        "{}: the run has finished with these settings: its results are kept",
        shown(&file)
    ));
    Ok(Some(results))
}

/// Warns of scenes in which nothing transparent was seen: every method is exact there.
pub(super) fn warn_of_opaque(context: &Context<'_>, results: &Results<Bench>) {
    let rows = &results.measured.rows;
    let mut seen: BTreeMap<&str, bool> = BTreeMap::new();
    for row in rows {
        *seen.entry(&row.scene).or_default() |= row.fragments != Some(0);
    }
    let opaque = seen.into_iter().filter(|(_, is_seen)| !is_seen);
    let opaque: Vec<String> = opaque.map(|(name, _)| name.to_owned()).collect();
    if !opaque.is_empty() {
        context.console.warn(format!(
            "nothing transparent is seen in {}, so methods do not differ there; look at its materials' alpha and its cameras",
            few(&opaque, 6)
        ));
    }
}

/// Every method with one setting, the first of its curve.
fn one_of_each() -> Vec<MethodSpec> {
    let mut all = MethodSpec::curve();
    all.dedup_by_key(|m| m.name());
    all
}

/// The methods to compare, with the models of the learned ones among them and their texts; says which networks they are.
pub(super) fn compared(
    context: &Context<'_>,
    gpu: &Gpu,
    named: Option<&[MethodSpec]>,
    files: &[PathBuf],
    every: impl FnOnce(&[Model]) -> Vec<MethodSpec>,
) -> Result<(Compared, Vec<LearnedWeight>), Failure> {
    let models = files.iter().map(peelnet::load_model);
    let models = models.collect::<Result<_, _>>()?;
    let compared = Compared::new(named.map(<[_]>::to_vec), models, every)?;
    if !compared.left_out.is_empty() {
        context.console.warn(format!(
            "no model is shipped for {}: left out; name model files with --models",
            compared.left_out.join(", ")
        ));
    }
    for (k, model) in compared.models.iter().enumerate() {
        context.say_network(model, files.get(k).map(PathBuf::as_path))?;
    }
    let learned = compared.weights(gpu)?;
    Ok((compared, learned))
}

/// A bench's `results.json`, or the folder that holds it.
pub(super) fn read(path: &Path) -> Result<Results<Bench>, Failure> {
    let failed = |why| {
        let text = format!("{why}; make it with: peelnet bench SCENE --out DIR");
        Failure::failed(text)
    };
    Results::read(path).map_err(|e| failed(error_line(&e)))
}
