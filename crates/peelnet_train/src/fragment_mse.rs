//! Single fragments, mean squared error: the thesis's way to train.

use std::ops::Range;

use burn::tensor::{Device, Int, Tensor, TensorData};

use crate::network::Network;
use crate::normalise::Normalisation;
use crate::split::Split;
use crate::task::{Part, Task};
use crate::training_data::TrainingData;

/// Normalised inputs and targets of one part.
struct Columns {
    /// `[features, rows]`
    inputs: Tensor<2>,
    /// `[1, rows]`
    target: Tensor<2>,
    rows: usize,
}

impl Columns {
    fn new(
        data: &TrainingData,
        normalisation: &[Normalisation],
        rows: &[u32],
        device: &Device,
    ) -> Self {
        let n = rows.len();
        let inputs: Vec<f32> = normalisation
            .iter()
            .zip(&data.inputs)
            .flat_map(|(normalisation, values)| normalisation.apply(values, rows))
            .collect();
        let target: Vec<f32> = rows.iter().map(|&row| data.target[row as usize]).collect();
        Self {
            inputs: Tensor::from_data(TensorData::new(inputs, [normalisation.len(), n]), device),
            target: Tensor::from_data(TensorData::new(target, [1, n]), device),
            rows: n,
        }
    }
}

/// Rows as examples, squared error as loss.
pub(crate) struct FragmentMse {
    original: Columns,
    shuffled: Columns,
    test: Columns,
    device: Device,
}

impl FragmentMse {
    pub(crate) fn new(
        data: &TrainingData,
        normalisation: &[Normalisation],
        split: &Split,
        device: &Device,
    ) -> Self {
        let original = Columns::new(data, normalisation, &split.train, device);
        let shuffled = Columns {
            inputs: original.inputs.clone(),
            target: original.target.clone(),
            rows: original.rows,
        };
        Self {
            original,
            shuffled,
            test: Columns::new(data, normalisation, &split.test, device),
            device: device.clone(),
        }
    }
}

impl Task for FragmentMse {
    fn examples(&self, part: Part) -> usize {
        match part {
            Part::Train => self.original.rows,
            Part::Test => self.test.rows,
        }
    }

    fn shuffle(&mut self, order: &[u32]) {
        // Row counts fit in 31 bits: checked with the data.
        let indices: Vec<i32> = order.iter().map(|&i| i as i32).collect();
        let indices =
            Tensor::<1, Int>::from_data(TensorData::new(indices, [order.len()]), &self.device);
        self.shuffled.inputs = self.original.inputs.clone().select(1, indices.clone());
        self.shuffled.target = self.original.target.clone().select(1, indices);
    }

    fn loss_sum(&self, network: &Network, part: Part, range: Range<usize>) -> Tensor<1> {
        let columns = match part {
            Part::Train => &self.shuffled,
            Part::Test => &self.test,
        };
        let inputs = columns.inputs.clone().narrow(1, range.start, range.len());
        let target = columns.target.clone().narrow(1, range.start, range.len());
        let difference = network.forward(inputs) - target;
        (difference.clone() * difference).sum()
    }
}
