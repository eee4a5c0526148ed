//! From datasets to columns.

use std::collections::BTreeMap;

use peelnet_core::features::Feature;
use peelnet_core::methods::deep::Row;
use peelnet_dataset::{Column, Dataset, Split, Subset};
use peelnet_model::{DatasetRef, Inputs, Model};

use crate::config::Config;
use crate::error::TrainError;
use crate::pixels;
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
            _ => pixels::gather(config.recipe, &split, datasets)?,
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
        // A handful of pixels may all fall on one side: then the trainer draws examples.
        let there = |subset, share: f64| {
            share == 0.0 || data.subsets.iter().flatten().any(|&s| s == subset)
        };
        let usable = there(Subset::Train, 1.0)
            && there(Subset::Test, config.held_out)
            && there(Subset::Validation, config.validation);
        data.subsets = data.subsets.take().filter(|_| usable);
        Ok(data)
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
    let mut inputs = vec![Vec::new(); features.len()];
    let mut targets = Vec::new();
    let mut subsets = Vec::new();
    for dataset in datasets {
        let data = dataset.read_columns_where(&COLUMNS, |part| !dataset.is_held_out(part))?;
        let [linear_depth, alpha_sum, transmittance] =
            [0, 1, 2].map(|k| data[k].as_f32().unwrap_or_default());
        let [count, view, x, y] = [3, 4, 5, 6].map(|k| data[k].as_u32().unwrap_or_default());
        for i in 0..transmittance.len() {
            let row = Row {
                linear_depth: linear_depth[i],
                alpha_sum: alpha_sum[i],
                // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
                fragment_count: count[i] as f32,
            };
            for (column, feature) in inputs.iter_mut().zip(features) {
                column.push((feature.value)(&row) as f32);
            }
            subsets.push(split.pixel(view[i], x[i], y[i]));
        }
        targets.extend_from_slice(transmittance);
    }
    Ok(TrainingData {
        source: String::new(),
        inputs,
        targets: vec![targets],
        weights: None,
        pixels: None,
        subsets: Some(subsets),
        dataset: None,
    })
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
            let warp = pixels::warp(dataset, part)?;
            pixels::for_each_pixel(dataset, part, |_, pixel| {
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
