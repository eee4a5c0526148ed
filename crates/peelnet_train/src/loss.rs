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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Stream;
    use crate::network::Shape;
    use crate::table::PixelColumns;
    use peelnet_core::{mlp::Activation, tolerance::UNIT_ROUNDOFF};
    use peelnet_model::Recipe;

    const EXAMPLES: usize = 6;
    const ROWS_OF_A_PIXEL: usize = 5;

    /// Random examples with the columns of a recipe: any numbers of the size of real ones have a gradient.
    fn examples(recipe: Recipe) -> TrainingData {
        let mut random = Stream::Split.random(7);
        let mut column = |rows: usize, least: f32, most: f32| -> Vec<f32> {
            (0..rows).map(|_| random.between(least, most)).collect()
        };
        let is_pixels = recipe.loss.is_some();
        let rows = EXAMPLES * if is_pixels { ROWS_OF_A_PIXEL } else { 1 };
        let mut data = TrainingData::for_recipe(recipe);
        data.inputs.fill_with(|| column(rows, -1.0, 1.0));
        data.targets.fill_with(|| column(rows, 0.0, 0.5));
        let weights = data.weights.iter_mut();
        weights.for_each(|all| *all = column(EXAMPLES, 0.5, 2.0));
        data.pixels = is_pixels.then(|| PixelColumns {
            first: (0..rows as u32).step_by(ROWS_OF_A_PIXEL).collect(),
            rows: std::array::from_fn(|k| match k {
                RESIDUAL => column(rows, 0.1, 3.0),
                ALPHA => column(rows, 0.1, 1.0),
                _ => column(rows, 0.0, 2.0),
            }),
            fixed: std::array::from_fn(|_| column(EXAMPLES, 0.1, 1.0)),
        });
        data
    }

    /// The network in 64 bits, from the order of parameters that the model file has.
    fn forward(shape: &Shape, parameters: &[f64], input: Vec<f64>) -> Vec<f64> {
        let last = shape.widths.len() - 2;
        let mut rest = parameters;
        let mut x = input;
        for (k, w) in shape.widths.windows(2).enumerate() {
            let (weights, after) = rest.split_at(w[0] * w[1]);
            let (bias, after) = after.split_at(w[1]);
            rest = after;
            let sum = |(row, b): (&[f64], &f64)| {
                let products = row.iter().zip(&x).map(|(w, x)| w * x);
                products.sum::<f64>() + b
            };
            let sums = weights.chunks_exact(w[0]).zip(bias).map(sum);
            let activation = if k == last {
                shape.output
            } else {
                shape.hidden
            };
            x = sums
                .map(|y| match activation {
                    Activation::Relu => y.max(0.0),
                    Activation::Sigmoid => 1.0 / (1.0 + (-y).exp()),
                    Activation::Identity => y,
                })
                .collect();
        }
        x
    }

    /// The loss of an example in 64 bits, written from the text at the head of this file.
    fn loss(
        config: &Config,
        shape: &Shape,
        data: &TrainingData,
        parameters: &[f64],
        example: usize,
    ) -> f64 {
        let value = |column: &Vec<f32>, at: usize| f64::from(column[at]);
        let answer = |row: usize| {
            let input = data.inputs.iter().map(|c| value(c, row)).collect();
            forward(shape, parameters, input)
        };
        let weight = data.weights.as_ref().map_or(1.0, |w| value(w, example));
        let Some(pixels) = &data.pixels else {
            let errors = answer(example).into_iter().zip(&data.targets);
            let squares = errors.map(|(y, target)| (y - value(target, example)).powi(2));
            return weight * squares.sum::<f64>();
        };
        let rows = data.rows_of(example as u32);
        let rows = rows.map(|r| r as usize).collect::<Vec<_>>();
        let fixed = |k: usize| value(&pixels.fixed[k], example);
        let through = |row: usize| match config.recipe.output {
            Output::Transmittance => answer(row)[0],
            _ => (-value(&pixels.rows[RESIDUAL], row) * answer(row)[0]).exp(),
        };
        let exact = |row: usize| value(&data.targets[0], row);
        let alpha = |row: usize| value(&pixels.rows[ALPHA], row);
        let k: Vec<f64> = rows.iter().map(|&r| alpha(r) * through(r)).collect();
        let scale = fixed(LEFT) / (fixed(SUM) + f64::from(SUM_FLOOR) + k.iter().sum::<f64>());
        let both = || rows.iter().zip(&k);
        weight
            * match config.loss.unwrap() {
                PixelLoss::Transmittance => rows
                    .iter()
                    .map(|&r| (through(r) - (exact(r) / alpha(r)).min(1.0)).powi(2))
                    .sum(),
                PixelLoss::WeightedTransmittance => {
                    both().map(|(&r, k)| (k - exact(r)).powi(2)).sum::<f64>()
                }
                PixelLoss::Contributions => {
                    let squares = both().map(|(&r, k)| (k * scale - exact(r)).powi(2));
                    squares.sum()
                }
                PixelLoss::Image => {
                    let channel = |c: usize| {
                        let color = |r: usize| value(&pixels.rows[COLOR + c], r);
                        let seen = both().map(|(&r, k)| (k * scale - exact(r)) * color(r));
                        let ends = fixed(KNOWN + c) * scale - fixed(EXACT + c);
                        (seen.sum::<f64>() + ends).powi(2)
                    };
                    (0..3).map(channel).sum::<f64>() / 3.0
                }
            }
    }

    /// Central differences of the loss in 64 bits, of every recipe and every loss. Their steps are too short for a ReLU to switch within
    /// one here; the roundings of both losses, each 2⁻⁵² of it for every step of a chain of sixteen or so, are magnified by them.
    ///
    /// An example's gradient is a chain of products and sums of which each rounds once, forwards and backwards, through three layers of at
    /// most 32 terms, five rows and thirty operations of the loss: 256 unit roundoffs of it at most.
    #[test]
    fn gradients_of_every_recipes_losses_are_difference_quotients() {
        const STEP: f64 = 1e-6;
        let device = Device::flex();
        for recipe in Recipe::ALL {
            let losses: &[Option<PixelLoss>] = match recipe.loss {
                None => &[None],
                Some(_) => &[
                    Some(PixelLoss::Image),
                    Some(PixelLoss::Contributions),
                    Some(PixelLoss::WeightedTransmittance),
                    Some(PixelLoss::Transmittance),
                ],
            };
            for &pixel_loss in losses {
                let config = Config {
                    loss: pixel_loss,
                    ..Config::for_recipe(recipe)
                };
                let at = format!("{recipe}, {pixel_loss:?}");
                let data = examples(recipe);
                let shape = Shape::new(&config);
                let parameters = shape.initial(3);
                let count = parameters.len();
                let flat = TensorData::new(parameters.clone(), [count]);
                let network = Network::tracked(&shape, &Tensor::from_data(flat, &device));
                let same = Normalisation {
                    offset: 0.0,
                    scale: 1.0,
                    min: -1.0,
                    max: 1.0,
                    constant: false,
                };
                let normalisation = vec![same; data.inputs.len()];
                let order: Vec<u32> = (0..EXAMPLES as u32).collect();
                let window = Window::new(&data, &order, &normalisation, &device);
                let sum = window.loss_sum(&network, 0..EXAMPLES, &config);
                let found: Vec<f32> = network.gradient(sum).into_data().try_into_vec().unwrap();
                let parameters: Vec<f64> = parameters.into_iter().map(f64::from).collect();
                let all = |parameters: &[f64]| -> Vec<f64> {
                    let each = 0..EXAMPLES;
                    each.map(|e| loss(&config, &shape, &data, parameters, e))
                        .collect()
                };
                let noise = 16.0 * f64::EPSILON / STEP;
                let limit = 256.0 * UNIT_ROUNDOFF;
                let total: f64 = all(&parameters).iter().sum();
                let error = (f64::from(found[count]) / total - 1.0).abs();
                assert!(error <= limit, "{at}: {} for {total}", found[count]);
                for i in 0..count {
                    let moved = |by: f64| {
                        let mut moved = parameters.clone();
                        moved[i] += by;
                        all(&moved)
                    };
                    let pairs = moved(STEP).into_iter().zip(moved(-STEP));
                    let terms: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
                    let expected: f64 = terms.iter().sum();
                    let scale: f64 = terms.iter().map(|t| t.abs()).sum();
                    let error = (f64::from(found[i]) - expected).abs();
                    let allowed = limit * scale + noise * total;
                    assert!(
                        error <= allowed,
                        "{at}: parameter {i}, {} for {expected}",
                        found[i]
                    );
                }
            }
        }
    }
}
