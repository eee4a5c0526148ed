//! From datasets to columns.

use std::collections::{BTreeMap, BTreeSet};

use peelnet_dataset::{Column, ColumnData, Dataset, Split, Subset};
use peelnet_model::{DatasetRef, Model, Recipe};

use crate::config::Config;
use crate::error::TrainError;
use crate::recipe;
use crate::training_data::TrainingData;

impl TrainingData {
    /// The rows of all scenes that are not held out, dataset after dataset.
    ///
    /// Of these, the share [`Config::held_out`] is set aside by whole pixels: the fragments of a pixel have their sum
    /// and count in common and say almost everything about one another.
    ///
    /// # Errors
    /// A dataset that cannot be read, or a recipe that does not take columns as they are.
    pub fn from_datasets(config: &Config, datasets: &[Dataset]) -> Result<Self, TrainError> {
        let mut columns = columns(config.recipe)?;
        let features = columns.len() - 1;
        columns.extend([Column::View, Column::X, Column::Y]);
        let mut inputs = vec![Vec::new(); features];
        let mut target = Vec::new();
        let mut held_out = Vec::new();
        let mut scenes = BTreeSet::new();
        let split = Split::new(config.seed, 0.0, config.held_out)?;
        for dataset in datasets {
            let mut data =
                dataset.read_columns_where(&columns, |part| !dataset.is_held_out(part))?;
            let pixels = data.split_off(features + 1);
            if let [view, x, y] = pixels.as_slice()
                && let (Some(view), Some(x), Some(y)) = (view.as_u32(), x.as_u32(), y.as_u32())
            {
                held_out.extend(
                    view.iter()
                        .zip(x.iter().zip(y))
                        .map(|(&view, (&x, &y))| split.pixel(view, x, y) == Subset::Test),
                );
            }
            for (into, column) in inputs.iter_mut().chain([&mut target]).zip(data) {
                match column {
                    ColumnData::F32(values) if into.is_empty() => *into = values,
                    ColumnData::F32(values) => into.extend(values),
                    // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
                    ColumnData::U32(values) => into.extend(values.iter().map(|&v| v as f32)),
                }
            }
            let manifest = dataset.manifest();
            scenes.extend(
                manifest
                    .parts
                    .iter()
                    .filter(|part| !dataset.is_held_out(part))
                    .map(|part| manifest.scenes[part.scene as usize].name.clone()),
            );
        }
        let paths: Vec<String> = datasets
            .iter()
            .map(|d| d.path().display().to_string())
            .collect();
        let hashes: Vec<&str> = datasets.iter().map(Dataset::hash).collect();
        // A handful of pixels may all fall on one side: then the trainer draws rows.
        let usable =
            held_out.contains(&false) && (config.held_out == 0.0 || held_out.contains(&true));
        Ok(Self {
            source: paths.join(", "),
            dataset: Some(DatasetRef {
                hash: hashes.join("+"),
                rows: target.len() as u64,
                scenes: scenes.into_iter().collect(),
            }),
            held_out: usable.then_some(held_out),
            inputs,
            target,
        })
    }
}

/// The recipe's features as columns of the dataset, then the target.
fn columns(recipe: Recipe) -> Result<Vec<Column>, TrainError> {
    let mut columns = recipe::definition(recipe)?
        .features
        .iter()
        .map(|feature| Column::from_name(feature.name).ok_or(TrainError::Recipe(recipe)))
        .collect::<Result<Vec<_>, _>>()?;
    columns.push(Column::Transmittance);
    Ok(columns)
}

/// Mean `|T̂ − T|` over the fragments of each held-out scene, by scene: what [`Metadata::held_out`] records.
///
/// [`Metadata::held_out`]: peelnet_model::Metadata::held_out
///
/// # Errors
/// A dataset that cannot be read, or a model whose inputs are not columns.
pub fn held_out_errors(
    model: &Model,
    datasets: &[Dataset],
) -> Result<BTreeMap<String, f64>, TrainError> {
    let columns = columns(model.meta.recipe)?;
    let mut sums: BTreeMap<String, (f64, u64)> = BTreeMap::new();
    for dataset in datasets {
        let manifest = dataset.manifest();
        for (scene, entry) in manifest.scenes.iter().enumerate() {
            if !entry.held_out {
                continue;
            }
            let data = dataset.read_columns_where(&columns, |part| part.scene as usize == scene)?;
            let sum = sums.entry(entry.name.clone()).or_default();
            let value = |column: &ColumnData, row: usize| match column {
                ColumnData::F32(values) => values[row],
                ColumnData::U32(values) => values[row] as f32,
            };
            let (target, inputs) = data
                .split_last()
                .expect("the target is always among the columns");
            let mut raw = vec![0.0; inputs.len()];
            for row in 0..target.len() {
                for (into, column) in raw.iter_mut().zip(inputs) {
                    *into = value(column, row);
                }
                sum.0 += f64::from(model.forward_raw(&raw)[0] - value(target, row)).abs();
                sum.1 += 1;
            }
        }
    }
    Ok(sums
        .into_iter()
        .filter(|(_, (_, rows))| *rows > 0)
        .map(|(scene, (sum, rows))| (scene, sum / rows as f64))
        .collect())
}
