//! The columns that training reads.

use peelnet_model::DatasetRef;

use crate::error::TrainError;
use crate::recipe::Feature;

/// Rows in memory, by column. All columns are as long as `target`.
#[derive(Clone, Debug)]
pub struct TrainingData {
    /// Where the rows are from, for messages: a path.
    pub source: String,
    /// One column per input, in the recipe's order and in raw units (scene units, counts).
    pub inputs: Vec<Vec<f32>>,
    /// What the network should answer.
    pub target: Vec<f32>,
    /// Which rows are held out, as long as `target`. Without it, [`Config::held_out`](crate::Config::held_out) of the
    /// rows are drawn from the seed.
    pub held_out: Option<Vec<bool>>,
    /// Recorded in the model file.
    pub dataset: Option<DatasetRef>,
}

impl TrainingData {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.target.len()
    }

    /// # Errors
    /// A missing column, columns of different lengths, no rows at all, more rows than 32-bit indices can name, or a
    /// value that is not finite.
    pub(crate) fn check(&self, features: &[Feature]) -> Result<(), TrainError> {
        let columns = |problem: String| {
            Err(TrainError::Columns {
                data: self.source.clone(),
                problem,
            })
        };
        if self.inputs.len() != features.len() {
            return columns(format!(
                "{} input columns, but the recipe takes {}: {}",
                self.inputs.len(),
                features.len(),
                features
                    .iter()
                    .map(|f| f.name)
                    .collect::<Vec<_>>()
                    .join(", ")
            ));
        }
        if self.rows() == 0 {
            return columns("no rows to train on: extract views with transparent objects in them, of scenes that are not held out".into());
        }
        if self.rows() > i32::MAX as usize {
            return columns(format!(
                "{} rows are more than the {} that one training run can hold; extract with a smaller --pixels fraction",
                self.rows(),
                i32::MAX
            ));
        }
        for (feature, values) in features.iter().zip(&self.inputs) {
            if values.len() != self.rows() {
                return columns(format!(
                    "column `{}` has {} rows, but the target has {}",
                    feature.name,
                    values.len(),
                    self.rows()
                ));
            }
        }
        if let Some(held_out) = &self.held_out {
            if held_out.len() != self.rows() {
                return columns(format!(
                    "the split has {} rows, but the target has {}",
                    held_out.len(),
                    self.rows()
                ));
            }
            if held_out.iter().all(|&row| row) {
                return columns(
                    "every row is held out, none is left to train on; hold out a smaller share"
                        .into(),
                );
            }
        }
        let named = features.iter().map(|f| f.name).chain(["target"]);
        for (name, values) in named.zip(self.inputs.iter().chain([&self.target])) {
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                return Err(TrainError::Value {
                    data: self.source.clone(),
                    row,
                    column: name.to_owned(),
                    value: values[row],
                });
            }
        }
        Ok(())
    }

    /// Tells whether a checkpoint was made with the same rows: a 64-bit hash over the bits of every value.
    pub(crate) fn fingerprint(&self) -> String {
        let mut hash = 0xCBF2_9CE4_8422_2325_u64;
        for column in self.inputs.iter().chain([&self.target]) {
            for word in column
                .iter()
                .map(|v| u64::from(v.to_bits()))
                .chain([column.len() as u64])
            {
                hash = (hash ^ word)
                    .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                    .rotate_left(29);
            }
        }
        for &row in self.held_out.iter().flatten() {
            hash = (hash ^ u64::from(row))
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .rotate_left(29);
        }
        format!("{hash:016x}")
    }
}
