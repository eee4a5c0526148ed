//! Every hyper-parameter of a run.

use peelnet_core::{files::counted, mlp::Activation};
use peelnet_dataset::SplitBy;
use peelnet_model::{MAX_HIDDEN_LAYERS, PixelLoss, Recipe};
use serde::{Deserialize, Serialize};
use std::ops::Range;

use crate::error::TrainError;
use crate::network::Shape;
use crate::report::End;

/// Everything that decides the weights, except the data. Saved in the model file and beside the checkpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// What is trained: inputs, output form and loss.
    pub recipe: Recipe,
    /// Decides initial weights, split and order of rows.
    pub seed: u64,
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// After each hidden layer.
    pub hidden_activation: Activation,
    /// After the last layer.
    pub output_activation: Activation,
    /// Passes over the training rows.
    pub epochs: u32,
    /// Examples (fragments, or pixels where a recipe trains on whole pixels) per step of the optimiser.
    pub batch: usize,
    /// Examples evaluated at once: a batch is cut into chunks of this size, whatever the number of threads. The size
    /// decides the order in which gradients are added, and so the last bits of the weights.
    pub chunk: usize,
    /// Adam's step size; the peak where a schedule changes it.
    pub learning_rate: f64,
    /// How the step size changes over a run.
    pub schedule: Schedule,
    /// Adam's decay of the first moment.
    pub beta1: f64,
    /// Adam's decay of the second moment.
    pub beta2: f64,
    /// Added to the root of the second moment.
    pub epsilon: f64,
    /// Share of the examples held out for testing, in `[0, 1)`.
    pub held_out: f64,
    /// Share of the examples that choices are made by, in `[0, 1)`: neither trained on nor tested with.
    #[serde(default)]
    pub validation: f64,
    /// What stays together when examples are set aside for these two. Rows in memory, which have no scenes, are always split by
    /// pixel.
    #[serde(default, skip_serializing_if = "is_default")]
    pub split: SplitBy,
    /// Stop after this many epochs without a lower held-out error, and keep the best epoch's weights.
    pub patience: Option<u32>,
    /// Rows of the datasets that are used at most: of more, whole pixels are drawn, see [`TrainingData::used`].
    ///
    /// [`TrainingData::used`]: crate::TrainingData::used
    #[serde(
        default = "default_max_rows",
        skip_serializing_if = "is_default_max_rows"
    )]
    pub max_rows: u64,
    /// Rows in memory at once where the examples are streamed, beside those that are made into tensors; none where
    /// all are in memory. A training that streams uses all rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub buffer_rows: Option<u64>,
    /// What recipes that learn from whole pixels minimise, where it is not what they declare.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<PixelLoss>,
}

/// The learning rate over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Schedule {
    /// Always [`Config::learning_rate`].
    Constant,
    /// Half a cosine up from 1/25 of the rate over the first `warmup` of all steps, half a cosine down to 1e-5 of that
    /// start (Smith and Topin, "Super-Convergence", 2018, in the usual cosine form).
    OneCycle {
        /// Share of the steps that rise, in `(0, 1)`.
        warmup: f64,
    },
}

impl Schedule {
    /// The rate of step `step` (from 0) of `steps`.
    pub(crate) fn rate(self, peak: f64, step: u64, steps: u64) -> f64 {
        let Self::OneCycle { warmup } = self else {
            return peak;
        };
        let start = peak / 25.0;
        let end = start * 1e-5;
        let at = step as f64 / (steps.max(2) - 1) as f64;
        let (from, to, x) = if at < warmup {
            (start, peak, at / warmup)
        } else {
            (peak, end, (at - warmup) / (1.0 - warmup))
        };
        to + (from - to) * 0.5 * (1.0 + (std::f64::consts::PI * x.min(1.0)).cos())
    }
}

/// Rows that take about 4 GiB while the largest recipe trains.
pub const DEFAULT_MAX_ROWS: u64 = 1 << 25;

/// Rows of the buffer of a streamed training: large enough to mix hundreds of blocks, at about 200 MiB with the largest recipe.
pub const DEFAULT_BUFFER_ROWS: u64 = 1 << 20;

const fn default_max_rows() -> u64 {
    DEFAULT_MAX_ROWS
}

/// Left out of saved configurations, as the choice of loss.
const fn is_default_max_rows(rows: &u64) -> bool {
    *rows == DEFAULT_MAX_ROWS
}

/// Left out of saved configurations: those of versions without the setting read the same.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Passes of one run: the loss of each is kept.
pub(crate) const MAX_EPOCHS: u32 = 1_000_000;
/// Examples of a step.
const MAX_BATCH: u64 = 1 << 24;
/// Numbers of the gradients of all chunks of a batch.
const MAX_GRADIENTS: u64 = 1 << 28;
/// Indices of rows have 31 bits.
const MAX_ROWS: u64 = i32::MAX as u64;
/// Weights of a network: a model file of 16 MiB, and four times that while it is trained.
const MAX_PARAMETERS: u64 = 1 << 22;

/// A step of Adam is as long as the learning rate; shorter ones than this vanish in weights of 32 bits.
/// Below, 32-bit weights hardly change; above, a step leaves every range of weights that can be learned.
const LEARNING_RATES: Range<f64> = 1e-8..10.0;
const LEARNING: &str =
    "give a number from 1e-8, below which 32-bit weights hardly change, to below 10";
const POSITIVE: &str = "give a positive number";
const BELOW_1: &str = "give a number from 0 to below 1";
const BETWEEN: &str = "give a share between 0 and 1";

impl Config {
    /// Why training ends after so many epochs, of which this one was the best; `None` where it goes on.
    pub(crate) fn end_after(&self, epochs: u32, best: Option<u32>) -> Option<End> {
        let since_best = best.map(|best| epochs.saturating_sub(best));
        match (self.patience, since_best) {
            (Some(patience), Some(n)) if n >= patience => Some(End::StoppedEarly),
            _ => (epochs >= self.epochs).then_some(End::Finished),
        }
    }

    /// The settings that a recipe declares, and the defaults of Adam.
    pub fn for_recipe(recipe: Recipe) -> Self {
        let (network, budget) = (recipe.network, recipe.budget);
        Self {
            recipe,
            seed: 1,
            hidden: network.hidden.to_vec(),
            hidden_activation: network.hidden_activation,
            output_activation: network.output_activation,
            epochs: budget.epochs,
            batch: budget.batch,
            chunk: budget.chunk,
            learning_rate: budget.learning_rate,
            schedule: match budget.warmup {
                Some(warmup) => Schedule::OneCycle { warmup },
                None => Schedule::Constant,
            },
            beta1: 0.9,
            beta2: 0.999,
            epsilon: 1e-8,
            held_out: budget.held_out,
            validation: budget.validation,
            split: SplitBy::Scene,
            patience: None,
            max_rows: DEFAULT_MAX_ROWS,
            buffer_rows: None,
            loss: None,
        }
    }

    /// The same, with another loss than the recipe's.
    #[must_use]
    pub fn minimising(self, loss: Option<PixelLoss>) -> Self {
        let loss = loss.filter(|_| loss != self.recipe.loss);
        Self { loss, ..self }
    }

    /// # Errors
    /// [`TrainError::Config`] names the first setting out of its range.
    pub fn check(&self) -> Result<(), TrainError> {
        let bad = |setting: &'static str, value: String, hint: &'static str| {
            Err(TrainError::Config {
                setting,
                value,
                hint,
            })
        };
        let (epochs, batch) = (self.epochs.into(), self.batch as u64);
        let rows = [self.max_rows, self.buffer_rows.unwrap_or(1)];
        let patience = self.patience.unwrap_or(1).into();
        let or_none = "give at least 1, or leave it out";
        for (setting, value, most, hint) in [
            ("epochs", epochs, MAX_EPOCHS.into(), "give 1 to 1,000,000"),
            ("batch", batch, MAX_BATCH, "give 1 to 16,777,216"),
            ("chunk", self.chunk as u64, u64::MAX, "give at least 1"),
            ("max_rows", rows[0], MAX_ROWS, "give 1 to 2147483647"),
            ("buffer_rows", rows[1], MAX_ROWS, "give 1 to 2147483647"),
            ("patience", patience, u64::MAX, or_none),
        ] {
            if !(1..=most).contains(&value) {
                return bad(setting, value.to_string(), hint);
            }
        }
        if self.hidden.len() > MAX_HIDDEN_LAYERS {
            let given = counted(self.hidden.len() as u64, "layer");
            return bad("hidden", given, "give at most 16 hidden layers");
        }
        if let Some(width) = self.hidden.iter().find(|w| !(2..=4096).contains(*w)) {
            return bad("hidden", width.to_string(), "give widths from 2 to 4096");
        }
        let parameters = Shape::new(self).parameters() as u64;
        if parameters > MAX_PARAMETERS {
            let hint = "give widths with at most 4,194,304 weights in all";
            return bad("hidden", format!("{:?}", self.hidden), hint);
        }
        if batch.div_ceil(self.chunk as u64) * parameters > MAX_GRADIENTS {
            let hint = "give less for this network: every chunk of a batch has a gradient, 1 GiB in all at most";
            return bad("batch", batch.to_string(), hint);
        }
        let warmup = match self.schedule {
            Schedule::OneCycle { warmup } => warmup,
            Schedule::Constant => 0.5,
        };
        let positive = f64::from_bits(1)..f64::INFINITY;
        let between = f64::from_bits(1)..1.0;
        for (setting, value, range, hint) in [
            (
                "learning_rate",
                self.learning_rate,
                &LEARNING_RATES,
                LEARNING,
            ),
            ("beta1", self.beta1, &(0.0..1.0), BELOW_1),
            ("beta2", self.beta2, &(0.0..1.0), BELOW_1),
            ("epsilon", self.epsilon, &positive, POSITIVE),
            ("schedule.warmup", warmup, &between, BETWEEN),
        ] {
            if !range.contains(&value) {
                return bad(setting, format!("{value:?}"), hint);
            }
        }
        for (setting, fraction) in [("held_out", self.held_out), ("validation", self.validation)] {
            if !(0.0..1.0).contains(&fraction) || self.held_out + self.validation >= 1.0 {
                let hint = "give a share from 0 to below 1, both together below 1";
                return bad(setting, fraction.to_string(), hint);
            }
        }
        if let Some(loss) = self.loss.filter(|_| self.recipe.loss.is_none()) {
            let hint = "leave it out: this recipe does not learn from whole pixels";
            return bad("loss", loss.to_string(), hint);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cycle_starts_low_peaks_and_ends_near_zero() {
        let cycle = Schedule::OneCycle { warmup: 0.3 };
        // 64-bit rounding of numbers of size 1.
        assert!((cycle.rate(1.0, 0, 1001) - 0.04).abs() < 1e-15);
        assert_eq!(cycle.rate(1.0, 300, 1001), 1.0);
        assert!(cycle.rate(1.0, 1000, 1001) < 1e-6);
        assert_eq!(Schedule::Constant.rate(0.5, 77, 100), 0.5);
    }

    #[test]
    fn settings_out_of_range_and_unknown_ones_are_refused() {
        let good = Config::for_recipe(Recipe::THESIS);
        good.check().unwrap();
        type Spoil = fn(&mut Config);
        let spoiled: [(&str, Spoil); 19] = [
            ("epochs", |c| c.epochs = 0),
            ("1,000,000", |c| c.epochs = u32::MAX),
            ("batch", |c| c.batch = 0),
            ("16,777,216", |c| c.batch = u32::MAX as usize),
            ("1 GiB", |c| {
                c.hidden = vec![1024, 1024];
                c.batch = 1 << 24;
            }),
            ("max_rows", |c| c.max_rows = 0),
            ("2147483647", |c| c.max_rows = u64::MAX),
            ("2 to 4096", |c| c.hidden = vec![1_000_000_000, 8]),
            ("4,194,304", |c| c.hidden = vec![4096; 10]),
            ("at most 16", |c| c.hidden = vec![2; 17]),
            ("buffer_rows", |c| c.buffer_rows = Some(0)),
            ("chunk", |c| c.chunk = 0),
            ("hidden", |c| c.hidden = vec![3, 0]),
            ("learning_rate", |c| c.learning_rate = f64::NAN),
            ("hardly change", |c| c.learning_rate = 1e-30),
            ("beta2", |c| c.beta2 = 1.0),
            ("held_out", |c| c.held_out = 1.0),
            ("patience", |c| c.patience = Some(0)),
            ("loss", |c| c.loss = Some(PixelLoss::Image)),
        ];
        for (name, spoil) in spoiled {
            let mut config = good.clone();
            spoil(&mut config);
            let message = config.check().unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
        let mut json = serde_json::to_value(good).unwrap();
        json["epoch"] = 3.into();
        assert!(serde_json::from_value::<Config>(json).is_err());
    }
}
