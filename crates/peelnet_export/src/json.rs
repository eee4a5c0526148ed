//! The description beside an exported text, for programs.

use crate::{ExportError, description::Description, self_test::SelfTest};
use peelnet_model::{DatasetRef, Model};
use serde::Serialize;
use std::collections::BTreeMap;

pub(crate) const FORMAT: &str = "peelnet-export";

/// Raised when a reader of older files would misread newer ones.
const FORMAT_VERSION: u32 = 1;

#[derive(Serialize)]
struct File<'a> {
    format: &'static str,
    format_version: u32,
    tool_version: &'static str,
    licence: &'static str,
    recipe: &'static str,
    topology: String,
    parameters: usize,
    seed: u64,
    epochs: u32,
    inputs: Vec<Input<'a>>,
    dataset: Option<&'a DatasetRef>,
    held_out: &'a BTreeMap<String, f64>,
    #[serde(flatten)]
    description: Description,
    /// Statistics and sums have to be kept and resolved by sample: averages of samples mean nothing.
    multisampling: &'static str,
    self_test: SelfTest,
}

#[derive(Serialize)]
struct Input<'a> {
    name: &'a str,
    unit: &'a str,
    min: f32,
    max: f32,
}

/// What the header of an exported text says, as JSON. The same for all languages.
///
/// # Errors
/// A model that does not hold together.
pub fn json(model: &Model) -> Result<String, ExportError> {
    model.check()?;
    let meta = &model.meta;
    let inputs = meta.inputs.iter().map(|i| Input {
        name: &i.name,
        unit: &i.unit,
        min: i.min,
        max: i.max,
    });
    let file = File {
        format: FORMAT,
        format_version: FORMAT_VERSION,
        tool_version: env!("CARGO_PKG_VERSION"),
        licence: "MIT OR Apache-2.0",
        recipe: meta.recipe.name,
        topology: model.mlp.topology(),
        parameters: model.mlp.parameters(),
        seed: meta.seed,
        epochs: meta.epochs,
        inputs: inputs.collect(),
        dataset: meta.dataset.as_ref(),
        held_out: &meta.held_out,
        description: Description::new(meta.recipe),
        multisampling: "by-sample",
        self_test: SelfTest::new(model),
    };
    let text = serde_json::to_string_pretty(&file);
    let refused =
        |e| ExportError::Refused(format!("the description cannot be written as JSON: {e}"));
    Ok(text.map_err(refused)? + "\n")
}
