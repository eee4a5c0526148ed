//! Examples on a device, and what training minimises.
//!
//! Recipes that learn from rows minimise the squared error of the outputs: the thesis's way to train, and `dfaoit`'s.
//!
//! Recipes that learn from whole pixels minimise a [`PixelLoss`]. The network answers with the share `s_i` of every fragment between a
//! pixel's ends. Its unnormalised contribution is `k_i = α_i e^(−b_n − r_i s_i)`, and what of the coverage is left to distribute, `R`, goes
//! to each in proportion: `p̂_i = R k_i / (A + Σ k)`, where `A` is what the ends contribute when they are normalised with the rest (0 with
//! separate ends). The loss of a pixel is the squared error of its colour, `|Σ (p̂_i − α_i T_i) c_i|² / 3` over all of its
//! fragments: what a user of the image sees, surfaces of one object weighing together because they share a colour. Networks that answer
//! with T itself have `k_i = α_i T_i`.

use std::ops::Range;

use burn::tensor::{Device, IndexingUpdateOp, Int, Tensor, TensorData};
use peelnet_core::guards::SUM_FLOOR;
use peelnet_model::{Output, PixelLoss};

use crate::config::Config;
use crate::network::Network;
use crate::normalise::Normalisation;
use crate::table::{ALPHA, COLOR, EXACT, KNOWN, LEFT, RESIDUAL, SUM, TrainingData};

/// Some examples on a device.
pub(crate) struct Window {
    /// Columns of rows, the inputs normalised: `[columns, rows]`.
    rows: Tensor<2>,
    /// Columns of examples, if there are any: `[columns, examples]`.
    fixed: Option<Tensor<2>>,
    /// For whole pixels the pixel of each row, and the first row of each pixel, and the number of rows.
    pixels: Option<(Tensor<1, Int>, Vec<u32>)>,
    inputs: usize,
    outputs: usize,
    pub(crate) examples: usize,
}

impl Window {
    /// Number `i` is example `order[i]` of the data.
    pub(crate) fn new(
        data: &TrainingData,
        order: &[u32],
        normalisation: &[Normalisation],
        device: &Device,
    ) -> Self {
        let mut rows: Vec<u32> = Vec::new();
        let mut first = Vec::with_capacity(order.len() + 1);
        for &example in order {
            first.push(rows.len() as u32);
            rows.extend(data.rows_of(example));
        }
        first.push(rows.len() as u32);
        let upload = |values: Vec<f32>, columns: usize| {
            let shape = [columns, values.len() / columns];
            Tensor::from_data(TensorData::new(values, shape), device)
        };
        let at = |column: &[f32], at: &[u32], to: &mut Vec<f32>| {
            to.extend(at.iter().map(|&i| column[i as usize]));
        };
        let count = data.row_columns().count();
        let mut values = Vec::with_capacity(count * rows.len());
        for (k, column) in data.row_columns().enumerate() {
            match normalisation.get(k) {
                Some(normalisation) => normalisation.append(column, &rows, &mut values),
                None => at(column, &rows, &mut values),
            }
        }
        let row_tensor = upload(values, count);
        let pixels = data.pixels.is_some().then(|| {
            let pixel = first.windows(2).zip(0i32..);
            let pixel = pixel.flat_map(|(f, i)| std::iter::repeat_n(i, (f[1] - f[0]) as usize));
            let pixel: Vec<i32> = pixel.collect();
            (
                Tensor::from_data(TensorData::new(pixel, [rows.len()]), device),
                first,
            )
        });
        drop(rows);
        let mut values = Vec::new();
        data.example_columns()
            .for_each(|column| at(column, order, &mut values));
        let count = data.example_columns().count();
        Self {
            rows: row_tensor,
            fixed: (count > 0).then(|| upload(values, count)),
            pixels,
            inputs: normalisation.len(),
            outputs: data.targets.len(),
            examples: order.len(),
        }
    }

    /// The **sum** (not the mean) of the losses of a range of examples, `[1]`. The training loop divides the sum over a
    /// batch by the number of its examples.
    pub(crate) fn loss_sum(
        &self,
        network: &Network,
        range: Range<usize>,
        config: &Config,
    ) -> Tensor<1> {
        let fixed = self.fixed.as_ref();
        let fixed = fixed.map(|t| t.clone().narrow(1, range.start, range.len()));
        match (&self.pixels, fixed) {
            (Some((pixel, first)), Some(fixed)) => {
                let (from, to) = (first[range.start] as usize, first[range.end] as usize);
                let rows = self.rows.clone().narrow(1, from, to - from);
                let pixel = pixel.clone().narrow(0, from, to - from) - range.start as i32;
                self.pixel_loss(network, rows, fixed, pixel, config)
            }
            (_, weight) => {
                let rows = self.rows.clone().narrow(1, range.start, range.len());
                let target = rows.clone().narrow(0, self.inputs, self.outputs);
                let difference = network.forward(rows.narrow(0, 0, self.inputs)) - target;
                let squared = difference.clone() * difference;
                match weight {
                    Some(weight) => (squared * weight).sum(),
                    None => squared.sum(),
                }
            }
        }
    }

    fn pixel_loss(
        &self,
        network: &Network,
        rows: Tensor<2>,
        fixed: Tensor<2>,
        pixel: Tensor<1, Int>,
        config: &Config,
    ) -> Tensor<1> {
        let loss = config.loss.or(config.recipe.loss).unwrap_or_default();
        let known = self.inputs + 1;
        let row = |k: usize| rows.clone().narrow(0, known + k, 1);
        let exact = || rows.clone().narrow(0, self.inputs, 1);
        let column = |k: usize| fixed.clone().narrow(0, k, 1);
        let answer = network.forward(rows.clone().narrow(0, 0, self.inputs));
        let through = match config.recipe.output {
            Output::Transmittance => answer,
            _ => (row(RESIDUAL) * answer).neg().exp(),
        };
        let contribution = row(ALPHA) * through.clone();
        let squares = |error: Tensor<2>| {
            (column(WEIGHT).select(1, pixel.clone()) * error.clone() * error).sum()
        };
        match loss {
            PixelLoss::Transmittance => {
                let exact = (exact() / row(ALPHA).clamp_min(1e-6)).clamp_max(1.0);
                return squares(through - exact);
            }
            PixelLoss::WeightedTransmittance => return squares(contribution - exact()),
            PixelLoss::Image | PixelLoss::Contributions => {}
        }
        let sums = (column(SUM) + SUM_FLOOR).select_assign(
            1,
            pixel.clone(),
            contribution.clone(),
            IndexingUpdateOp::Add,
        );
        let scale = column(LEFT) / sums;
        let error = contribution * scale.clone().select(1, pixel.clone()) - exact();
        if loss == PixelLoss::Contributions {
            return squares(error);
        }
        // Colour by colour: Σ over all fragments of (p̂ − αT) c.
        let extremes =
            fixed.clone().narrow(0, KNOWN, 3) * scale - fixed.clone().narrow(0, EXACT, 3);
        let image = extremes.select_assign(
            1,
            pixel,
            rows.clone().narrow(0, known + COLOR, 3) * error,
            IndexingUpdateOp::Add,
        );
        (column(WEIGHT) * (image.clone() * image)).sum() * (1.0 / 3.0)
    }
}

/// The weight of a pixel lies behind `PixelColumns::fixed`.
const WEIGHT: usize = EXACT + 3;
