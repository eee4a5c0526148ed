//! `peelnet bench --training`: what accuracy costs in training.

use super::{Context, bench::outputs};
use crate::cli::BenchArgs;
use crate::failure::Failure;
use crate::learned;
use crate::parse::command_line;
use crate::progress::Bar;
use peelnet_dataset::Dataset;
use peelnet_eval::{
    Machine, Partial,
    bench::bench_watched,
    compare::Plan,
    learning::{Learning, Lesson, Varied},
    ratios::{MOMENTS, ratios},
};
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_report::Results;
use peelnet_scene::Scene;
use peelnet_train::{Config, RunOptions, TrainingData, train};
use serde_json::json;

/// The recipe whose inputs and output form all networks have.
const RECIPE: Recipe = Recipe::MEDIUM;

/// Hidden layers from next to nothing to more than anyone ships.
const HIDDEN: [&[usize]; 7] = [&[2], &[4], &[8], &[12], &[24], &[8, 8], &[16, 16]];

/// Shares of the training examples.
const SHARES: [f64; 5] = [1.0 / 256.0, 1.0 / 64.0, 1.0 / 16.0, 0.25, 1.0];

/// Epochs, as shares of the recipe's.
const EPOCHS: [f64; 5] = [1.0 / 24.0, 1.0 / 12.0, 0.25, 0.5, 2.0];

/// The file of one of the networks.
fn network(k: usize) -> String {
    format!("{k}.safetensors")
}

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    let mut outputs = outputs(context, args, Results::<Learning>::FILES)?;
    let folder = args.out.join("networks");
    let networks = (0..HIDDEN.len() + SHARES.len() + EPOCHS.len()).map(network);
    outputs.folder(
        "--out",
        &folder,
        networks.map(|name| (name, peelnet_model::KIND)),
    )?;
    let scenes = context.scenes(&args.scenes)?;
    outputs.begin(&scenes)?;
    let gpu = context.gpu()?;
    let datasets = args
        .training
        .iter()
        .map(Dataset::open)
        .collect::<Result<Vec<_>, _>>()?;
    let base = Config {
        // The scenes of the bench judge.
        split: peelnet_dataset::SplitBy::Pixel,
        ..Config::for_recipe(RECIPE)
    };
    let data = TrainingData::from_datasets(&base, &datasets)?;
    super::train::warn_of_rows(context, &data, &base);
    let mut plans: Vec<(Varied, Config, f64)> = Vec::new();
    for hidden in HIDDEN {
        let config = Config {
            hidden: hidden.to_vec(),
            ..base.clone()
        };
        plans.push((Varied::Parameters, config, 1.0));
    }
    plans.extend(SHARES.map(|share| (Varied::Examples, base.clone(), share)));
    for share in EPOCHS {
        let config = Config {
            epochs: (f64::from(base.epochs) * share).round().max(1.0) as u32,
            ..base.clone()
        };
        plans.push((Varied::Epochs, config, 1.0));
    }
    let bar = Bar::new(context.console, "training", plans.len() as u64);
    let mut rows: Vec<Lesson> = Vec::new();
    let total = plans.len() as u64;
    for (k, (varied, config, share)) in plans.into_iter().enumerate() {
        bar.set(k as u64, total, format!("{varied:?}").to_lowercase());
        // A copy of all data only where a part of it is used.
        let part = (share < 1.0).then(|| data.with_share(share));
        let own = part.as_ref().unwrap_or(&data);
        let options = RunOptions::new(folder.join(network(k)), context.stop);
        let outcome = train(&config, own, &options, |_| {})?;
        context.check_interrupt()?;
        let (mse_linear, to_moments) = judge(context, &gpu, &scenes, args, outcome.model.clone())?;
        rows.push(Lesson {
            varied,
            topology: outcome.model.mlp.topology(),
            parameters: outcome.model.mlp.parameters() as u64,
            examples: own.training_examples() as u64,
            epochs: config.epochs,
            seconds: super::train::seconds(&outcome),
            mse_linear,
            to_moments,
        });
    }
    drop(bar);
    let learning = Learning {
        recipe: RECIPE.name.to_owned(),
        rows,
    };
    let results = Results::new(Machine::of(&gpu), command_line(), learning);
    results.write(&args.out)?;
    context
        .console
        .result(|| results.table().plain(), || json!(results))
}

/// A network's error on the scenes: geometric mean, and over that of the moments.
fn judge(
    context: &Context<'_>,
    gpu: &Gpu,
    scenes: &[Scene],
    args: &BenchArgs,
    model: Model,
) -> Result<(f64, f64), Failure> {
    let name = model.meta.recipe.method;
    let learned = [learned::text_of(gpu, &model)?];
    let methods = [MOMENTS.parse()?, name.parse()?];
    let plan = Plan {
        learned: &learned,
        views: args.views.limit(),
        frames: 0,
        ..Plan::new(args.size.0, &methods)
    };
    let partial = Partial::new(None, serde_json::Value::Null);
    let rows = bench_watched(gpu, scenes, &plan, partial, context.stop, &mut |_| {})?.rows;
    let found = ratios(&rows).into_iter().find(|r| r.method == name);
    found
        .and_then(|r| Some((r.mse_linear?, r.to_moments?)))
        .ok_or_else(|| {
            Failure::Failed("the scenes hold nothing that the network errs on".to_owned())
        })
}
