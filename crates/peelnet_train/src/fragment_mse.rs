//! Single rows, (weighted) mean squared error: the thesis's way to train, and its successors'.

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
    /// `[outputs, rows]`
    target: Tensor<2>,
    /// `[1, rows]`
    weight: Option<Tensor<2>>,
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
        let pick = |values: &Vec<f32>| -> Vec<f32> {
            rows.iter().map(|&row| values[row as usize]).collect()
        };
        let target: Vec<f32> = data.targets.iter().flat_map(pick).collect();
        let upload = |values: Vec<f32>, columns: usize| {
            Tensor::from_data(TensorData::new(values, [columns, n]), device)
        };
        Self {
            inputs: upload(inputs, normalisation.len()),
            target: upload(target, data.targets.len()),
            weight: data.weights.as_ref().map(|w| upload(pick(w), 1)),
            rows: n,
        }
    }
}

/// Rows as examples, squared error as loss.
pub(crate) struct FragmentMse {
    original: Columns,
    shuffled: Columns,
    validation: Columns,
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
            weight: original.weight.clone(),
            rows: original.rows,
        };
        Self {
            original,
            shuffled,
            validation: Columns::new(data, normalisation, &split.validation, device),
            test: Columns::new(data, normalisation, &split.test, device),
            device: device.clone(),
        }
    }
}

impl Task for FragmentMse {
    fn examples(&self, part: Part) -> usize {
        match part {
            Part::Train => self.original.rows,
            Part::Validation => self.validation.rows,
            Part::Test => self.test.rows,
        }
    }

    fn shuffle(&mut self, order: &[u32]) {
        // Row counts fit in 31 bits: checked with the data.
        let indices: Vec<i32> = order.iter().map(|&i| i as i32).collect();
        let indices =
            Tensor::<1, Int>::from_data(TensorData::new(indices, [order.len()]), &self.device);
        self.shuffled.inputs = self.original.inputs.clone().select(1, indices.clone());
        self.shuffled.weight = (self.original.weight.clone()).map(|w| w.select(1, indices.clone()));
        self.shuffled.target = self.original.target.clone().select(1, indices);
    }

    fn loss_sum(&self, network: &Network, part: Part, range: Range<usize>) -> Tensor<1> {
        let columns = match part {
            Part::Train => &self.shuffled,
            Part::Validation => &self.validation,
            Part::Test => &self.test,
        };
        let inputs = columns.inputs.clone().narrow(1, range.start, range.len());
        let target = columns.target.clone().narrow(1, range.start, range.len());
        let difference = network.forward(inputs) - target;
        let squared = difference.clone() * difference;
        match &columns.weight {
            Some(weight) => (squared * weight.clone().narrow(1, range.start, range.len())).sum(),
            None => squared.sum(),
        }
    }
}
