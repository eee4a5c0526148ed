//! Whole pixels, squared error of the composited colour: how the anchored networks train.
//!
//! The network answers with the share `s_i` of every fragment between a pixel's ends. Its unnormalised contribution is
//! `k_i = α_i e^(−b_n − r_i s_i)`, and what of the coverage is left to distribute, `R`, goes to each in proportion:
//! `p̂_i = R k_i / (A + Σ k)`, where `A` is what the ends contribute when they are normalised with the rest (0 with
//! separate ends). The loss of a pixel is the squared error of its colour, `|Σ (p̂_i − α_i T_i) c_i|² / 3` over all of its
//! fragments: what a user of the image sees, surfaces of one object weighing together because they share a colour. [`PixelLoss`]
//! names the others.

use std::ops::Range;

use burn::tensor::{Device, IndexingUpdateOp, Int, Tensor, TensorData};
use peelnet_core::guards::SUM_FLOOR;

use crate::network::Network;
use crate::normalise::Normalisation;
use crate::task::{Part, Task};
use crate::training_data::{PixelColumns, TrainingData};
use peelnet_model::PixelLoss;

/// Columns of a pixel: [`PixelFixed`], then its weight.
const FIXED: usize = 9;

/// Some pixels, on the device and as the numbers that they are made from.
struct Pixels {
    /// First row of each pixel, and the number of rows.
    first: Vec<u32>,
    /// `[inputs, absorbance of the rest, α, exact contribution, colour][rows]`
    columns: Vec<Vec<f32>>,
    /// `[FIXED][pixels]`
    fixed: Vec<Vec<f32>>,
    tensors: Tensors,
}

struct Tensors {
    /// `[columns, rows]`
    rows: Tensor<2>,
    /// `[FIXED, pixels]`
    fixed: Tensor<2>,
    /// The pixel of each row, `[rows]`.
    pixel: Tensor<1, Int>,
    first: Vec<u32>,
}

fn upload(columns: &[Vec<f32>], device: &Device) -> Tensor<2> {
    let n = columns.first().map_or(0, Vec::len);
    Tensor::from_data(
        TensorData::new(columns.concat(), [columns.len(), n]),
        device,
    )
}

impl Pixels {
    fn new(
        data: &TrainingData,
        pixels: &PixelColumns,
        normalisation: &[Normalisation],
        examples: &[u32],
        device: &Device,
    ) -> Self {
        let rows: Vec<u32> = examples
            .iter()
            .flat_map(|&p| pixels.rows(p as usize, data.rows()))
            .collect();
        let at =
            |values: &[f32]| -> Vec<f32> { rows.iter().map(|&r| values[r as usize]).collect() };
        let weights = data.weights.as_deref();
        let weight = |p: u32| weights.map_or(1.0, |w| w[p as usize]);
        let mut columns: Vec<Vec<f32>> = normalisation
            .iter()
            .zip(&data.inputs)
            .map(|(n, values)| n.apply(values, &rows))
            .collect();
        columns.push(at(&pixels.rest));
        columns.push(at(&pixels.alpha));
        columns.push(at(&data.targets[0]));
        columns.extend(pixels.color.iter().map(|c| at(c)));
        let mut first = Vec::with_capacity(examples.len() + 1);
        let mut row = 0;
        for &p in examples {
            first.push(row);
            row += pixels.rows(p as usize, data.rows()).len() as u32;
        }
        first.push(row);
        let mut fixed = vec![Vec::new(); FIXED];
        for &p in examples {
            let f = &pixels.fixed[p as usize];
            let [r, g, b] = f.color;
            let [er, eg, eb] = f.exact;
            let values = [f.left, f.sum, r, g, b, er, eg, eb, weight(p)];
            for (column, value) in fixed.iter_mut().zip(values) {
                column.push(value);
            }
        }
        let order: Vec<u32> = (0..examples.len() as u32).collect();
        let tensors = Tensors::new(&first, &columns, &fixed, &order, device);
        Self {
            first,
            columns,
            fixed,
            tensors,
        }
    }
}

impl Tensors {
    /// The pixels in the given order.
    fn new(
        first: &[u32],
        columns: &[Vec<f32>],
        fixed: &[Vec<f32>],
        order: &[u32],
        device: &Device,
    ) -> Self {
        let rows = columns.first().map_or(0, Vec::len);
        let mut starts = Vec::with_capacity(order.len() + 1);
        let mut pixel = Vec::with_capacity(rows);
        let mut from = Vec::with_capacity(rows);
        for (i, &p) in order.iter().enumerate() {
            starts.push(from.len() as u32);
            let range = first[p as usize]..first[p as usize + 1];
            pixel.resize(pixel.len() + range.len(), i as i32);
            from.extend(range);
        }
        starts.push(from.len() as u32);
        let pick = |values: &Vec<f32>, at: &[u32]| -> Vec<f32> {
            at.iter().map(|&i| values[i as usize]).collect()
        };
        let columns: Vec<Vec<f32>> = columns.iter().map(|c| pick(c, &from)).collect();
        let fixed: Vec<Vec<f32>> = fixed.iter().map(|c| pick(c, order)).collect();
        Self {
            rows: upload(&columns, device),
            fixed: upload(&fixed, device),
            pixel: Tensor::from_data(TensorData::new(pixel, [rows]), device),
            first: starts,
        }
    }
}

/// Pixels as examples.
pub(crate) struct PixelShare {
    train: Pixels,
    validation: Pixels,
    test: Pixels,
    inputs: usize,
    loss: PixelLoss,
    device: Device,
}

impl PixelShare {
    /// `parts`: the examples of each part.
    pub(crate) fn new(
        data: &TrainingData,
        pixels: &PixelColumns,
        normalisation: &[Normalisation],
        parts: [&[u32]; 3],
        loss: PixelLoss,
        device: &Device,
    ) -> Self {
        let [train, validation, test] =
            parts.map(|part| Pixels::new(data, pixels, normalisation, part, device));
        Self {
            train,
            validation,
            test,
            inputs: normalisation.len(),
            loss,
            device: device.clone(),
        }
    }

    fn part(&self, part: Part) -> &Pixels {
        match part {
            Part::Train => &self.train,
            Part::Validation => &self.validation,
            Part::Test => &self.test,
        }
    }
}

impl Task for PixelShare {
    fn examples(&self, part: Part) -> usize {
        self.part(part).first.len() - 1
    }

    fn shuffle(&mut self, order: &[u32]) {
        let Pixels {
            first,
            columns,
            fixed,
            ..
        } = &self.train;
        self.train.tensors = Tensors::new(first, columns, fixed, order, &self.device);
    }

    fn loss_sum(&self, network: &Network, part: Part, range: Range<usize>) -> Tensor<1> {
        let t = &self.part(part).tensors;
        let (from, to) = (t.first[range.start] as usize, t.first[range.end] as usize);
        let rows = t.rows.clone().narrow(1, from, to - from);
        let row = |k: usize| rows.clone().narrow(0, self.inputs + k, 1);
        let fixed = t.fixed.clone().narrow(1, range.start, range.len());
        let column = |k: usize| fixed.clone().narrow(0, k, 1);
        let pixel = t.pixel.clone().narrow(0, from, to - from) - range.start as i32;

        let share = network.forward(rows.clone().narrow(0, 0, self.inputs));
        let through = (row(0) * share).neg().exp();
        let contribution = row(1) * through.clone();
        let squares =
            |error: Tensor<2>| (column(8).select(1, pixel.clone()) * error.clone() * error).sum();
        match self.loss {
            PixelLoss::Transmittance => {
                let exact = (row(2) / row(1).clamp_min(1e-6)).clamp_max(1.0);
                return squares(through - exact);
            }
            PixelLoss::WeightedTransmittance => return squares(contribution - row(2)),
            PixelLoss::Image | PixelLoss::Contributions => {}
        }
        let sums = (column(1) + SUM_FLOOR).select_assign(
            1,
            pixel.clone(),
            contribution.clone(),
            IndexingUpdateOp::Add,
        );
        let scale = column(0) / sums;
        let error = contribution * scale.clone().select(1, pixel.clone()) - row(2);
        if self.loss == PixelLoss::Contributions {
            return squares(error);
        }
        // Colour by colour: Σ over all fragments of (p̂ − αT) c.
        let image = (fixed.clone().narrow(0, 2, 3) * scale - fixed.clone().narrow(0, 5, 3))
            .select_assign(
                1,
                pixel,
                rows.narrow(0, self.inputs + 3, 3) * error.clone(),
                IndexingUpdateOp::Add,
            );
        (column(8) * (image.clone() * image)).sum() * (1.0 / 3.0)
    }
}
