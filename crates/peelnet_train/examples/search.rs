//! The search for each network's budget: every recipe is trained with the same rates and numbers of epochs on the same data, and the
//! point of the least loss on the validation data is chosen. Run by `cargo xtask train-models --search`.
//!
//! `search OUT ROWS TRAINING,... VALIDATION,... [RECIPE,...]`: ROWS of the datasets are used at most; OUT gets `search.json` and
//! `search.md`.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use peelnet_dataset::{Dataset, Subset};
use peelnet_model::{Inputs, Recipe};
use peelnet_train::{Config, RunOptions, Schedule, TrainingData, train};
use serde::Serialize;

/// Peaks of the learning rate.
const RATES: [f64; 3] = [1e-3, 4e-3, 1.6e-2];
/// A quarter, a half and all of the longest training.
const EPOCHS: [u32; 3] = [20, 40, 80];

/// One training.
#[derive(Serialize)]
struct Point {
    learning_rate: f64,
    epochs: u32,
    /// Mean loss of the validation examples after the last epoch; none where the training diverged.
    validation_loss: Option<f64>,
    seconds: f64,
}

/// All trainings of a recipe.
#[derive(Serialize)]
struct Search {
    recipe: Recipe,
    batch: usize,
    training_examples: usize,
    validation_examples: usize,
    points: Vec<Point>,
    /// Of the least validation loss.
    chosen: Option<usize>,
}

#[derive(Serialize)]
struct Report {
    rows: u64,
    training: Vec<String>,
    validation: Vec<String>,
    recipes: Vec<Search>,
}

/// Settings that are searched from: the recipe's own, and for the thesis's network, whose published ones are others, those of the
/// networks that learn from the same rows.
fn settings(recipe: Recipe) -> Config {
    let own = Config::for_recipe(recipe);
    match recipe.inputs {
        Inputs::Row(_) => {
            let rows = Config::for_recipe(Recipe::NMT);
            Config {
                batch: rows.batch,
                chunk: rows.chunk,
                schedule: Schedule::ONE_CYCLE,
                ..own
            }
        }
        _ => own,
    }
}

fn open(paths: &str) -> Result<Vec<Dataset>, Box<dyn Error>> {
    paths
        .split(',')
        .map(|path| Ok(Dataset::open(path)?))
        .collect()
}

/// Names of the scenes, and how many rows they have.
fn names(datasets: &[Dataset]) -> Vec<String> {
    let scenes = datasets.iter().flat_map(|d| {
        let manifest = d.manifest();
        manifest.scenes.iter().enumerate().map(|(k, scene)| {
            let parts = manifest.parts.iter().filter(|p| p.scene as usize == k);
            let rows: u64 = parts.map(|p| p.rows).sum();
            format!("{} ({rows} rows)", scene.name)
        })
    });
    scenes.collect()
}

fn search(
    recipe: Recipe,
    max_rows: u64,
    training: &[Dataset],
    validation: &[Dataset],
) -> Result<Search, Box<dyn Error>> {
    let base = Config {
        max_rows,
        ..settings(recipe)
    };
    let data = TrainingData::validated(&base, training, validation)?;
    let count = |subset| {
        let all = data.subsets.iter().flatten();
        all.filter(|s| **s == subset).count()
    };
    let mut all = Search {
        recipe,
        batch: base.batch,
        training_examples: count(Subset::Train),
        validation_examples: count(Subset::Validation),
        points: Vec::new(),
        chosen: None,
    };
    let folder = tempfile::tempdir()?;
    let stop = AtomicBool::new(false);
    for epochs in EPOCHS {
        for learning_rate in RATES {
            let config = Config {
                epochs,
                learning_rate,
                ..base.clone()
            };
            let options = RunOptions::new(folder.path().join("model.safetensors"), &stop);
            // A rate that diverges is a point without a loss.
            let outcome = train(&config, &data, &options, |_| {}).ok();
            let history = outcome.as_ref().map_or(&[][..], |o| &o.history);
            let point = Point {
                learning_rate,
                epochs,
                validation_loss: history.last().and_then(|e| e.held_out_loss),
                seconds: history.iter().map(|e| e.seconds).sum(),
            };
            println!(
                "{recipe}: rate {learning_rate}, {epochs} epochs: {:?} in {:.0} s",
                point.validation_loss, point.seconds
            );
            all.points.push(point);
        }
    }
    let losses = all.points.iter().enumerate();
    let losses = losses.filter_map(|(k, p)| Some((k, p.validation_loss?)));
    all.chosen = losses.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
    Ok(all)
}

impl Report {
    fn markdown(&self) -> Result<String, std::fmt::Error> {
        let mut t = format!(
            "Loss on the validation data after the last epoch, by recipe; the chosen point is in bold. Losses of different recipes are no \
             comparison: they measure different things. {} rows at most.\n\n- Trained on: {}.\n- Validated on: {}.\n\n| recipe | training \
             examples | validation examples | batch | epochs |",
            self.rows,
            self.training.join(", "),
            self.validation.join(", ")
        );
        for rate in RATES {
            write!(t, " rate {rate} |")?;
        }
        t.push_str("\n|---|---:|---:|---:|---:|---:|---:|---:|\n");
        for of in &self.recipes {
            for epochs in EPOCHS {
                let Search {
                    recipe,
                    batch,
                    training_examples,
                    validation_examples,
                    ..
                } = of;
                write!(
                    t,
                    "| {recipe} | {training_examples} | {validation_examples} | {batch} | {epochs} |"
                )?;
                for (k, point) in of.points.iter().enumerate() {
                    if point.epochs != epochs {
                        continue;
                    }
                    let loss = point
                        .validation_loss
                        .map_or_else(|| "diverged".to_owned(), |l| format!("{l:.4e}"));
                    let mark = if of.chosen == Some(k) { "**" } else { "" };
                    write!(t, " {mark}{loss}{mark} |")?;
                }
                t.push('\n');
            }
        }
        Ok(t)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (recipes, given) = match arguments.as_slice() {
        [given @ .., recipes] if given.len() == 4 => (
            recipes
                .split(',')
                .map(str::parse)
                .collect::<Result<_, String>>()?,
            given,
        ),
        given => (Recipe::ALL.to_vec(), given),
    };
    let [out, rows, training, validation] = given else {
        return Err("usage: search OUT ROWS TRAINING,... VALIDATION,... [RECIPE,...]".into());
    };
    let (training, validation) = (open(training)?, open(validation)?);
    let mut report = Report {
        rows: rows.parse()?,
        training: names(&training),
        validation: names(&validation),
        recipes: Vec::new(),
    };
    std::fs::create_dir_all(out)?;
    for recipe in recipes {
        let found = search(recipe, report.rows, &training, &validation)?;
        report.recipes.push(found);
        // What is done is kept where the rest is interrupted.
        let json = serde_json::to_string_pretty(&report)? + "\n";
        std::fs::write(Path::new(out).join("search.json"), json)?;
        std::fs::write(Path::new(out).join("search.md"), report.markdown()?)?;
    }
    Ok(())
}
