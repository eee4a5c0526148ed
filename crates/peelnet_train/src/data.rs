//! From datasets to columns.

use std::collections::BTreeMap;

use peelnet_dataset::{Dataset, FragmentBatch, Part, Split, SplitBy, Subset};
use peelnet_model::{DatasetRef, Model};

use crate::config::Config;
use crate::error::TrainError;
use crate::gather;
use crate::pixels::{self, View};
use crate::sample::Sample;
use crate::training_data::{DataSplit, TrainingData, UsedRows};

impl TrainingData {
    /// The rows of all scenes that are not held out, dataset after dataset.
    ///
    /// Of these, the shares [`Config::held_out`] and [`Config::validation`] are set aside: whole scenes where [`Config::split`] says so
    /// and there are enough of them, else whole pixels, whose fragments have their sum and count in common and say almost everything
    /// about one another. Each world of a synthetic dataset counts as a scene. [`TrainingData::split`] says what was done.
    ///
    /// # Errors
    /// A dataset that cannot be read.
    pub fn from_datasets(config: &Config, datasets: &[Dataset]) -> Result<Self, TrainError> {
        Self::of_plan(config, Plan::of_datasets(config, datasets)?)
    }

    /// The rows of `training` to learn from and those of `validation` to choose by: whole scenes, because pixels of one view say much
    /// about one another. Nothing is set aside for testing.
    ///
    /// # Errors
    /// A dataset that cannot be read.
    pub fn validated(
        config: &Config,
        training: &[Dataset],
        validation: &[Dataset],
    ) -> Result<Self, TrainError> {
        let plan = Plan::new(&[
            (training, &|_, _| Split::whole(Subset::Train)),
            (validation, &|_, _| Split::whole(Subset::Validation)),
        ]);
        Self::of_plan(config, plan)
    }

    fn of_plan(config: &Config, plan: Plan<'_>) -> Result<Self, TrainError> {
        let mut sample = Sample::new(config.seed, config.max_rows, plan.dataset.rows);
        let mut data = gather::in_memory(config.recipe, &mut sample, plan.views())?;
        data.used = Some(UsedRows {
            used: sample.kept()?,
            of: plan.dataset.rows,
        });
        data.source = plan.source;
        data.dataset = Some(plan.dataset);
        if plan.split.is_some() {
            data.check_split(config);
        }
        // Scenes whose share of the rows holds no example of a subset are not set aside.
        data.split = plan
            .split
            .filter(|split| data.subsets.is_some() || matches!(split, DataSplit::Pixels { .. }));
        Ok(data)
    }

    /// Rows in memory, such as `peelnet_peel::batches` yields: whole pixels, the fragments of each from near to far. Batches that
    /// follow one another with the same number of the view are one view. `source` names them in messages. Held-out scenes are the
    /// caller's to leave out.
    ///
    /// The shares are set aside by pixels. They are those of [`TrainingData::from_datasets`] with [`SplitBy::Pixel`], so the same rows
    /// train the same network.
    ///
    /// # Errors
    /// Columns of different lengths, or settings out of their range.
    pub fn from_batches(
        config: &Config,
        source: &str,
        batches: &[FragmentBatch],
    ) -> Result<Self, TrainError> {
        let split = Split::new(config.seed, config.validation, config.held_out)?;
        for batch in batches {
            batch.check()?;
        }
        let views = batches.chunk_by(|a, b| a.view.first() == b.view.first());
        let views = views.map(|batches| (View::Held(batches), split));
        let mut data = gather::in_memory(config.recipe, &mut Sample::all(), views)?;
        data.source = source.to_owned();
        data.check_split(config);
        Ok(data)
    }

    /// Drops a split that leaves a part without examples: a handful of pixels may all fall on one side. Then the trainer draws
    /// examples.
    fn check_split(&mut self, config: &Config) {
        let there = |subset, share: f64| {
            share == 0.0 || self.subsets.iter().flatten().any(|&s| s == subset)
        };
        let usable = there(Subset::Train, 1.0)
            && there(Subset::Test, config.held_out)
            && there(Subset::Validation, config.validation);
        self.subsets = self.subsets.take().filter(|_| usable);
    }
}

/// The split of a part's pixels.
type SplitOf<'a> = &'a dyn Fn(&Dataset, &Part) -> Split;

/// The views that are trained on, and what is known of them before they are read.
pub(crate) struct Plan<'a> {
    parts: Vec<(&'a Dataset, &'a Part, Split)>,
    /// The paths, for messages.
    pub(crate) source: String,
    pub(crate) dataset: DatasetRef,
    /// How rows are set aside; none where the datasets themselves say what for.
    pub(crate) split: Option<DataSplit>,
}

impl<'a> Plan<'a> {
    /// The plan of [`TrainingData::from_datasets`].
    pub(crate) fn of_datasets(
        config: &Config,
        datasets: &'a [Dataset],
    ) -> Result<Self, TrainError> {
        let split = Split::new(config.seed, config.validation, config.held_out)?;
        let scenes = scenes_of(datasets);
        let rows: BTreeMap<&str, u64> = scenes.iter().map(|(n, r)| (n.as_str(), *r)).collect();
        let subsets = (config.split == SplitBy::Scene)
            .then(|| split.scenes(&rows))
            .flatten();
        let Some(subsets) = subsets else {
            let mut plan = Self::new(&[(datasets, &|_, _| split)]);
            plan.split = Some(DataSplit::Pixels {
                scenes: scenes.len(),
            });
            return Ok(plan);
        };
        let of = |dataset: &Dataset, part: &Part| {
            let subset = subsets.get(scene_of(dataset, part).as_str());
            Split::whole(subset.copied().unwrap_or(Subset::Train))
        };
        let mut plan = Self::new(&[(datasets, &of)]);
        let names = |wanted: Subset| {
            let of = subsets.iter().filter(move |(_, s)| **s == wanted);
            of.map(|(name, _)| (*name).to_owned()).collect()
        };
        let aside = DataSplit::Scenes {
            validation: names(Subset::Validation),
            test: names(Subset::Test),
        };
        let all = std::mem::take(&mut plan.dataset.scenes);
        (plan.dataset.set_aside, plan.dataset.scenes) =
            all.into_iter().partition(|name| aside.contains(name));
        plan.split = Some(aside);
        Ok(plan)
    }

    /// All scenes that are not held out, of datasets with the split of each part's pixels.
    fn new(all: &[(&'a [Dataset], SplitOf<'_>)]) -> Self {
        let datasets = || {
            all.iter()
                .flat_map(|(datasets, split)| datasets.iter().map(move |d| (d, split)))
        };
        let parts: Vec<(&Dataset, &Part, Split)> = datasets()
            .flat_map(|(dataset, split)| {
                let parts = dataset.manifest().parts.iter();
                let parts = parts.filter(move |part| !dataset.is_held_out(part));
                parts.map(move |part| (dataset, part, split(dataset, part)))
            })
            .collect();
        let rows = parts.iter().map(|(_, part, _)| part.rows);
        let hashes: Vec<&str> = datasets().map(|(d, _)| d.hash()).collect();
        let dataset = DatasetRef {
            hash: hashes.join("+"),
            rows: rows.fold(0, u64::saturating_add),
            set_aside: Vec::new(),
            scenes: pixels::training_scenes(datasets().map(|(d, _)| d))
                .into_iter()
                .collect(),
        };
        let paths: Vec<String> = datasets()
            .map(|(d, _)| d.path().display().to_string())
            .collect();
        Self {
            parts,
            source: paths.join(", "),
            dataset,
            split: None,
        }
    }

    /// The views that have rows.
    pub(crate) fn views(&self) -> impl Iterator<Item = (View<'a>, Split)> + '_ {
        let parts = self.parts.iter().filter(|(_, part, _)| part.rows > 0);
        parts.map(|&(dataset, part, split)| (View::Stored(dataset, part), split))
    }
}

/// The name that a part's rows are split by: its scene, or of a synthetic dataset its world.
fn scene_of(dataset: &Dataset, part: &Part) -> String {
    let manifest = dataset.manifest();
    let name = &manifest.scenes[part.scene as usize].name;
    if manifest.peel == SYNTHETIC {
        format!("{name} {}", part.index)
    } else {
        name.clone()
    }
}

/// How a dataset's manifest says that its lists were made up.
const SYNTHETIC: &str = "synthetic";

/// Rows of each scene that is not held out.
fn scenes_of(datasets: &[Dataset]) -> BTreeMap<String, u64> {
    let mut rows = BTreeMap::new();
    for dataset in datasets {
        let parts = dataset.manifest().parts.iter();
        for part in parts.filter(|p| p.rows > 0 && !dataset.is_held_out(p)) {
            *rows.entry(scene_of(dataset, part)).or_default() += part.rows;
        }
    }
    rows
}

/// Mean `|T̂ − T|` over the fragments of each held-out scene, by scene: what [`Metadata::held_out`] records. Empty for a
/// network that predicts no transmittance.
///
/// [`Metadata::held_out`]: peelnet_model::Metadata::held_out
///
/// # Errors
/// A dataset that cannot be read.
pub fn held_out_errors(
    model: &Model,
    datasets: &[Dataset],
) -> Result<BTreeMap<String, f64>, TrainError> {
    let mut sums: BTreeMap<String, (f64, u64)> = BTreeMap::new();
    for dataset in datasets {
        let manifest = dataset.manifest();
        for part in manifest.parts.iter().filter(|p| dataset.is_held_out(p)) {
            let sum = sums
                .entry(manifest.scenes[part.scene as usize].name.clone())
                .or_default();
            let view = View::Stored(dataset, part);
            let warp = view.warp()?;
            view.for_each_pixel(|_, pixel| {
                let precision = model.meta.recipe.sums;
                let weights = model.transmittances(pixel.points, &warp, precision);
                for (w, &t) in weights.iter().zip(pixel.transmittance) {
                    sum.0 += (w - f64::from(t)).abs();
                    sum.1 += 1;
                }
            })?;
        }
    }
    Ok(sums
        .into_iter()
        .filter(|(_, (_, rows))| *rows > 0)
        .map(|(scene, (sum, rows))| (scene, sum / rows as f64))
        .collect())
}
