//! `peelnet train`: a dataset into a network.

use super::Context;
use crate::cli::{LearningSchedule, SplitChoice, TrainArgs};
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::parse::{json_path, shown};
use crate::progress::Bar;
use peelnet::{check_model_place, save_model};
use peelnet_dataset::{Dataset, SplitBy, is_remote};
use peelnet_files::{Destination, Unfinished, counted, destination, printable, thousands};
use peelnet_train::{
    CHECKPOINT_FILES, Config, CurveFormat, DataSplit, End, Outcome, OutputLock, RunOptions,
    Schedule, Source, StreamedData, TrainingData, UsedRows, checkpoint_folder, held_out_errors,
    train,
};
use serde_json::json;
use std::path::Path;

pub(super) fn run(context: &Context<'_>, args: &TrainArgs) -> Result<(), Failure> {
    let config = config(args)?;
    let mut outputs = Outputs::new(context, &args.datasets);
    let is_stored = is_remote(&args.out);
    if is_stored {
        check_model_place(&args.out)?;
    } else {
        outputs.file("--out", &args.out, peelnet_model::KIND)?;
    }
    // A training needs a file beside which its state lies, also where the model goes to stdout, a device or an object store.
    let is_file = !is_stored && matches!(destination(&args.out), Ok(Destination::File(_)));
    if args.resume && !is_file {
        return Err(Failure::Usage(format!(
            "--resume: {} is no file, so no state lies beside it",
            shown(&args.out)
        )));
    }
    let scratch = if is_file {
        outputs.folder("--out", &checkpoint_folder(&args.out), CHECKPOINT_FILES)?;
        None
    } else {
        let folder = tempfile::tempdir()
            .map_err(|e| Failure::Failed(format!("cannot create a temporary folder: {e}")))?;
        let unfinished = Unfinished::new(folder.path());
        Some((folder, unfinished))
    };
    let out = scratch
        .as_ref()
        .map(|(folder, _)| folder.path().join("model.safetensors"));
    let out = out.as_deref().unwrap_or(&args.out);
    for path in &args.loss_curve {
        let format = CurveFormat::of(path)?;
        outputs.file("--loss-curve", path, format.kind())?;
    }
    let datasets = args
        .datasets
        .iter()
        .map(Dataset::open)
        .collect::<Result<Vec<_>, _>>()?;
    outputs.begin(&[])?;
    let mut options = RunOptions::new(out, context.stop);
    options.resume = args.resume;
    options.loss_curve = args.loss_curve.clone();
    let outcome = fit(context, &config, &datasets, &options)?;
    if !is_file {
        save_model(&outcome.model, &args.out).inspect_err(|_| {
            // Hours of training are not lost with a connection.
            if let Some((folder, _)) = scratch {
                let kept = folder.keep().join("model.safetensors");
                let kept = format!("the model is kept: {}", shown(&kept));
                context.console.message(kept);
            }
        })?;
    }
    context.console.result(
        || text(&args.out, &outcome),
        || {
            let meta = &outcome.model.meta;
            json!({
                "out": json_path(&args.out),
                "recipe": meta.recipe,
                "topology": outcome.model.mlp.topology(),
                "parameters": outcome.model.mlp.parameters(),
                "config": meta.config,
                "end": end_name(outcome.end),
                "epochs": outcome.history.len(),
                "model_epoch": outcome.model_epoch,
                "resumed_from": outcome.resumed_from,
                "losses": meta.losses,
                "held_out": meta.held_out,
                "max_rows": (!args.stream).then_some(args.max_rows),
                "buffer_rows": args.stream.then_some(args.buffer_rows),
                "rows": meta.dataset.as_ref().map(|d| d.rows),
                "dataset": meta.dataset.as_ref().map(|d| &d.hash),
                "set_aside": meta.dataset.as_ref().map(|d| &d.set_aside),
                "seed": meta.seed,
                "seconds": seconds(&outcome),
                "rows_per_s": rows_per_s(&outcome),
                "checkpoint": json_path(&outcome.checkpoint),
            })
        },
    )
}

/// The recipe's settings with those of the flags.
fn config(args: &TrainArgs) -> Result<Config, Failure> {
    let mut config = Config::for_recipe(args.recipe);
    config.seed = args.seed;
    config.epochs = args.epochs.unwrap_or(config.epochs);
    config.batch = args.batch.map_or(config.batch, |b| b as usize);
    config.learning_rate = args.lr.unwrap_or(config.learning_rate);
    config.schedule = match args.schedule {
        None => config.schedule,
        Some(LearningSchedule::Constant) => Schedule::Constant,
        Some(LearningSchedule::OneCycle) => Schedule::ONE_CYCLE,
    };
    config.hidden = args.hidden.clone().unwrap_or(config.hidden);
    config.patience = args.patience.or(config.patience);
    config.loss = args.loss;
    config.max_rows = args.max_rows;
    config.buffer_rows = args.stream.then_some(args.buffer_rows);
    config.split = match args.split {
        SplitChoice::Scene => SplitBy::Scene,
        SplitChoice::Pixel => SplitBy::Pixel,
    };
    config.check()?;
    Ok(config)
}

/// Trains with a progress bar; the model file has the errors on held-out scenes in it where the datasets hold such.
pub(super) fn fit(
    context: &Context<'_>,
    config: &Config,
    datasets: &[Dataset],
    options: &RunOptions<'_>,
) -> Result<Outcome, Failure> {
    // Until the model has all of its metadata; before the rows are read, because that can take minutes.
    let lock = OutputLock::take(&options.out)?;
    let options = &RunOptions {
        lock: Some(&lock),
        ..options.clone()
    };
    let (held, streamed);
    let (source, split, rows, from): (Source<'_>, _, _, _) = if let Some(most) = config.buffer_rows
    {
        streamed = stream(context, config, datasets, options, most)?;
        let data = &streamed;
        (data.into(), &data.split, data.rows(), &data.source)
    } else {
        held = TrainingData::from_datasets(config, datasets)?;
        warn_of_rows(context, &held, config);
        let rows = held.rows() as u64;
        ((&held).into(), &held.split, rows, &held.source)
    };
    if let Some(split) = split
        && config.held_out + config.validation > 0.0
    {
        context.console.message(split_text(split));
    }
    context.console.message(format!(
        "training recipe {} on {} of {from}, {}",
        config.recipe,
        counted(rows, "row"),
        counted(config.epochs.into(), "epoch")
    ));
    let bar = Bar::new(context.console, "train", config.epochs.into());
    let outcome = train(config, source, options, |e| {
        let held_out = e
            .held_out_loss
            .map_or_else(String::new, |l| format!(", held out {l:.6}"));
        bar.set(
            e.epoch.into(),
            e.epochs.into(),
            format!(
                "loss {:.6}{held_out}, {} rows/s",
                e.train_loss,
                thousands(e.rows_per_s as u64)
            ),
        );
    });
    drop(bar);
    let mut outcome = outcome?;
    if outcome.end == End::Interrupted {
        return Err(Failure::Failed(format!(
            "interrupted after epoch {} of {}; the state is in {}, continue with --resume",
            outcome.history.len(),
            config.epochs,
            shown(&outcome.checkpoint)
        )));
    }
    if let Some(from) = outcome.resumed_from {
        context
            .console
            .message(if outcome.history.len() as u32 == from {
                format!(
                    "the training had already finished after epoch {from}: nothing was left to do"
                )
            } else {
                format!("continued after epoch {from}")
            });
    }
    let held_out = held_out_errors(&outcome.model, datasets)?;
    if !held_out.is_empty() {
        outcome.model.meta.held_out = held_out;
        outcome.model.save(&options.out)?;
    }
    Ok(outcome)
}

/// Reads the datasets into a scratch file in the checkpoint's folder.
fn stream(
    context: &Context<'_>,
    config: &Config,
    datasets: &[Dataset],
    options: &RunOptions<'_>,
    most: u64,
) -> Result<StreamedData, Failure> {
    let folder = checkpoint_folder(&options.out);
    let bar = Bar::new(
        context.console,
        "read",
        datasets.iter().map(Dataset::rows).sum(),
    );
    let data = StreamedData::from_datasets(config, datasets, &folder, options.stop, |rows, of| {
        bar.set(rows, of, String::new());
    });
    drop(bar);
    let data = data?;
    context.console.message(format!(
        "streaming: at most {} in memory at once, {:.1} MiB of scratch space in {}",
        counted(most, "row"),
        data.scratch_bytes() as f64 / f64::from(1 << 20),
        shown(&folder)
    ));
    Ok(data)
}

/// Says if not all rows are used.
pub(super) fn warn_of_rows(context: &Context<'_>, data: &TrainingData, config: &Config) {
    if let Some(UsedRows { used, of }) = data.used.filter(|rows| rows.used < rows.of) {
        context.console.warn(format!(
            "{} of {} rows are used, drawn by whole pixels from the seed: at most {} are held in memory (set with --max-rows; --stream uses all)",
            thousands(used),
            thousands(of),
            thousands(config.max_rows)
        ));
    }
}

/// What the losses of rows that are set aside say.
fn split_text(split: &DataSplit) -> String {
    match split {
        DataSplit::Scenes { validation, test } => {
            let named = [("validation", validation), ("testing", test)];
            let named = named.into_iter().filter(|(_, scenes)| !scenes.is_empty());
            let named: Vec<String> = named
                .map(|(what, scenes)| format!("{what}: {}", listed(scenes)))
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

/// The first names of a list, and how many there are beyond.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 6;
    let shown: Vec<String> = names
        .iter()
        .take(SHOWN)
        .map(|n| printable(n).to_string())
        .collect();
    match names.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Seconds of all epochs.
pub(super) fn seconds(outcome: &Outcome) -> f64 {
    outcome.history.iter().map(|e| e.seconds).sum()
}

/// Median rows a second of the epochs.
fn rows_per_s(outcome: &Outcome) -> f64 {
    let mut rates: Vec<f64> = outcome.history.iter().map(|e| e.rows_per_s).collect();
    rates.sort_by(f64::total_cmp);
    rates.get(rates.len() / 2).copied().unwrap_or(0.0)
}

/// What a training did, in a few lines.
pub(super) fn text(out: &Path, outcome: &Outcome) -> String {
    let meta = &outcome.model.meta;
    let loss = |name: &str, loss: Option<f64>| {
        loss.map_or_else(String::new, |l| format!(", {name} loss {l:.6}"))
    };
    let mut t = format!(
        "{}: recipe {}, weights of epoch {} ({}){}{}{}, {:.1} s, {} rows/s",
        shown(out),
        meta.recipe,
        outcome.model_epoch,
        match outcome.end {
            End::Finished => "finished",
            End::StoppedEarly => "stopped early",
            End::Interrupted => "interrupted",
        },
        loss("training", meta.losses.train),
        loss("validation", meta.losses.validation),
        loss("test", meta.losses.test),
        seconds(outcome),
        thousands(rows_per_s(outcome) as u64),
    );
    for (scene, error) in &meta.held_out {
        t.push_str(&format!(
            "\nheld-out scene {}: mean error of T {error:.4}",
            printable(scene)
        ));
    }
    t
}

const fn end_name(end: End) -> &'static str {
    match end {
        End::Finished => "finished",
        End::StoppedEarly => "stopped-early",
        End::Interrupted => "interrupted",
    }
}
