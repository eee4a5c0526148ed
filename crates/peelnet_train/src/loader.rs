//! From datasets to examples, in memory or in a scratch file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use peelnet_dataset::{Dataset, Part, SceneEntry, Split, SplitBy, Subset};
use peelnet_model::{DatasetRef, Model};

use crate::config::Config;
use crate::draws::Sample;
use crate::error::TrainError;
use crate::examples::{View, each_pixel, gather};
use crate::scratch::Scratch;
use crate::table::{DataSplit, TrainingData, UsedRows};

impl TrainingData {
    /// The rows of all scenes that are not held out, dataset after dataset.
    ///
    /// Of these, the shares [`Config::held_out`] and [`Config::validation`] are set aside: whole scenes where [`Config::split`] says so
    /// and there are enough of them, else whole pixels, whose fragments have their sum and count in common and say almost everything
    /// about one another. Each world of a synthetic dataset counts as a scene. [`TrainingData::split`] says what was done.
    pub fn from_datasets(config: &Config, datasets: &[Dataset]) -> Result<Self, TrainError> {
        let plan = Plan::new(config, datasets)?;
        let mut sample = Sample::new(config.seed, config.max_rows, plan.dataset.rows);
        let mut data = Self::for_recipe(config.recipe);
        let mut ends = vec![0; plan.views.len()];
        let factors = gather(
            config.recipe,
            &mut data,
            plan.views,
            &mut sample,
            |view, _, data| {
                ends[view] = data.examples_held();
                Ok(())
            },
        )?;
        if let Some(weights) = &mut data.weights {
            let mut first = 0;
            for (view, end) in ends.into_iter().enumerate() {
                factors.apply(view, &mut weights[first..end]);
                first = end;
            }
        }
        data.used = Some(UsedRows {
            used: sample.rows_kept()?,
            of: plan.dataset.rows,
        });
        if data.examples_held() == 0 {
            let rows = plan.dataset.rows;
            return Err(TrainError::no_examples(&plan.source, config.recipe, rows));
        }
        if lacking(&data, config).is_some() {
            // Scenes whose share of the rows holds no example of a subset are not set aside: pixels of all scenes are, and all are named as
            // trained on.
            if matches!(plan.split, DataSplit::Scenes { .. }) {
                let split = SplitBy::Pixel;
                let by_pixel = Config {
                    split,
                    ..config.clone()
                };
                return Self::from_datasets(&by_pixel, datasets);
            }
            // A handful of pixels may all fall on one side. Then the trainer draws examples.
            data.subsets = None;
        }
        data.split = Some(plan.split);
        (data.source, data.dataset) = (plan.source, Some(plan.dataset));
        Ok(data)
    }

    /// The same examples in a file without a name in `folder`, which is made if it is not there; [`Config::buffer_rows`] rows are in memory at
    /// once. The file takes [`TrainingData::scratch_bytes`] and is gone when the process ends. All rows are used, whatever
    /// [`Config::max_rows`] says.
    ///
    /// `stop` ends the reading from anywhere. `on_rows` gets the rows that were read and those of the datasets.
    ///
    /// # Errors
    /// A dataset that cannot be read, a file that cannot be written, no examples for a subset, or [`TrainError::Stopped`].
    pub fn streamed(
        config: &Config,
        datasets: &[Dataset],
        folder: &Path,
        stop: &AtomicBool,
        mut on_rows: impl FnMut(u64, u64),
    ) -> Result<Self, TrainError> {
        let plan = Plan::new(config, datasets)?;
        let mut data = Self::for_recipe(config.recipe);
        let mut scratch = Scratch::create(folder, data.inputs.len())?;
        let mut read = 0;
        scratch.weights = gather(
            config.recipe,
            &mut data,
            plan.views,
            // All rows.
            &mut Sample::new(0, u64::MAX, 0),
            |view, rows, data| {
                if stop.load(Ordering::Relaxed) {
                    return Err(TrainError::Stopped);
                }
                data.check_values(config.recipe, &plan.source, scratch.rows)?;
                scratch.write(view, data)?;
                data.clear();
                read += rows as u64;
                on_rows(read, plan.dataset.rows);
                Ok(())
            },
        )?;
        if scratch.rows == 0 {
            let rows = plan.dataset.rows;
            return Err(TrainError::no_examples(&plan.source, config.recipe, rows));
        }
        data.scratch = Some(Arc::new(scratch));
        if let Some(name) = lacking(&data, config) {
            let problem = format!(
                "no example is left for {name}: so few rows are trained on in memory, without streaming"
            );
            return Err(TrainError::rows(&plan.source, &problem));
        }
        data.split = Some(plan.split);
        (data.source, data.dataset) = (plan.source, Some(plan.dataset));
        Ok(data)
    }
}

/// What examples should be left for and are not.
fn lacking(data: &TrainingData, config: &Config) -> Option<&'static str> {
    let fractions = [
        (Subset::Train, 1.0, "training"),
        (Subset::Validation, config.validation, "validation"),
        (Subset::Test, config.held_out, "testing"),
    ];
    let mut fractions = fractions.into_iter();
    let lacks =
        fractions.find(|&(subset, fraction, _)| fraction > 0.0 && data.examples(subset) == 0);
    lacks.map(|(.., name)| name)
}

/// The views that are trained on, and what is known of them before they are read.
struct Plan<'a> {
    /// Those that have rows.
    views: Vec<View<'a>>,
    /// The paths, for messages.
    source: String,
    dataset: DatasetRef,
    split: DataSplit,
}

impl<'a> Plan<'a> {
    fn new(config: &Config, datasets: &'a [Dataset]) -> Result<Self, TrainError> {
        check_contents(datasets)?;
        let by_pixel = Split::new(config.seed, config.validation, config.held_out)?;
        let parts: Vec<(&Dataset, &Part)> = datasets.iter().flat_map(trained_on).collect();
        let mut rows: BTreeMap<String, u64> = BTreeMap::new();
        for (dataset, part) in parts.iter().filter(|(_, part)| part.rows > 0) {
            *rows.entry(split_name(dataset, part)).or_default() += part.rows;
        }
        let named = rows.iter().map(|(name, rows)| (name.as_str(), *rows));
        let subsets = (config.split == SplitBy::Scene)
            .then(|| by_pixel.scenes(&named.collect()))
            .flatten();
        let names = |wanted: Subset| {
            let subsets = subsets.iter().flatten().filter(|(_, s)| **s == wanted);
            subsets.map(|(name, _)| (*name).to_owned()).collect()
        };
        let (validation, test): (Vec<_>, Vec<_>) = (names(Subset::Validation), names(Subset::Test));
        let scenes = parts.iter().map(|(d, p)| scene_name(d, p).to_owned());
        let scenes: BTreeSet<String> = scenes.collect();
        let (set_aside, scenes): (Vec<String>, Vec<String>) = scenes
            .into_iter()
            .partition(|name| validation.contains(name) || test.contains(name));
        let entries = parts.iter().map(|(d, p)| scene_entry(d, p));
        let trained = entries.filter(|e| scenes.contains(&e.name) && !e.content.is_empty());
        let contents: BTreeSet<&String> = trained.map(|e| &e.content).collect();
        let contents = contents.into_iter().cloned().collect();
        let split_of = |dataset, part| match &subsets {
            None => by_pixel,
            Some(subsets) => {
                let subset = subsets.get(split_name(dataset, part).as_str());
                Split::whole(subset.copied().unwrap_or(Subset::Train))
            }
        };
        let views = parts.iter().filter(|(_, part)| part.rows > 0);
        let views = views.map(|&(dataset, part)| View {
            dataset,
            part,
            split: split_of(dataset, part),
        });
        let hashes: Vec<&str> = datasets.iter().map(Dataset::hash).collect();
        let paths = datasets.iter().map(|d| d.path().display().to_string());
        Ok(Self {
            views: views.collect(),
            source: paths.collect::<Vec<_>>().join(", "),
            dataset: DatasetRef {
                hash: hashes.join("+"),
                rows: parts
                    .iter()
                    .map(|(_, p)| p.rows)
                    .fold(0, u64::saturating_add),
                set_aside,
                scenes,
                contents,
            },
            split: match subsets {
                Some(_) => DataSplit::Scenes { validation, test },
                None => DataSplit::Pixels { scenes: rows.len() },
            },
        })
    }
}

/// The parts of scenes that are not held out.
fn trained_on(dataset: &Dataset) -> impl Iterator<Item = (&Dataset, &Part)> {
    let parts = dataset.manifest().parts.iter();
    let parts = parts.filter(|part| !dataset.is_held_out(part));
    parts.map(move |part| (dataset, part))
}

fn scene_entry<'a>(dataset: &'a Dataset, part: &Part) -> &'a SceneEntry {
    &dataset.manifest().scenes[part.scene as usize]
}

fn scene_name<'a>(dataset: &'a Dataset, part: &Part) -> &'a str {
    &scene_entry(dataset, part).name
}

/// A dataset that is named twice would count twice, and a scene under two names would be trained on under one and judge under the other.
fn check_contents(datasets: &[Dataset]) -> Result<(), TrainError> {
    for (k, dataset) in datasets.iter().enumerate() {
        let mut others = datasets[..k].iter();
        if let Some(first) = others.find(|other| other.hash() == dataset.hash()) {
            return Err(TrainError::Failed(format!(
                "{} and {} hold the same rows; name one of them",
                first.path().display(),
                dataset.path().display()
            )));
        }
    }
    let mut views = BTreeMap::new();
    for (dataset, part) in datasets.iter().flat_map(trained_on) {
        let (content, manifest) = (&scene_entry(dataset, part).content, dataset.manifest());
        let seed = if part.copy > 0 { manifest.seed } else { 0 };
        let key = (content, part.copy, seed, part.view, part.width, part.height);
        if let Some(first) = views
            .insert(key, dataset.path())
            .filter(|_| !content.is_empty())
        {
            return Err(TrainError::Failed(format!(
                "{} and {} both hold view {} of scene '{}', whose rows would count twice; extract it once",
                first.display(),
                dataset.path().display(),
                part.view,
                scene_name(dataset, part)
            )));
        }
    }
    let mut names: BTreeMap<&str, &SceneEntry> = BTreeMap::new();
    let mut contents: BTreeMap<&str, &SceneEntry> = BTreeMap::new();
    let scenes = datasets.iter().flat_map(|d| &d.manifest().scenes);
    for scene in scenes.filter(|scene| !scene.content.is_empty()) {
        let first = *names.entry(&scene.content).or_insert(scene);
        if (&first.name, first.held_out) != (&scene.name, scene.held_out) {
            return Err(TrainError::Failed(format!(
                "scenes '{}' ({}) and '{}' ({}) show the same, and what is trained on may not judge the network; leave one out",
                first.name, first.file, scene.name, scene.file
            )));
        }
        let first = *contents.entry(&scene.name).or_insert(scene);
        if first.content != scene.content {
            return Err(TrainError::Failed(format!(
                "scenes of {} and {} are both named '{}' and show different things; rename one, because what is trained on and held out is known by name",
                first.file, scene.file, scene.name
            )));
        }
    }
    Ok(())
}

/// The name that a part's rows are split by: its scene, or of a synthetic dataset its world.
fn split_name(dataset: &Dataset, part: &Part) -> String {
    let name = scene_name(dataset, part);
    if dataset.manifest().peel == "synthetic" {
        format!("{name} {}", part.index)
    } else {
        name.to_owned()
    }
}

/// Mean `|T̂ − T|` over the fragments of each held-out scene, by scene: what [`Metadata::held_out`] records. Empty for a
/// network that predicts no transmittance.
///
/// [`Metadata::held_out`]: peelnet_model::Metadata::held_out
pub fn held_out_errors(
    model: &Model,
    datasets: &[Dataset],
) -> Result<BTreeMap<String, f64>, TrainError> {
    let mut sums: BTreeMap<String, (f64, u64)> = BTreeMap::new();
    let precision = model.meta.recipe.sums;
    for dataset in datasets {
        let parts = dataset.manifest().parts.iter();
        for part in parts.filter(|part| dataset.is_held_out(part)) {
            let name = scene_name(dataset, part).to_owned();
            let sum = sums.entry(name).or_default();
            let view = View {
                dataset,
                part,
                split: Split::whole(Subset::HeldOut),
            };
            let frame = view.frame(model.meta.recipe)?;
            for batch in view.batches() {
                each_pixel(&batch?, &frame, precision, |_, pixel| {
                    let weights = model.transmittances(&pixel.observed);
                    for (w, &t) in weights.iter().zip(pixel.transmittance) {
                        sum.0 += (w - f64::from(t)).abs();
                        sum.1 += 1;
                    }
                });
            }
        }
    }
    let sums = sums.into_iter().filter(|(_, (_, rows))| *rows > 0);
    let means = sums.map(|(scene, (sum, rows))| (scene, sum / rows as f64));
    Ok(means.collect())
}
