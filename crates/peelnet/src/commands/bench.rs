//! `peelnet bench`: error against time for many methods.

use super::{Context, bench_designs, bench_effects, bench_path};
use crate::cli::BenchArgs;
use crate::failure::{Failure, one_line};
use crate::learned;
use crate::outputs::Outputs;
use crate::parse::{MethodList, command_line, shown};
use crate::progress::Bar;
use peelnet_eval::{
    EvalError, Machine, Partial,
    bench::{self, Bench, bench_watched},
    compare::Plan,
    front::BASE,
    scaling::{self, Scaling},
    settings_hash,
};
use peelnet_gpu::Gpu;
use peelnet_model::{Model, ModelError, Recipe};
use peelnet_render::{LearnedWeight, MethodSpec};
use peelnet_report::Results;
use peelnet_scene::Scene;
use serde_json::json;
use std::path::{Path, PathBuf};

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    if !args.designs.is_empty() {
        return bench_designs::run(context, args);
    }
    if args.effects {
        return bench_effects::run(context, args);
    }
    if args.scaling {
        return scale(context, args);
    }
    if args.path {
        return bench_path::run(context, args);
    }
    let mut outputs = outputs(context, args, Results::<Bench>::FILES)?;
    outputs.folder("--out", &args.out, [(Partial::FILE, Partial::KIND)])?;
    let results = if args.redraw {
        outputs.begin(&[])?;
        read(&args.out)?
    } else {
        let scenes = context.scenes(&args.scenes)?;
        outputs.begin(&scenes)?;
        measure(context, args, &scenes, Some(&args.out))?
    };
    results.write(&args.out)?;
    // Drawing older results again ends no interrupted run.
    if !args.redraw {
        Partial::discard(&args.out);
    }
    context
        .console
        .result(|| results.table().plain(), || json!(results))
}

/// The files and the pictures that a bench of any kind writes.
///
/// # Errors
/// A foreign file among them, or a folder that cannot be written.
pub(super) fn outputs<'a>(
    context: &'a Context<'a>,
    args: &BenchArgs,
    files: &[&str],
) -> Result<Outputs<'a>, Failure> {
    let inputs = args.scenes.iter().chain(&args.models);
    let mut outputs = Outputs::new(context, inputs);
    outputs.results("--out", &args.out, files)?;
    outputs.pictures("--out", &args.out.join("images"))?;
    Ok(outputs)
}

/// How time and memory grow.
fn scale(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    outputs(context, args, Results::<Scaling>::FILES)?.begin(&[])?;
    let gpu = context.gpu()?;
    // Parameters change what a method costs, but hardly how that grows.
    let Chosen {
        methods, learned, ..
    } = chosen(context, &gpu, &args.methods, &args.models, one_of_each)?;
    let bar = Bar::new(context.console, "scaling", 0);
    let mut show = |done, total, method: &str| bar.set(done, total, method.to_owned());
    let (rows, left_out) = scaling::measure(
        &gpu,
        &methods,
        &learned,
        args.frames,
        context.stop,
        &mut show,
    )?;
    drop(bar);
    let scaling = Scaling::new(rows, left_out);
    let results = Results::new(Machine::of(&gpu), command_line(), scaling);
    results.write(&args.out)?;
    context
        .console
        .result(|| results.table().plain(), || json!(results))
}

/// Compares as the arguments say; pictures and the rows of finished views go to `out`.
///
/// # Errors
/// Whatever stopped it.
pub(super) fn measure(
    context: &Context<'_>,
    args: &BenchArgs,
    scenes: &[Scene],
    out: Option<&Path>,
) -> Result<Results<Bench>, Failure> {
    let gpu = context.gpu()?;
    let Chosen {
        mut methods,
        learned,
        models,
    } = chosen(
        context,
        &gpu,
        &args.methods,
        &args.models,
        MethodSpec::compared,
    )?;
    // What times are ratios to.
    let base: MethodSpec = BASE.parse()?;
    if !methods.contains(&base) {
        methods.push(base);
    }
    let images = out.map(|folder| folder.join("images"));
    let plan = Plan {
        size: args.size.0,
        samples: args.samples,
        methods: &methods,
        learned: &learned,
        models: &models,
        lenient: matches!(args.methods, MethodList::All),
        views: args.views.limit(),
        frames: args.frames,
        images: images.as_deref(),
    };
    let settings = settings(&gpu, args, &plan, scenes);
    let hash = settings_hash(&settings);
    let partial = match out {
        Some(folder) if args.resume => {
            if let Some(finished) = finished(context, folder, &hash)? {
                return Ok(finished);
            }
            Partial::resume(folder, settings)?
        }
        _ => Partial::new(out, settings),
    };
    let bar = Bar::new(context.console, "bench", 0);
    let mut show = |event: bench::Progress<'_>| match event {
        bench::Progress::Drawn {
            done,
            total,
            scene,
            method,
        } => bar.set(done, total, format!("{scene} with {method}")),
        bench::Progress::LeftOut { scene, method, why } => context
            .console
            .warn(format!("{method} is left out of {scene}: {why}")),
    };
    let mut measured = bench_watched(&gpu, scenes, &plan, partial, context.stop, &mut show)?;
    measured.settings = Some(hash);
    drop(bar);
    context.warn_of_memory(&gpu);
    Ok(Results::new(Machine::of(&gpu), command_line(), measured))
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
    let file = folder.join("results.json");
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
    let message = format!(
        "{}: the run has finished with these settings: its results are kept",
        shown(&file)
    );
    context.console.message(message);
    Ok(Some(results))
}

/// What must be the same for an interrupted run to be resumed.
fn settings(gpu: &Gpu, args: &BenchArgs, plan: &Plan<'_>, scenes: &[Scene]) -> serde_json::Value {
    let names: Vec<String> = plan.methods.iter().map(ToString::to_string).collect();
    json!({
        "machine": Machine::of(gpu),
        "size": plan.size,
        "samples": plan.samples,
        "frames": plan.frames,
        "views": format!("{:?}", args.views),
        "methods": names,
        "models": plan.learned.iter().map(|l| &l.wgsl).collect::<Vec<_>>(),
        "scenes": scenes.iter().map(|s| &s.hash).collect::<Vec<_>>(),
    })
}

/// What is compared.
pub(super) struct Chosen {
    pub(super) methods: Vec<MethodSpec>,
    /// Weights of the learned ones among them.
    pub(super) learned: Vec<LearnedWeight>,
    /// The models of those weights, those that were named first.
    pub(super) models: Vec<Model>,
}

/// Every method with one setting, the first of its curve.
pub(super) fn one_of_each() -> Vec<MethodSpec> {
    let mut all = MethodSpec::curve();
    all.dedup_by_key(|m| m.name());
    all
}

/// The methods to compare, with the models of the learned ones among them.
///
/// # Errors
/// A model that cannot be loaded or exported, two of one recipe, or a method that was named and has none.
pub(super) fn chosen(
    context: &Context<'_>,
    gpu: &Gpu,
    methods: &MethodList,
    named: &[PathBuf],
    every: impl Fn() -> Vec<MethodSpec>,
) -> Result<Chosen, Failure> {
    let mut models: Vec<Model> = Vec::new();
    for path in named {
        let model = peelnet::load_model(path)?;
        if models.iter().any(|m| m.meta.recipe == model.meta.recipe) {
            return Err(Failure::Usage(format!(
                "--models: {} is a second model of recipe {}; one run compares one of each",
                shown(path),
                model.meta.recipe
            )));
        }
        models.push(model);
    }
    let mut wanted = match methods {
        MethodList::These(list) => list.clone(),
        MethodList::All => every(),
    };
    let all = matches!(methods, MethodList::All);
    let mut missing: Vec<&str> = Vec::new();
    for recipe in Recipe::ALL {
        let name = recipe.method;
        if !wanted.iter().any(|m| m.name() == name)
            || models.iter().any(|m| m.meta.recipe == recipe)
        {
            continue;
        }
        match Model::shipped(recipe) {
            Ok(model) => models.push(model),
            // Only what was named must be there.
            Err(ModelError::NotShipped(_)) if all => missing.push(name),
            Err(e) => return Err(e.into()),
        }
    }
    if !missing.is_empty() {
        wanted.retain(|m| !missing.contains(&m.name()));
        context.console.warn(format!(
            "no model is shipped for {}: left out; name model files with --models",
            missing.join(", ")
        ));
    }
    for model in &models {
        let name = model.meta.recipe.method;
        if !wanted.iter().any(|m| m.name() == name) {
            wanted.push(name.parse()?);
        }
    }
    for (k, model) in models.iter().enumerate() {
        let file = named.get(k).map(PathBuf::as_path);
        context.console.message(learned::about(model, file)?);
    }
    let learned = models
        .iter()
        .map(|model| learned::text_of(gpu, model))
        .collect::<Result<_, _>>()?;
    Ok(Chosen {
        methods: wanted,
        learned,
        models,
    })
}

/// A bench's `results.json`, or the folder that holds it.
///
/// # Errors
/// If there is none.
pub(super) fn read(path: &Path) -> Result<Results<Bench>, Failure> {
    let file = if path.is_dir() {
        path.join("results.json")
    } else {
        path.to_owned()
    };
    Results::read(&file).map_err(|e| {
        Failure::Failed(format!(
            "{}; make it with: peelnet bench SCENE --out DIR",
            one_line(&e)
        ))
    })
}
