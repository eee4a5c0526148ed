//! From datasets to columns.

use std::collections::{BTreeMap, BTreeSet};

use peelnet_dataset::{Column, ColumnData, Dataset};
use peelnet_model::{DatasetRef, Model, Recipe};

use crate::error::TrainError;
use crate::recipe;
use crate::training_data::TrainingData;

impl TrainingData {
    /// The rows of all scenes that are not held out, dataset after dataset.
    ///
    /// # Errors
    /// A dataset that cannot be read, or a recipe that does not take columns as they are.
    pub fn from_datasets(recipe: Recipe, datasets: &[Dataset]) -> Result<Self, TrainError> {
        let columns = columns(recipe)?;
        let mut inputs = vec![Vec::new(); columns.len() - 1];
        let mut target = Vec::new();
        let mut scenes = BTreeSet::new();
        for dataset in datasets {
            let data = dataset.read_columns_where(&columns, |part| !dataset.is_held_out(part))?;
            let targets = inputs.iter_mut().chain([&mut target]);
            for (into, column) in targets.zip(data) {
                match column {
                    ColumnData::F32(values) if into.is_empty() => *into = values,
                    ColumnData::F32(values) => into.extend(values),
                    // Counts are far below 2²⁴, where 32-bit floats stop to hold every integer.
                    ColumnData::U32(values) => into.extend(values.iter().map(|&v| v as f32)),
                }
            }
            let scene_of = |part: &peelnet_dataset::Part| &dataset.manifest().scenes[part.scene as usize].name;
            scenes.extend(
                dataset
                    .manifest()
                    .parts
                    .iter()
                    .filter(|part| !dataset.is_held_out(part))
                    .map(|part| scene_of(part).clone()),
            );
        }
        let join = |texts: Vec<String>, with: &str| texts.join(with);
        Ok(Self {
            source: join(
                datasets.iter().map(|d| d.path().display().to_string()).collect(),
                ", ",
            ),
            dataset: Some(DatasetRef {
                hash: join(datasets.iter().map(|d| d.hash().to_owned()).collect(), "+"),
                rows: target.len() as u64,
                scenes: scenes.into_iter().collect(),
            }),
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
pub fn held_out_errors(model: &Model, datasets: &[Dataset]) -> Result<BTreeMap<String, f64>, TrainError> {
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
            let (target, inputs) = data.split_last().expect("the target is always among the columns");
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
