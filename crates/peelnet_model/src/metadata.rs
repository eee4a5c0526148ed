//! What a model knows about itself.

use std::{collections::BTreeMap, fmt};

use num_traits::{Float, clamp};
use peelnet_core::guards::{INPUT_LIMIT, RAW_LIMIT};
use serde::{Deserialize, Serialize};

use crate::error::Problem;
use crate::output::Output;
use crate::recipe::Recipe;

/// The version of the file's layout that this crate writes and reads.
pub const FORMAT_VERSION: u32 = 1;

/// Largest weight, offset and scale: products of three of them and their sums are finite in 32 bits, in which shaders are compiled.
pub(crate) const LARGEST: f32 = 1e12;

/// An input of the network: `normalised = (raw − offset) · scale`, both cut off far outside of real data
/// ([`RAW_LIMIT`], [`INPUT_LIMIT`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The feature's name, an identifier.
    pub name: String,
    /// The raw feature's unit, such as `scene units` or `1`.
    pub unit: String,
    /// Subtracted from the raw feature.
    pub offset: f32,
    /// Multiplies the difference.
    pub scale: f32,
    /// Smallest raw value seen in training.
    pub min: f32,
    /// Largest raw value seen in training.
    pub max: f32,
}

impl Input {
    /// The normalised value of a raw one, in 32 or 64 bits.
    pub fn normalise<F: Float + From<f32>>(&self, raw: F) -> F {
        let limited = |x: F, limit: f32| clamp(x, (-limit).into(), limit.into());
        let from_offset = limited(raw, RAW_LIMIT) - self.offset.into();
        limited(from_offset * self.scale.into(), INPUT_LIMIT)
    }
}

/// The dataset that a model was trained on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DatasetRef {
    /// The dataset's hash; of several datasets, their hashes joined by `+`.
    pub hash: String,
    /// Number of rows, those among them that were set aside or left out for their number.
    pub rows: u64,
    /// Names of the scenes that were trained on.
    pub scenes: Vec<String>,
    /// Hashes of what these scenes show; empty where they were not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contents: Vec<String>,
    /// Names of scenes that were set aside whole, for validation or testing; empty where pixels of all scenes were.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set_aside: Vec<String>,
}

/// Final losses of each subset, where it was not empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Losses {
    /// On the rows that gave gradients.
    pub train: Option<f64>,
    /// On the rows that choices were made by.
    pub validation: Option<f64>,
    /// On the rows that are only reported.
    pub test: Option<f64>,
}

/// Everything about a model but its weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// [`FORMAT_VERSION`] of the writer.
    pub format_version: u32,
    /// Version of the program that trained.
    pub tool_version: String,
    /// How the network is built.
    pub recipe: Recipe,
    /// The inputs, in order.
    pub inputs: Vec<Input>,
    /// What the output means.
    pub output: Output,
    /// Seed of initial weights, order and split.
    pub seed: u64,
    /// What it was trained on; absent in a network that was made by hand.
    pub dataset: Option<DatasetRef>,
    /// Epochs that led to these weights.
    pub epochs: u32,
    /// Final losses.
    pub losses: Losses,
    /// Error on scenes that were not trained on: mean |T̂ − T| over the fragments, by scene.
    pub held_out: BTreeMap<String, f64>,
    /// The training configuration, as the trainer wrote it.
    pub config: serde_json::Value,
}

pub(crate) fn check_version(version: u64) -> Result<(), Problem> {
    if version == u64::from(FORMAT_VERSION) {
        return Ok(());
    }
    Err(Problem(format!(
        "model format {version}, but this program reads format {FORMAT_VERSION}; train again with this version"
    )))
}

impl Metadata {
    /// Checks what the types cannot say.
    pub(crate) fn check(&self) -> Result<(), Problem> {
        check_version(self.format_version.into())?;
        let require = |is_good: bool, field: &str, value: &dyn fmt::Display, allowed| {
            let problem = || {
                let fault = format!("{field} is {value}, it must be {allowed}");
                Problem(format!("metadata: {fault}; train again"))
            };
            if is_good { Ok(()) } else { Err(problem()) }
        };
        let finite = |field: String, value: f64| {
            require(value.is_finite(), &field, &value, "a finite number")
        };
        for input in &self.inputs {
            let field = |name: &str| format!("{name} of input {:?}", input.name);
            for (name, value) in [
                ("offset", input.offset),
                ("scale", input.scale),
                ("min", input.min),
                ("max", input.max),
            ] {
                finite(field(name), value.into())?;
            }
            let (scale, min) = (input.scale, input.min);
            for (name, value) in [("offset", input.offset), ("scale", scale)] {
                let is_small = value.abs() <= LARGEST;
                require(is_small, &field(name), &value, "from -1e12 to 1e12")?;
            }
            require(scale != 0.0, &field("scale"), &scale, "other than 0")?;
            require(min <= input.max, &field("min"), &min, "at most max")?;
        }
        for (name, loss) in [
            ("train", self.losses.train),
            ("validation", self.losses.validation),
            ("test", self.losses.test),
        ] {
            finite(format!("the {name} loss"), loss.unwrap_or(0.0))?;
        }
        for (scene, &error) in &self.held_out {
            finite(format!("the held-out error of {scene:?}"), error)?;
        }
        let (recipe, output) = (self.recipe, self.output);
        let found: Vec<_> = self.inputs.iter().map(|i| i.name.as_str()).collect();
        let expected = recipe.input_names();
        if found != expected {
            let [expected, found] = [expected, found].map(|names| names.join(", "));
            return Err(Problem(format!(
                "made for other features: recipe {recipe} takes ({expected}), the model lists ({found}); train again with this version"
            )));
        }
        if output != recipe.output {
            let problem = format!("recipe {recipe} does not predict {output}");
            return Err(Problem(problem));
        }
        Ok(())
    }
}
