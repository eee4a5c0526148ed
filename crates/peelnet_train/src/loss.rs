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
use rayon::prelude::*;

use crate::config::Config;
use crate::network::{Columns, Network, Tile};
use crate::normalise::Normalisation;
use crate::table::{ALPHA, COLOR, EXACT, KNOWN, LEFT, RESIDUAL, SUM, TrainingData};

/// Some examples, in the order in which they are learned.
pub(crate) struct Window {
    /// Of rows, normalised.
    inputs: Columns,
    of: Examples,
    pub(crate) examples: usize,
}

enum Examples {
    Rows {
        targets: Columns,
        /// None, or one column.
        weights: Option<Columns>,
    },
    Pixels(Box<Pixels>),
}

/// What the loss of whole pixels is made of, as burn's tensors: burn differentiates it by the network's answers.
struct Pixels {
    /// Exact contribution of each row, then what [`PixelColumns`](crate::PixelColumns) have for it: `[columns, rows]`.
    rows: Tensor<2>,
    /// `[columns, pixels]`
    fixed: Tensor<2>,
    /// The pixel of each row.
    pixel: Tensor<1, Int>,
    /// The first row of each pixel, and the number of rows.
    first: Vec<u32>,
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
        let inputs = columns(data.inputs.iter(), &rows, |k, v| normalisation[k].apply(v));
        let same = |_, value| value;
        let targets = columns(data.row_columns().skip(data.inputs.len()), &rows, same);
        let fixed = columns(data.example_columns(), order, same);
        let of = match data.pixels {
            Some(_) => {
                let tensor = |columns: Columns| {
                    let shape = [columns.values.len() / columns.rows.max(1), columns.rows];
                    Tensor::from_data(TensorData::new(columns.values, shape), device)
                };
                let pixel = first.windows(2).zip(0i32..);
                let pixel = pixel.flat_map(|(f, i)| std::iter::repeat_n(i, (f[1] - f[0]) as usize));
                let pixel: Vec<i32> = pixel.collect();
                Examples::Pixels(Box::new(Pixels {
                    rows: tensor(targets),
                    fixed: tensor(fixed),
                    pixel: Tensor::from_data(TensorData::new(pixel, [rows.len()]), device),
                    first,
                }))
            }
            None => Examples::Rows {
                targets,
                weights: (!fixed.values.is_empty()).then_some(fixed),
            },
        };
        Self {
            inputs,
            of,
            examples: order.len(),
        }
    }

    /// The **sum** (not the mean) of the losses of a range of examples.
    pub(crate) fn loss(&self, network: &Network<'_>, range: Range<usize>, config: &Config) -> f64 {
        match &self.of {
            Examples::Rows { targets, weights } => {
                let mut loss = 0.0;
                network.forward(&self.inputs, range, |rows, answers| {
                    loss += squared_errors(&mut answers.to_vec(), targets, weights.as_ref(), &rows);
                });
                loss
            }
            Examples::Pixels(pixels) => {
                let answers = self.answers(network, pixels.rows_of(&range), pixels);
                sum(pixels.loss(answers, range, config))
            }
        }
    }

    /// The gradient of that sum by all parameters of the network, and the sum. The training loop divides both by the number of a batch's
    /// examples.
    pub(crate) fn gradient(
        &self,
        network: &Network<'_>,
        range: Range<usize>,
        config: &Config,
    ) -> (Vec<f32>, f64) {
        match &self.of {
            Examples::Rows { targets, weights } => {
                let mut loss = 0.0;
                let gradient = network.gradient(&self.inputs, range, |rows, answers| {
                    loss += squared_errors(answers, targets, weights.as_ref(), &rows);
                });
                (gradient, loss)
            }
            Examples::Pixels(pixels) => {
                let rows = pixels.rows_of(&range);
                let answers = self.answers(network, rows.clone(), pixels);
                let answers = answers.autodiff().require_grad();
                let loss = pixels.loss(answers.clone(), range, config);
                let slopes = answers.grad_remove(&mut loss.backward());
                // A loss that depends on no answer leaves none.
                let slopes = slopes.map_or_else(|| vec![0.0; rows.len()], numbers);
                let gradient = network.gradient(&self.inputs, rows.clone(), |tile, answers| {
                    let slopes = &slopes[tile.start - rows.start..tile.end - rows.start];
                    answers[0].as_flattened_mut()[..slopes.len()].copy_from_slice(slopes);
                });
                (gradient, sum(loss.inner()))
            }
        }
    }

    /// The network's answers for some rows of pixels: `[1, rows]`.
    fn answers(&self, network: &Network<'_>, rows: Range<usize>, of: &Pixels) -> Tensor<2> {
        let count = rows.len();
        let mut answers = Vec::with_capacity(count);
        network.forward(&self.inputs, rows, |rows, tiles| {
            answers.extend_from_slice(&tiles[0].as_flattened()[..rows.len()]);
        });
        Tensor::from_data(TensorData::new(answers, [1, count]), &of.rows.device())
    }
}

/// Columns of data at some places, each value as `of` makes it with the number of its column.
fn columns<'a>(
    columns: impl Iterator<Item = &'a Vec<f32>>,
    at: &[u32],
    of: impl Fn(usize, f32) -> f32 + Sync,
) -> Columns {
    let columns: Vec<_> = columns.collect();
    let mut values = vec![0.0; columns.len() * at.len()];
    let parts = values.par_chunks_mut(at.len().max(1)).zip(columns);
    parts.enumerate().for_each(|(k, (to, from))| {
        let values = at.iter().map(|&i| of(k, from[i as usize]));
        to.iter_mut()
            .zip(values)
            .for_each(|(to, value)| *to = value);
    });
    Columns {
        values,
        rows: at.len(),
    }
}

/// Replaces answers by the gradient of their weighted squared errors, and returns the sum of these.
fn squared_errors(
    answers: &mut [Tile],
    targets: &Columns,
    weights: Option<&Columns>,
    rows: &Range<usize>,
) -> f64 {
    let weights = weights.map(|column| column.part(0, rows));
    let mut loss = 0.0;
    for (k, answers) in answers.iter_mut().enumerate() {
        let answers = answers.as_flattened_mut().iter_mut();
        for (i, (answer, target)) in answers.zip(targets.part(k, rows)).enumerate() {
            let error = *answer - target;
            let weight = weights.map_or(1.0, |weights| weights[i]);
            loss += f64::from(weight * error * error);
            *answer = 2.0 * weight * error;
        }
    }
    loss
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    let numbers = tensor.into_data().try_into_vec();
    numbers.expect("losses and their gradients are 32-bit floats")
}

fn sum(loss: Tensor<1>) -> f64 {
    numbers(loss).into_iter().map(f64::from).sum()
}

impl Pixels {
    fn rows_of(&self, range: &Range<usize>) -> Range<usize> {
        self.first[range.start] as usize..self.first[range.end] as usize
    }

    /// The sum of the losses of a range of pixels, `[1]`, from the network's answers for their rows.
    fn loss(&self, answer: Tensor<2>, range: Range<usize>, config: &Config) -> Tensor<1> {
        let Range { start, end } = self.rows_of(&range);
        let rows = self.rows.clone().narrow(1, start, end - start);
        let fixed = self.fixed.clone().narrow(1, range.start, range.len());
        let pixel = self.pixel.clone().narrow(0, start, end - start) - range.start as i32;
        let loss = config.loss.or(config.recipe.loss).unwrap_or_default();
        let row = |k: usize| rows.clone().narrow(0, 1 + k, 1);
        let exact = || rows.clone().narrow(0, 0, 1);
        let column = |k: usize| fixed.clone().narrow(0, k, 1);
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
            rows.clone().narrow(0, 1 + COLOR, 3) * error,
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

    /// A loss, and examples and parameters to differentiate it at.
    struct Case {
        at: String,
        config: Config,
        data: TrainingData,
        shape: Shape,
        parameters: Vec<f32>,
    }

    /// Every recipe with every loss that it can minimise.
    fn cases() -> impl Iterator<Item = Case> {
        let losses = |recipe: Recipe| -> &[Option<PixelLoss>] {
            match recipe.loss {
                None => &[None],
                Some(_) => &[
                    Some(PixelLoss::Image),
                    Some(PixelLoss::Contributions),
                    Some(PixelLoss::WeightedTransmittance),
                    Some(PixelLoss::Transmittance),
                ],
            }
        };
        let all = Recipe::ALL
            .into_iter()
            .flat_map(move |r| losses(r).iter().map(move |l| (r, *l)));
        all.map(|(recipe, loss)| {
            let config = Config {
                loss,
                ..Config::for_recipe(recipe)
            };
            let shape = Shape::new(&config);
            Case {
                at: format!("{recipe}, {loss:?}"),
                data: examples(recipe),
                parameters: shape.initial(3),
                shape,
                config,
            }
        })
    }

    impl Case {
        /// Holds the gradient against those of each example, `[examples][parameters]`, which have an error of `noise`.
        ///
        /// An example's gradient is a chain of products and sums of which each rounds once, forwards and backwards, through three layers of
        /// at most 32 terms, five rows and thirty operations of the loss: 256 unit roundoffs of it at most.
        fn check(&self, expected: &[Vec<f64>], loss: f64, noise: f64) {
            let Self { at, config, .. } = self;
            let device = Device::flex();
            let same = Normalisation {
                offset: 0.0,
                scale: 1.0,
                min: -1.0,
                max: 1.0,
                constant: false,
            };
            let normalisation = vec![same; self.data.inputs.len()];
            let order: Vec<u32> = (0..EXAMPLES as u32).collect();
            let window = Window::new(&self.data, &order, &normalisation, &device);
            let network = Network {
                shape: &self.shape,
                parameters: &self.parameters,
            };
            let limit = 256.0 * UNIT_ROUNDOFF;
            let (found, sum) = window.gradient(&network, 0..EXAMPLES, config);
            for sum in [sum, window.loss(&network, 0..EXAMPLES, config)] {
                let error = (sum / loss - 1.0).abs();
                assert!(error <= limit, "{at}: {sum} for {loss}");
            }
            for (i, found) in found.into_iter().enumerate() {
                let terms = || expected.iter().map(|of_example| of_example[i]);
                let expected: f64 = terms().sum();
                let error = (f64::from(found) - expected).abs();
                let allowed = limit * terms().map(f64::abs).sum::<f64>() + noise;
                assert!(
                    error <= allowed,
                    "{at}: parameter {i}, {found} for {expected}"
                );
            }
        }
    }

    /// Central differences of the loss in 64 bits. Their steps are too short for a ReLU to switch within one here; the roundings of both
    /// losses, each 2⁻⁵² of it for every step of a chain of sixteen or so, are magnified by them.
    #[test]
    fn gradients_of_every_recipes_losses_are_difference_quotients() {
        const STEP: f64 = 1e-6;
        for case in cases() {
            let parameters: Vec<f64> = case.parameters.iter().copied().map(f64::from).collect();
            let of =
                |parameters: &[f64], e| loss(&case.config, &case.shape, &case.data, parameters, e);
            let quotient = |example, i: usize| {
                let moved = |by: f64| {
                    let mut moved = parameters.clone();
                    moved[i] += by;
                    of(&moved, example)
                };
                (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
            };
            let gradient = |e| (0..parameters.len()).map(|i| quotient(e, i)).collect();
            let gradients: Vec<_> = (0..EXAMPLES).map(gradient).collect();
            let loss: f64 = (0..EXAMPLES).map(|e| of(&parameters, e)).sum();
            case.check(&gradients, loss, 16.0 * f64::EPSILON / STEP * loss);
        }
    }

    /// PyTorch's differentiation in 64 bits of the losses as `benches/peers/pytorch_gradients.py` writes them, by the Python that
    /// `PEELNET_PYTORCH` names: `cargo xtask peers` installs one and runs this.
    ///
    /// Where the terms of a component cancel, they are of the size of the example's largest component, and a chain of sixteen or so rounds.
    #[test]
    #[ignore = "needs PyTorch, which cargo xtask peers installs"]
    fn gradients_are_pytorchs() {
        use std::process::{Command, Stdio};
        let python = std::env::var_os("PEELNET_PYTORCH").expect("PEELNET_PYTORCH names a Python");
        let script = "../../benches/peers/pytorch_gradients.py";
        let asked = cases().map(|case| {
            let pixels = case.data.pixels.as_ref();
            serde_json::json!({
                "widths": case.shape.widths,
                "hidden": case.shape.hidden,
                "output": case.shape.output,
                "parameters": case.parameters,
                "inputs": case.data.inputs,
                "targets": case.data.targets,
                "weights": case.data.weights,
                "answers_transmittance": case.config.recipe.output == Output::Transmittance,
                "loss": case.config.loss,
                "floor": SUM_FLOOR,
                "rows_of_a_pixel": ROWS_OF_A_PIXEL,
                "rows": pixels.map(|p| &p.rows),
                "fixed": pixels.map(|p| &p.fixed),
            })
        });
        let asked: Vec<_> = asked.collect();
        let mut child = Command::new(python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        serde_json::to_writer(child.stdin.take().unwrap(), &asked).unwrap();
        let answer = child.wait_with_output().unwrap();
        assert!(answer.status.success());
        /// The loss and the gradient of each example.
        type Answer = Vec<(f64, Vec<f64>)>;
        let answers: Vec<Answer> = serde_json::from_slice(&answer.stdout).unwrap();
        assert_eq!(answers.len(), asked.len());
        for (case, examples) in cases().zip(answers) {
            let (losses, gradients): (Vec<_>, Vec<_>) = examples.into_iter().unzip();
            assert_eq!(gradients.len(), EXAMPLES);
            let largest = |g: &Vec<f64>| g.iter().fold(0.0f64, |most, g| most.max(g.abs()));
            let size: f64 = gradients.iter().map(largest).sum();
            case.check(&gradients, losses.iter().sum(), 16.0 * UNIT_ROUNDOFF * size);
        }
    }
}
