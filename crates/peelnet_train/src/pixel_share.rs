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
use crate::task::Task;
use crate::training_data::{PixelColumns, TrainingData};
use peelnet_model::PixelLoss;

/// Columns of a pixel: [`PixelFixed`], then its weight.
const FIXED: usize = 9;

/// What the numbers of pixels are made from.
#[derive(Clone, Copy)]
struct Source<'a> {
    data: &'a TrainingData,
    pixels: &'a PixelColumns,
    normalisation: &'a [Normalisation],
}

/// Some pixels on the device.
struct Tensors {
    /// `[inputs, absorbance of the rest, α, exact contribution, colour][rows]`
    rows: Tensor<2>,
    /// `[FIXED, pixels]`
    fixed: Tensor<2>,
    /// The pixel of each row, `[rows]`.
    pixel: Tensor<1, Int>,
    /// First row of each pixel, and the number of rows.
    first: Vec<u32>,
}

impl Tensors {
    /// These pixels of the source, in this order.
    fn new(source: Source<'_>, order: &[u32], device: &Device) -> Self {
        let Source {
            data,
            pixels,
            normalisation,
        } = source;
        let of = |p: u32| pixels.rows(p as usize, data.rows());
        let n: usize = order.iter().map(|&p| of(p).len()).sum();
        let mut first = Vec::with_capacity(order.len() + 1);
        let mut pixel = Vec::with_capacity(n);
        let mut rows = Vec::with_capacity(n);
        for (i, &p) in order.iter().enumerate() {
            first.push(rows.len() as u32);
            rows.extend(of(p));
            pixel.resize(rows.len(), i as i32);
        }
        first.push(rows.len() as u32);
        let [red, green, blue] = &pixels.color;
        let known = [
            &pixels.rest,
            &pixels.alpha,
            &data.targets[0],
            red,
            green,
            blue,
        ];
        let count = normalisation.len() + known.len();
        let mut columns = Vec::with_capacity(count * n);
        for (normalisation, values) in normalisation.iter().zip(&data.inputs) {
            normalisation.append(values, &rows, &mut columns);
        }
        for values in known {
            columns.extend(rows.iter().map(|&row| values[row as usize]));
        }
        drop(rows);
        Self {
            rows: Tensor::from_data(TensorData::new(columns, [count, n]), device),
            fixed: Self::fixed(source, order, device),
            pixel: Tensor::from_data(TensorData::new(pixel, [n]), device),
            first,
        }
    }

    /// [`PixelFixed`](crate::PixelFixed) and the weight of each pixel.
    fn fixed(source: Source<'_>, order: &[u32], device: &Device) -> Tensor<2> {
        let n = order.len();
        let weights = source.data.weights.as_deref();
        let mut fixed = vec![0.0; FIXED * n];
        for (i, &p) in order.iter().enumerate() {
            let f = &source.pixels.fixed[p as usize];
            let [r, g, b] = f.color;
            let [er, eg, eb] = f.exact;
            let weight = weights.map_or(1.0, |w| w[p as usize]);
            let values = [f.left, f.sum, r, g, b, er, eg, eb, weight];
            for (column, value) in values.into_iter().enumerate() {
                fixed[column * n + i] = value;
            }
        }
        Tensor::from_data(TensorData::new(fixed, [FIXED, n]), device)
    }
}

/// Pixels as examples.
pub(crate) struct PixelShare<'a> {
    normalisation: &'a [Normalisation],
    tensors: Option<Tensors>,
    loss: PixelLoss,
    device: Device,
}

impl<'a> PixelShare<'a> {
    pub(crate) fn new(
        normalisation: &'a [Normalisation],
        loss: PixelLoss,
        device: &Device,
    ) -> Self {
        Self {
            normalisation,
            tensors: None,
            loss,
            device: device.clone(),
        }
    }
}

impl Task for PixelShare<'_> {
    fn load(&mut self, data: &TrainingData, order: &[u32]) {
        self.tensors = data.pixels.as_ref().map(|pixels| {
            let source = Source {
                data,
                pixels,
                normalisation: self.normalisation,
            };
            Tensors::new(source, order, &self.device)
        });
    }

    fn loss_sum(&self, network: &Network, range: Range<usize>) -> Tensor<1> {
        let t = self
            .tensors
            .as_ref()
            .expect("pixels are loaded before their loss is asked for");
        let inputs = self.normalisation.len();
        let (from, to) = (t.first[range.start] as usize, t.first[range.end] as usize);
        let rows = t.rows.clone().narrow(1, from, to - from);
        let row = |k: usize| rows.clone().narrow(0, inputs + k, 1);
        let fixed = t.fixed.clone().narrow(1, range.start, range.len());
        let column = |k: usize| fixed.clone().narrow(0, k, 1);
        let pixel = t.pixel.clone().narrow(0, from, to - from) - range.start as i32;

        let share = network.forward(rows.clone().narrow(0, 0, inputs));
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
                rows.narrow(0, inputs + 3, 3) * error.clone(),
                IndexingUpdateOp::Add,
            );
        (column(8) * (image.clone() * image)).sum() * (1.0 / 3.0)
    }
}
