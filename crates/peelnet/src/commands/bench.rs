//! `peelnet bench`: error against time for many methods.

use super::Context;
use crate::cli::BenchArgs;
use crate::failure::Failure;
use crate::learned;
use crate::parse::{MethodList, ViewCount, command_line};
use crate::progress::Progress;
use crate::shipped;
use peelnet_eval::{
    Machine, Row,
    compare::{Plan, compare},
    ratios::{self, ratios},
    report::Bench,
    table::plain,
};
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_render::{LearnedWeight, METHODS, MethodSpec};
use serde_json::json;
use std::path::PathBuf;

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    let scenes = context.scenes(&args.scenes)?;
    let gpu = context.gpu()?;
    let (methods, learned) = methods(context, &gpu, args)?;
    let images = args.out.join("images");
    let views = match args.views {
        ViewCount::All => None,
        ViewCount::First(n) => Some(n as usize),
    };
    let plan = Plan {
        size: args.size.0,
        methods: &methods,
        learned: &learned,
        views,
        frames: args.frames,
        images: Some(&images),
    };
    let drawn: usize = scenes
        .iter()
        .map(|s| views.map_or(s.views.len(), |n| n.min(s.views.len())))
        .sum();
    // The exact method judges whether it is asked for or not.
    let frames = (drawn * (methods.len() + 1) * (1 + args.frames as usize)) as u64;
    let bar = Progress::new(context.console, "bench", frames);
    let mut done = 0;
    let mut rows: Vec<Row> = Vec::new();
    for scene in &scenes {
        rows.extend(compare(&gpu, scene, &plan, context.stop, &mut |method| {
            done += 1;
            bar.set(done, frames, format!("{} with {method}", scene.name));
        })?);
    }
    drop(bar);
    let bench = Bench {
        machine: Machine::of(&gpu),
        command: command_line(),
        rows,
    };
    bench.write(&args.out)?;
    let table = ratios(&bench.rows);
    context.console.result(
        || plain(&ratios::HEADINGS.map(str::to_owned), &ratios::cells(&table)),
        || json!(bench),
    )
}

/// The methods to compare and the weights of the learned ones among them.
fn methods(
    context: &Context<'_>,
    gpu: &Gpu,
    args: &BenchArgs,
) -> Result<(Vec<MethodSpec>, Vec<LearnedWeight>), Failure> {
    let mut learned: Vec<LearnedWeight> = Vec::new();
    for path in &args.models {
        let model = Model::load(path)?;
        if learned.iter().any(|l| l.recipe == model.meta.recipe) {
            return Err(Failure::Usage(format!(
                "--models: {} is a second model of recipe {}; one run compares one of each",
                path.display(),
                model.meta.recipe
            )));
        }
        learned.push(learned::text_of(gpu, &model)?);
    }
    let mut wanted = match &args.methods {
        MethodList::These(list) => list.clone(),
        MethodList::All => METHODS
            .iter()
            .map(|m| m.name.parse())
            .collect::<Result<Vec<MethodSpec>, _>>()?,
    };
    let all = matches!(args.methods, MethodList::All);
    let mut missing: Vec<&str> = Vec::new();
    for recipe in Recipe::ALL {
        let name = recipe.method_name();
        if !wanted.iter().any(|m| m.name() == name) || learned.iter().any(|l| l.recipe == recipe) {
            continue;
        }
        let shipped: Result<PathBuf, Failure> = shipped::model(recipe.name());
        match shipped {
            Ok(path) => learned.push(learned::text_of(gpu, &Model::load(&path)?)?),
            // Only what was named must be there.
            Err(_) if all => missing.push(name),
            Err(e) => return Err(e),
        }
    }
    if !missing.is_empty() {
        wanted.retain(|m| !missing.contains(&m.name()));
        context.console.warn(format!(
            "no model is shipped for {}: left out; name model files with --models",
            missing.join(", ")
        ));
    }
    for l in &learned {
        let name = l.recipe.method_name();
        if !wanted.iter().any(|m| m.name() == name) {
            wanted.push(name.parse()?);
        }
    }
    Ok((wanted, learned))
}
