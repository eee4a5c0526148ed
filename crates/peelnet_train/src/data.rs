//! From datasets to columns.

use std::collections::BTreeMap;

use peelnet_core::features::Feature;
use peelnet_core::methods::deep::Row;
use peelnet_dataset::{Column, Dataset, FragmentBatch, Split, Subset};
use peelnet_model::{DatasetRef, Inputs, Model};

use crate::config::Config;
use crate::error::TrainError;
use crate::pixels::{self, View};
use crate::training_data::TrainingData;

impl TrainingData {
    /// The rows of all scenes that are not held out, dataset after dataset.
    ///
    /// Of these, the shares [`Config::held_out`] and [`Config::validation`] are set aside by whole pixels: the fragments of a pixel have their sum
    /// and count in common and say almost everything about one another.
    ///
    /// # Errors
    /// A dataset that cannot be read.
    pub fn from_datasets(config: &Config, datasets: &[Dataset]) -> Result<Self, TrainError> {
        let split = Split::new(config.seed, config.validation, config.held_out)?;
        let mut data = match config.recipe.inputs {
            Inputs::Row(features) => rows(features, &split, datasets)?,
            _ => pixels::gather(
                config.recipe,
                &split,
                datasets.iter().flat_map(|dataset| {
                    let ours = dataset.manifest().parts.iter();
                    ours.filter(|part| !dataset.is_held_out(part) && part.rows > 0)
                        .map(|part| View::Stored(dataset, part))
                }),
            )?,
        };
        let paths: Vec<String> = datasets
            .iter()
            .map(|d| d.path().display().to_string())
            .collect();
        data.source = paths.join(", ");
        let hashes: Vec<&str> = datasets.iter().map(Dataset::hash).collect();
        let rows = datasets.iter().flat_map(|d| {
            let ours = d.manifest().parts.iter();
            ours.filter(|part| !d.is_held_out(part)).map(|p| p.rows)
        });
        data.dataset = Some(DatasetRef {
            hash: hashes.join("+"),
            rows: rows.sum(),
            scenes: pixels::training_scenes(datasets).into_iter().collect(),
        });
        data.check_split(config);
        Ok(data)
    }

    /// Rows in memory, such as `peelnet_peel::batches` yields: whole pixels, the fragments of each from near to far. Batches that
    /// follow one another with the same number of the view are one view. `source` names them in messages. Held-out scenes are the
    /// caller's to leave out.
    ///
    /// The shares that are set aside are those of [`TrainingData::from_datasets`], so the same rows train the same network.
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
        let mut data = match config.recipe.inputs {
            Inputs::Row(features) => {
                let mut data = Self::of_rows(features);
                for b in batches {
                    let floats = [&b.linear_depth, &b.alpha_sum, &b.transmittance];
                    let integers = [&b.fragment_count, &b.view, &b.x, &b.y];
                    append(
                        &mut data,
                        features,
                        &split,
                        floats.map(Vec::as_slice),
                        integers.map(Vec::as_slice),
                    );
                }
                data
            }
            _ => {
                let views = batches.chunk_by(|a, b| a.view.first() == b.view.first());
                pixels::gather(config.recipe, &split, views.map(View::Held))?
            }
        };
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

    fn of_rows(features: &[&Feature<Row>]) -> Self {
        Self {
            source: String::new(),
            inputs: vec![Vec::new(); features.len()],
            targets: vec![Vec::new()],
            weights: None,
            pixels: None,
            subsets: Some(Vec::new()),
            dataset: None,
        }
    }
}

/// Every row is an example with its transmittance as the target.
fn rows(
    features: &[&Feature<Row>],
    split: &Split,
    datasets: &[Dataset],
) -> Result<TrainingData, TrainError> {
    const COLUMNS: [Column; 7] = [
        Column::LinearDepth,
        Column::AlphaSum,
        Column::Transmittance,
        Column::FragmentCount,
        Column::View,
        Column::X,
        Column::Y,
    ];
    let mut all = TrainingData::of_rows(features);
    for dataset in datasets {
        let data = dataset.read_columns_where(&COLUMNS, |part| !dataset.is_held_out(part))?;
        append(
            &mut all,
            features,
            split,
            [0, 1, 2].map(|k| data[k].as_f32().unwrap_or_default()),
            [3, 4, 5, 6].map(|k| data[k].as_u32().unwrap_or_default()),
        );
    }
    Ok(all)
}

/// Appends rows as examples.
fn append(
    data: &mut TrainingData,
    features: &[&Feature<Row>],
    split: &Split,
    [linear_depth, alpha_sum, transmittance]: [&[f32]; 3],
    [count, view, x, y]: [&[u32]; 4],
) {
    for i in 0..transmittance.len() {
        let row = Row {
            linear_depth: linear_depth[i],
            alpha_sum: alpha_sum[i],
            // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
            fragment_count: count[i] as f32,
        };
        for (column, feature) in data.inputs.iter_mut().zip(features) {
            column.push((feature.value)(&row) as f32);
        }
        let subset = split.pixel(view[i], x[i], y[i]);
        data.subsets.iter_mut().for_each(|all| all.push(subset));
    }
    data.targets[0].extend_from_slice(transmittance);
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
