use super::{Context, json_path};
use crate::cli::TrainArgs;
use crate::progress::{Bar, Curves};
use peelnet::Failure;
use peelnet::fit::{self, ModelPlace, Step};
use peelnet_core::files::{counted, printable, shown, thousands};
use peelnet_dataset::Dataset;
use peelnet_train::{
    Config, DataSplit, End, Outcome, RunOptions, TrainingData, UsedRows, checkpoint_folder,
};
use serde_json::json;
use std::path::{Path, PathBuf};

pub(super) fn run(context: &Context<'_>, args: &TrainArgs) -> Result<(), Failure> {
    let config = config(args)?;
    let mut outputs = context.outputs(&args.datasets);
    let place = ModelPlace::new(
        Some(&args.out),
        args.resume,
        &args.loss_curve,
        &mut outputs,
        ["--out", "--loss-curve", "--resume"],
    )?;
    let datasets = args.datasets.iter().map(Dataset::open);
    let datasets = datasets.collect::<Result<Vec<_>, _>>()?;
    let _begun = context.begin(outputs, &[])?;
    let mut options = RunOptions::new(place.file(), context.stop);
    options.resume = args.resume;
    let continues = match place.is_kept() {
        true => Continues::Resumed,
        false => Continues::Anew,
    };
    let curves = &args.loss_curve;
    let outcome = fit(context, &config, &datasets, &options, curves, continues)?;
    place.deliver(&outcome.model)?;
    let meta = &outcome.model.meta;
    let dataset = meta.dataset.as_ref();
    let text = || text(&args.out, &outcome);
    context.console.result(text, || {
        json!({
            "out": json_path(&args.out),
            "recipe": meta.recipe,
            "topology": outcome.model.mlp.topology(),
            "parameters": outcome.model.mlp.parameters(),
            "config": meta.config,
            "end": outcome.end.name(),
            "epochs": outcome.history.len(),
            "model_epoch": outcome.model_epoch,
            "resumed_from": outcome.resumed_from,
            "losses": meta.losses,
            "held_out": meta.held_out,
            "max_rows": (!args.stream).then_some(args.max_rows),
            "buffer_rows": args.stream.then_some(args.buffer_rows),
            "rows": dataset.map(|d| d.rows),
            "dataset": dataset.map(|d| &d.hash),
            "set_aside": dataset.map(|d| &d.set_aside),
            "seed": meta.seed,
            "seconds": seconds(&outcome),
            "rows_per_s": rows_per_s(&outcome),
            "checkpoint": json_path(&outcome.checkpoint),
        })
    })
}

fn config(args: &TrainArgs) -> Result<Config, Failure> {
    let recipe = Config::for_recipe(args.recipe);
    let config = Config {
        seed: args.seed,
        epochs: args.epochs.unwrap_or(recipe.epochs),
        batch: args.batch.map_or(recipe.batch, |b| b as usize),
        learning_rate: args.lr.unwrap_or(recipe.learning_rate),
        schedule: args.schedule.unwrap_or(recipe.schedule),
        hidden: args.hidden.clone().unwrap_or(recipe.hidden),
        patience: args.patience.or(recipe.patience),
        max_rows: args.max_rows,
        buffer_rows: args.stream.then_some(args.buffer_rows),
        split: args.split,
        ..recipe
    };
    let config = config.minimising(args.loss);
    config.check()?;
    Ok(config)
}

/// What becomes of a training that is interrupted.
#[derive(Clone, Copy)]
pub(super) enum Continues {
    Resumed,
    Anew,
}

/// Trains with a progress bar and says what from.
pub(super) fn fit(
    context: &Context<'_>,
    config: &Config,
    datasets: &[Dataset],
    options: &RunOptions<'_>,
    loss_curves: &[PathBuf],
    continues: Continues,
) -> Result<Outcome, Failure> {
    let console = context.console;
    for dataset in datasets {
        let lost = dataset.manifest().lost_fragments;
        if lost > 0 {
            console.warn(format!(
                "{} lacks {} that peeling left out: what is learnt from its rows is of stacks that were cut off; extract it again with more passes",
                shown(dataset.path()),
                counted(lost, "fragment")
            ));
        }
    }
    let rows = datasets.iter().map(Dataset::rows).sum();
    let read = || Bar::new(console, "read", rows);
    let mut bar = config.buffer_rows.is_some().then(read);
    let mut curves = None;
    let mut show = |step: Step<'_>| match step {
        Step::Read(rows, of) => bar.iter().for_each(|bar| bar.set(rows, of, String::new())),
        Step::Epoch(epoch) => curves.iter_mut().for_each(|c: &mut Curves| c.add(epoch)),
        Step::Ready(data) => {
            bar = None;
            say(context, config, data, &options.out);
            curves = Some(Curves::new(console, config.epochs));
        }
    };
    let outcome = fit::fit(config, datasets, options, loss_curves, &mut show);
    drop(curves);
    let outcome = outcome?;
    if outcome.end == End::Interrupted {
        let state = shown(&outcome.checkpoint);
        let then = match continues {
            Continues::Resumed => format!("the state is in {state}, continue with --resume"),
            Continues::Anew => "the same command begins anew".to_owned(),
        };
        return Err(Failure::failed(format!(
            "interrupted after epoch {} of {}; {then}",
            outcome.history.len(),
            config.epochs
        )));
    }
    match outcome.resumed_from {
        Some(from) if outcome.history.len() as u32 == from => console.message(format!(
            "the training had already finished after epoch {from}: nothing was left to do"
        )),
        Some(from) => console.message(format!("continued after epoch {from}")),
        None => {}
    }
    Ok(outcome)
}

/// What is learnt from, and what the losses of rows that are set aside say.
fn say(context: &Context<'_>, config: &Config, data: &TrainingData, out: &Path) {
    let console = context.console;
    if let Some(bytes) = data.scratch_bytes() {
        console.message(format!(
            "streaming: at most {} in memory at once, {:.1} MiB of scratch space in {}",
            counted(config.buffer_rows.unwrap_or(0), "row"),
            bytes as f64 / f64::from(1 << 20),
            shown(&checkpoint_folder(out))
        ));
    }
    warn_of_rows(context, data.used, config);
    if config.held_out + config.validation > 0.0 {
        let split = data.split.iter();
        split.for_each(|split| console.message(split_text(split)));
    }
    let aside = match config.held_out + config.validation > 0.0 {
        true => " with those set aside",
        false => "",
    };
    console.message(format!(
        "training recipe {} on {}{aside} of {}, {}",
        config.recipe,
        counted(data.rows(), "row"),
        data.source,
        counted(config.epochs.into(), "epoch")
    ));
}

pub(super) fn warn_of_rows(context: &Context<'_>, used: Option<UsedRows>, config: &Config) {
    if let Some(UsedRows { used, of }) = used.filter(|rows| rows.used < rows.of) {
        context.console.warn(format!(
            "{} of {} rows are used, drawn by whole pixels from the seed: at most {} are held in memory (set with --max-rows; --stream uses all)",
            thousands(used),
            thousands(of),
            thousands(config.max_rows)
        ));
    }
}

fn split_text(split: &DataSplit) -> String {
    match split {
        DataSplit::Scenes { validation, test } => {
            let named = [("validation", validation), ("testing", test)];
            let named = named.into_iter().filter(|(_, scenes)| !scenes.is_empty());
            let named: Vec<String> = named
                .map(|(what, scenes)| format!("{what}: {}", super::few(scenes, 6)))
                .collect();
            format!("whole scenes are set aside, {}", named.join("; "))
        }
        DataSplit::Pixels { scenes: 1 } => {
            "one scene alone is split by pixel: its test loss says little of other scenes"
                .to_owned()
        }
        DataSplit::Pixels { scenes } => format!(
            "{} are split by pixel: the test loss says little of other scenes",
            counted(*scenes as u64, "scene")
        ),
    }
}

pub(super) fn seconds(outcome: &Outcome) -> f64 {
    outcome.history.iter().map(|e| e.seconds).sum()
}

/// Median rows a second of the epochs.
fn rows_per_s(outcome: &Outcome) -> f64 {
    let mut rates: Vec<f64> = outcome.history.iter().map(|e| e.rows_per_s).collect();
    rates.sort_by(f64::total_cmp);
    rates.get(rates.len() / 2).copied().unwrap_or(0.0)
}

pub(super) fn text(out: &Path, outcome: &Outcome) -> String {
    let meta = &outcome.model.meta;
    let mut t = format!(
        "{}: recipe {}, weights of epoch {} ({})",
        shown(out),
        meta.recipe,
        outcome.model_epoch,
        outcome.end.name().replace('-', " "),
    );
    for (name, loss) in super::losses(&outcome.model) {
        t.push_str(&format!(", {name} loss {loss:.3e}"));
    }
    let rate = thousands(rows_per_s(outcome) as u64);
    t.push_str(&format!(", {:.1} s, {rate} rows/s", seconds(outcome)));
    for (scene, error) in &meta.held_out {
        let scene = printable(scene);
        t += &format!("\nheld-out scene {scene}: mean error of T {error:.4}");
    }
    t
}
