//! Single rows, (weighted) mean squared error: the thesis's way to train, and its successors'.

use std::ops::Range;

use burn::tensor::{Device, Tensor, TensorData};

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
        let mut inputs = Vec::with_capacity(n * normalisation.len());
        for (normalisation, values) in normalisation.iter().zip(&data.inputs) {
            normalisation.append(values, rows, &mut inputs);
        }
        let mut target = Vec::with_capacity(n * data.targets.len());
        let at = |values: &[f32], to: &mut Vec<f32>| {
            to.extend(rows.iter().map(|&row| values[row as usize]));
        };
        data.targets.iter().for_each(|t| at(t, &mut target));
        let weight = data.weights.as_ref().map(|w| {
            let mut picked = Vec::with_capacity(n);
            at(w, &mut picked);
            picked
        });
        let upload = |values: Vec<f32>, columns: usize| {
            Tensor::from_data(TensorData::new(values, [columns, n]), device)
        };
        Self {
            inputs: upload(inputs, normalisation.len()),
            target: upload(target, data.targets.len()),
            weight: weight.map(|w| upload(w, 1)),
            rows: n,
        }
    }
}

/// Rows as examples, squared error as loss. The training rows are on the device in the order of the epoch only.
pub(crate) struct FragmentMse<'a> {
    data: &'a TrainingData,
    normalisation: &'a [Normalisation],
    train: &'a [u32],
    shuffled: Columns,
    validation: Columns,
    test: Columns,
    device: Device,
}

impl<'a> FragmentMse<'a> {
    pub(crate) fn new(
        data: &'a TrainingData,
        normalisation: &'a [Normalisation],
        split: &'a Split,
        device: &Device,
    ) -> Self {
        Self {
            data,
            normalisation,
            train: &split.train,
            shuffled: Columns::new(data, normalisation, &[], device),
            validation: Columns::new(data, normalisation, &split.validation, device),
            test: Columns::new(data, normalisation, &split.test, device),
            device: device.clone(),
        }
    }
}

impl Task for FragmentMse<'_> {
    fn examples(&self, part: Part) -> usize {
        match part {
            Part::Train => self.train.len(),
            Part::Validation => self.validation.rows,
            Part::Test => self.test.rows,
        }
    }

    fn shuffle(&mut self, order: &[u32]) {
        let columns =
            |rows: &[u32]| Columns::new(self.data, self.normalisation, rows, &self.device);
        // The old order's tensors go before the new one's come.
        self.shuffled = columns(&[]);
        let rows: Vec<u32> = order.iter().map(|&i| self.train[i as usize]).collect();
        self.shuffled = columns(&rows);
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
