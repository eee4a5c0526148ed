//! `peelnet bench designs`: what designs of slabs are worth.

use super::report;
use crate::cli::DesignsArgs;
use crate::commands::train::{seconds, warn_of_rows};
use crate::commands::{Context, json_path};
use crate::progress::Bar;
use peelnet::Failure;
use peelnet_bench::designs::{
    self, ANCHORED, DESIGNS, Designs, Entry, KBUFFER, MOMENTS, Measured, Reference, Row, Score,
};
use peelnet_core::files::{Unfinished, printable, shown};
use peelnet_dataset::{Dataset, SceneEntry, SplitBy, Subset};
use peelnet_model::{Model, Recipe};
use peelnet_scene::Scene;
use peelnet_train::{Config, End, RunOptions, TrainingData, train};
use std::collections::BTreeSet;

pub(super) fn run(context: &Context<'_>, args: &DesignsArgs) -> Result<(), Failure> {
    let inputs = args.scenes.iter().chain(&args.datasets).chain(&args.file);
    let outputs = context.results::<Designs>(inputs, &args.out)?;
    let entries = match &args.file {
        Some(path) => designs::read(path)?,
        None => designs::shipped(),
    };
    let configs: Vec<Config> = entries.iter().map(|e| config(e, args)).collect();
    for config in &configs {
        config.check()?;
    }
    let scenes = context.scenes(&args.scenes)?;
    let most = args.views.map(|n| n as usize);
    for scene in &scenes {
        scene.first_views(most).map_err(Failure::wrong)?;
    }
    let _begun = context.begin_in(&args.out, outputs, &scenes)?;
    let datasets = args.datasets.iter().map(Dataset::open);
    let datasets = datasets.collect::<Result<Vec<_>, _>>()?;
    let trained_on = check_scenes(context, &scenes, &datasets)?;
    let gpu = context.gpu()?;
    let bar = Bar::new(context.console, "designs", entries.len() as u64);
    bar.set(0, entries.len() as u64, "peeling".to_owned());
    let views = designs::peel(&gpu, &scenes, args.size, most, context.stop)?;
    context.warn_of_memory(&gpu);
    // The errors that others are compared with.
    let anchored = Model::shipped(Recipe::ANCHORED_MEDIUM)?;
    let mut references: Vec<(&str, Vec<Measured>)> = Vec::new();
    for (name, model) in [
        (MOMENTS, None),
        (KBUFFER, None),
        (ANCHORED, Some(&anchored)),
    ] {
        let method = name.parse()?;
        let measured = views.iter().map(|view| view.measure_method(&method, model));
        references.push((name, measured.collect()));
    }
    let [moments, kbuffer] = [0, 1].map(|k| references[k].1.as_slice());
    let score = |measured: &[Measured]| designs::score(&views, measured, moments, kbuffer);
    let scratch = tempfile::tempdir()
        .map_err(|e| Failure::failed(format!("cannot create a temporary folder: {e}")))?;
    let _unfinished = Unfinished::new(scratch.path());
    let mut rows = Vec::new();
    for (k, (entry, config)) in entries.iter().zip(&configs).enumerate() {
        bar.set(k as u64, entries.len() as u64, entry.name.clone());
        let data = TrainingData::from_datasets(config, &datasets)?;
        context.check_interrupt()?;
        if k == 0 {
            warn_of_rows(context, data.used, config);
        }
        let options = RunOptions::new(scratch.path().join("model.safetensors"), context.stop);
        let outcome = train(config, &data, &options, |_| {})?;
        if outcome.end == End::Interrupted {
            return Err(Failure::failed(crate::interrupt::MESSAGE));
        }
        let examples = data.examples(Subset::Train);
        // Two designs' examples are never in memory at once.
        drop(data);
        let measured = |model| -> Result<Score, Failure> {
            let measured = views.iter().map(|view| entry.measure(view, model));
            let score = score(&measured.collect::<Vec<_>>());
            context.check_interrupt()?;
            Ok(score)
        };
        let (network, middle) = (measured(Some(&outcome.model))?, measured(None)?);
        rows.push(Row {
            examples,
            seconds: seconds(&outcome),
            ..Row::new(entry, &outcome.model, network, middle)
        });
    }
    drop(bar);
    let reference = |(name, measured): &(&str, Vec<Measured>)| Reference {
        method: (*name).to_owned(),
        score: score(measured),
    };
    let found = Designs {
        file: (args.file.as_deref()).map_or_else(|| DESIGNS.to_owned(), json_path),
        trained_on,
        judged_on: scenes.iter().map(|s| s.name.clone()).collect(),
        learning_rate: configs[0].learning_rate,
        epochs: configs[0].epochs,
        references: references.iter().map(reference).collect(),
        rows,
    };
    report(context, &gpu, &args.out, found, |r| r.table().plain())
}

fn config(entry: &Entry, args: &DesignsArgs) -> Config {
    Config {
        // The scenes of the bench judge.
        split: SplitBy::Pixel,
        seed: entry.seed,
        max_rows: args.max_rows,
        ..Config::for_recipe(entry.recipe)
    }
}

/// The scenes that are trained on; none of them may judge.
fn check_scenes(
    context: &Context<'_>,
    scenes: &[Scene],
    datasets: &[Dataset],
) -> Result<Vec<String>, Failure> {
    let mut trained: BTreeSet<String> = BTreeSet::new();
    for dataset in datasets {
        let manifest = dataset.manifest();
        for part in manifest.parts.iter().filter(|p| !dataset.is_held_out(p)) {
            let SceneEntry { name, content, .. } = &manifest.scenes[part.scene as usize];
            let is_same = |scene: &Scene| {
                scene.name == *name || (!content.is_empty() && scene.content == *content)
            };
            if scenes.iter().any(is_same) {
                return Err(Failure::wrong(format!(
                    "{}: the dataset holds scene '{}', which would judge what was trained on it; extract a dataset without it, or name \
                     another scene",
                    shown(dataset.path()),
                    printable(name)
                )));
            }
            trained.insert(name.clone());
        }
    }
    for scene in scenes.iter().filter(|scene| scene.held_out) {
        context.console.warn(format!(
            "scene '{}' is held out: once a design was chosen by it, it can no longer judge that design",
            printable(&scene.name)
        ));
    }
    Ok(trained.into_iter().collect())
}
