//! Single rows, (weighted) mean squared error: the thesis's way to train, and its successors'.

use std::ops::Range;

use burn::tensor::{Device, Tensor, TensorData};

use crate::network::Network;
use crate::normalise::Normalisation;
use crate::task::Task;
use crate::training_data::TrainingData;

/// Normalised inputs and targets.
struct Columns {
    /// `[features, rows]`
    inputs: Tensor<2>,
    /// `[outputs, rows]`
    target: Tensor<2>,
    /// `[1, rows]`
    weight: Option<Tensor<2>>,
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
        }
    }
}

/// Rows as examples, squared error as loss.
pub(crate) struct FragmentMse<'a> {
    normalisation: &'a [Normalisation],
    columns: Option<Columns>,
    device: Device,
}

impl<'a> FragmentMse<'a> {
    pub(crate) fn new(normalisation: &'a [Normalisation], device: &Device) -> Self {
        Self {
            normalisation,
            columns: None,
            device: device.clone(),
        }
    }
}

impl Task for FragmentMse<'_> {
    fn load(&mut self, data: &TrainingData, order: &[u32]) {
        self.columns = Some(Columns::new(data, self.normalisation, order, &self.device));
    }

    fn loss_sum(&self, network: &Network, range: Range<usize>) -> Tensor<1> {
        let columns = self
            .columns
            .as_ref()
            .expect("examples are loaded before their loss is asked for");
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
