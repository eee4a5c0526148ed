//! The network: a shape, one row of parameters, and its two passes.
//!
//! Ours instead of burn's tensors: at the thesis's batch of 128 rows the forty or so operations of a step cost six times their arithmetic.

use std::ops::Range;

use peelnet_core::mlp::{Activation, Layer, Mlp};
use pulp::{Arch, Simd, WithSimd};

use crate::config::Config;
use crate::draws::Stream;

/// Widths and activations.
///
/// The parameters of all layers lie in one row: for each layer its weights, row-major `[outputs][inputs]`, then its
/// biases. That is the order of the model file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Inputs, hidden layers, outputs.
    pub(crate) widths: Vec<usize>,
    pub(crate) hidden: Activation,
    pub(crate) output: Activation,
}

impl Shape {
    pub(crate) fn new(config: &Config) -> Self {
        let recipe = config.recipe;
        let inputs = recipe.inputs.features().len();
        let hidden = config.hidden.iter().copied();
        Self {
            widths: std::iter::once(inputs)
                .chain(hidden)
                .chain([recipe.output.count()])
                .collect(),
            hidden: config.hidden_activation,
            output: config.output_activation,
        }
    }

    pub(crate) fn parameters(&self) -> usize {
        let layers = self.layers();
        layers.map(|(inputs, outputs)| (inputs + 1) * outputs).sum()
    }

    /// What follows a layer.
    fn activation(&self, layer: usize) -> Activation {
        let is_last = layer + 2 == self.widths.len();
        if is_last { self.output } else { self.hidden }
    }

    fn layers(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.widths.windows(2).map(|w| (w[0], w[1]))
    }

    /// Initial parameters: uniform in ±1/√inputs, weights and biases, as PyTorch's `nn.Linear` starts.
    pub(crate) fn initial(&self, seed: u64) -> Vec<f32> {
        let mut random = Stream::Weights.random(seed);
        self.layers()
            .flat_map(|(inputs, outputs)| {
                let bound = 1.0 / (inputs as f32).sqrt();
                std::iter::repeat_n(bound, (inputs + 1) * outputs)
            })
            .map(|bound| bound * random.between(-1.0, 1.0))
            .collect()
    }

    /// The network of the mathematics crate with these parameters.
    pub(crate) fn to_mlp(&self, parameters: &[f32]) -> Mlp {
        let mut rest = parameters;
        let layers = self
            .layers()
            .map(|(inputs, outputs)| {
                let (weights, after) = rest.split_at(inputs * outputs);
                let (bias, after) = after.split_at(outputs);
                rest = after;
                Layer {
                    inputs,
                    outputs,
                    weights: weights.to_vec(),
                    bias: bias.to_vec(),
                }
            })
            .collect();
        Mlp::new(layers, self.hidden, self.output).expect("layers of a shape fit one another")
    }
}

/// Columns of numbers, one after the other, all equally long.
#[derive(Debug)]
pub(crate) struct Columns {
    pub(crate) values: Vec<f32>,
    pub(crate) rows: usize,
}

impl Columns {
    /// Some rows of a column.
    pub(crate) fn part(&self, column: usize, rows: &Range<usize>) -> &[f32] {
        let first = column * self.rows;
        &self.values[first + rows.start..first + rows.end]
    }
}

/// Rows that pass through the network together: the values of all layers fit the fastest cache.
pub(crate) const TILE: usize = 64;

/// Sums that are formed side by side, which makes them vector instructions. They are the same numbers on every processor.
const LANES: usize = 16;

/// One number for each row of a tile.
pub(crate) type Tile = [[f32; LANES]; TILE / LANES];

const ONE: Tile = [[1.0; LANES]; TILE / LANES];
const ZERO: Tile = [[0.0; LANES]; TILE / LANES];

/// A network with these parameters (`[Shape::parameters]`).
pub(crate) struct Network<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) parameters: &'a [f32],
}

impl Network<'_> {
    /// Calls `each` for every tile of the normalised inputs, with the tile's rows and the network's outputs for them, a column for each.
    pub(crate) fn forward(
        &self,
        inputs: &Columns,
        rows: Range<usize>,
        mut each: impl FnMut(Range<usize>, &[Tile]),
    ) {
        self.tiles(inputs, rows, |rows, values| {
            each(rows, values.last().expect("a network has layers"));
        });
    }

    /// The gradient of a loss by all parameters: `[Shape::parameters]`. `slope` is called as in [`Network::forward`], and replaces each
    /// answer by the loss's gradient by it; what it does to missing rows does not matter.
    pub(crate) fn gradient(
        &self,
        inputs: &Columns,
        rows: Range<usize>,
        mut slope: impl FnMut(Range<usize>, &mut [Tile]),
    ) -> Vec<f32> {
        let mut gradient = vec![0.0; self.parameters.len()];
        let widest = self.shape.widths.iter().max().copied().unwrap_or(0);
        let (mut slopes, mut before) = (Vec::with_capacity(widest), Vec::with_capacity(widest));
        let mut sums = vec![[0.0; LANES]; widest];
        self.tiles(inputs, rows, |rows, values| {
            let last = values.len() - 1;
            slopes.clone_from(&values[last]);
            slope(rows.clone(), &mut slopes);
            // What a tile has behind the last row is of rows before.
            for slope in &mut slopes {
                slope.as_flattened_mut()[rows.len()..].fill(0.0);
            }
            let mut end = gradient.len();
            for (k, layer) in values.windows(2).enumerate().rev() {
                let [inputs, outputs] = layer else { continue };
                let activation = self.shape.activation(k);
                let start = end - (inputs.len() + 1) * outputs.len();
                // Nobody asks for the slopes of the inputs.
                before.resize(if k > 0 { inputs.len() } else { 0 }, ZERO);
                Arch::new().dispatch(Backward {
                    weights: &self.parameters[start..],
                    inputs,
                    outputs,
                    activation,
                    slopes: &mut slopes,
                    gradient: &mut gradient[start..end],
                    before: &mut before,
                    sums: &mut sums,
                });
                std::mem::swap(&mut slopes, &mut before);
                end = start;
            }
        });
        gradient
    }

    /// Calls `each` with the values of every layer, the inputs first, tile by tile.
    fn tiles(
        &self,
        inputs: &Columns,
        rows: Range<usize>,
        mut each: impl FnMut(Range<usize>, &[Vec<Tile>]),
    ) {
        let widths = self.shape.widths.iter();
        let mut values: Vec<Vec<Tile>> = widths.map(|&width| vec![ZERO; width]).collect();
        for start in rows.clone().step_by(TILE) {
            let rows = start..rows.end.min(start + TILE);
            for (k, tile) in values[0].iter_mut().enumerate() {
                tile.as_flattened_mut()[..rows.len()].copy_from_slice(inputs.part(k, &rows));
            }
            let mut rest = self.parameters;
            for k in 0..values.len() - 1 {
                let (before, after) = values.split_at_mut(k + 1);
                let (inputs, outputs) = (&before[k], &mut after[0]);
                let activation = self.shape.activation(k);
                Arch::new().dispatch(Forward {
                    parameters: rest,
                    inputs,
                    activation,
                    outputs,
                });
                rest = &rest[(inputs.len() + 1) * outputs.len()..];
            }
            each(rows, &values);
        }
    }
}

// The two passes through a layer run with the widest registers that a processor has. No product is fused with a sum: the results are the same
// on all of them. They are no closures, which do not become part of the function that has these registers.

/// A layer from its parameters and inputs.
struct Forward<'a> {
    parameters: &'a [f32],
    inputs: &'a [Tile],
    activation: Activation,
    outputs: &'a mut [Tile],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let count = self.inputs.len();
        let (weights, biases) = self.parameters.split_at(count * self.outputs.len());
        let neurons = weights.chunks_exact(count).zip(biases);
        for (output, (row, &bias)) in self.outputs.iter_mut().zip(neurons) {
            weighted_sum(bias, row.iter().zip(self.inputs), output);
            let all = output.as_flattened_mut().iter_mut();
            match self.activation {
                Activation::Relu => all.for_each(|y| *y = y.max(0.0)),
                Activation::Identity => {}
                Activation::Sigmoid => all.for_each(|y| *y = Activation::Sigmoid.apply(*y)),
            }
        }
    }
}

/// The gradient by a layer's parameters, and the slopes of its inputs.
struct Backward<'a> {
    weights: &'a [f32],
    inputs: &'a [Tile],
    outputs: &'a [Tile],
    activation: Activation,
    /// The loss's derivative by the outputs, which becomes that by what the activation was applied to.
    slopes: &'a mut [Tile],
    /// Of the weights, then of the biases: added to.
    gradient: &'a mut [f32],
    /// The derivative by the first so many inputs.
    before: &'a mut [Tile],
    /// Room for as many as there are inputs.
    sums: &'a mut [[f32; LANES]],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let slopes = self.slopes.as_flattened_mut().as_flattened_mut();
        let outputs = self.outputs.as_flattened().as_flattened();
        for (slope, &y) in slopes.iter_mut().zip(outputs) {
            *slope *= match self.activation {
                Activation::Relu => f32::from(u8::from(y > 0.0)),
                Activation::Sigmoid => y * (1.0 - y),
                Activation::Identity => 1.0,
            };
        }
        let count = self.inputs.len();
        let (weights, biases) = self.gradient.split_at_mut(count * self.slopes.len());
        let neurons = weights.chunks_exact_mut(count).zip(biases);
        for ((row, bias), slope) in neurons.zip(&*self.slopes) {
            // First all lanes, then their sums: together, they would be computed lane by lane.
            for (sums, input) in self.sums.iter_mut().zip(self.inputs) {
                *sums = products(slope, input);
            }
            for (weight, sums) in row.iter_mut().zip(&*self.sums) {
                *weight += total(sums);
            }
            *bias += total(&products(slope, &ONE));
        }
        for (i, before) in self.before.iter_mut().enumerate() {
            let column = self.weights[i..].iter().step_by(count);
            weighted_sum(0.0, column.zip(&*self.slopes), before);
        }
    }
}

/// `start + Σ weight · tile`
#[inline(always)]
fn weighted_sum<'a>(
    start: f32,
    terms: impl Iterator<Item = (&'a f32, &'a Tile)> + Clone,
    to: &mut Tile,
) {
    for (block, to) in to.iter_mut().enumerate() {
        let mut sum = [start; LANES];
        for (weight, tile) in terms.clone() {
            for (sum, value) in sum.iter_mut().zip(&tile[block]) {
                *sum += weight * value;
            }
        }
        *to = sum;
    }
}

/// The products of two columns, added lane by lane.
#[inline(always)]
fn products(a: &Tile, b: &Tile) -> [f32; LANES] {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    lanes
}

/// The sum of all lanes, in pairs: each sum waits for four additions and not for all.
#[inline(always)]
fn total(lanes: &[f32; LANES]) -> f32 {
    let mut lanes = *lanes;
    let mut width = LANES;
    while width > 1 {
        width /= 2;
        for k in 0..width {
            lanes[k] += lanes[k + width];
        }
    }
    lanes[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::tolerance::UNIT_ROUNDOFF;

    fn thesis() -> Shape {
        Shape {
            widths: vec![3, 10, 8, 1],
            hidden: Activation::Relu,
            output: Activation::Identity,
        }
    }

    fn random_inputs(rows: usize, seed: u64) -> Columns {
        let mut random = Stream::Split.random(seed);
        let values = (0..3 * rows).map(|_| random.between(-3.0, 3.0));
        Columns {
            values: values.collect(),
            rows,
        }
    }

    /// Both forward passes round every product and sum once, in different orders. A sum of k terms errs by at most
    /// about k unit roundoffs of the sum of the terms' magnitudes; through 3 + 10 + 8 terms that is below 25·2⁻²⁴ ≈
    /// 1.5e-6 of that sum in the worst case and, as errors cancel, a fraction of it in practice. The scale is the
    /// larger of the answer and 1, the size of the sums of magnitudes.
    #[test]
    fn training_and_the_mathematics_crate_agree_to_a_millionth() {
        for (seed, hidden, output) in [
            (1, Activation::Relu, Activation::Identity),
            (2, Activation::Sigmoid, Activation::Sigmoid),
            (3, Activation::Relu, Activation::Relu),
        ] {
            let mut shape = thesis();
            (shape.hidden, shape.output) = (hidden, output);
            let parameters = shape.initial(seed);
            let mlp = shape.to_mlp(&parameters);
            let inputs = random_inputs(4100, seed);
            let network = Network {
                shape: &shape,
                parameters: &parameters,
            };
            let mut seen = 0;
            network.forward(&inputs, 3..4100, |rows, answers| {
                for (row, found) in rows.zip(answers[0].as_flattened()) {
                    let input = [0, 1, 2].map(|k| inputs.part(k, &(row..row + 1))[0]);
                    let expected = mlp.forward(&input)[0];
                    let error = (found - expected).abs() / expected.abs().max(1.0);
                    assert!(error <= 1e-6, "{input:?}: {found} against {expected}");
                    seen += 1;
                }
            });
            assert_eq!(seen, 4097);
        }
    }

    /// Central differences of the 64-bit forward pass. With a step of 1e-4 and values of size 1 their own error is
    /// about 1e-8, except where a ReLU switches within the step: smooth activations avoid that.
    #[test]
    fn the_gradient_is_the_difference_quotient() {
        let mut shape = thesis();
        (shape.hidden, shape.output) = (Activation::Sigmoid, Activation::Sigmoid);
        let parameters = shape.initial(4);
        let rows = 5;
        let inputs = random_inputs(rows, 9);
        let gradient = of_squares(&shape, &parameters, &inputs, 0..rows);
        let loss_f64 = |index: usize, step: f64| -> f64 {
            let mut parameters = parameters.clone();
            parameters[index] = (f64::from(parameters[index]) + step) as f32;
            let mlp = shape.to_mlp(&parameters);
            let answers = (0..rows).map(|row| {
                let input = [0, 1, 2].map(|k| f64::from(inputs.part(k, &(row..row + 1))[0]));
                mlp.forward(&input)[0].powi(2)
            });
            answers.sum()
        };
        for (index, &found) in gradient.iter().enumerate() {
            // The step is taken in 32 bits, which moves a parameter of size ½ by 2⁻⁸ ± 2⁻²⁵.
            let step = 1.0 / 256.0;
            let expected = (loss_f64(index, step) - loss_f64(index, -step)) / (2.0 * step);
            let error = (f64::from(found) - expected).abs();
            assert!(error < 1e-3, "{index}: {found} against {expected}");
        }
    }

    /// The gradient of the sum of the squared answers.
    fn of_squares(
        shape: &Shape,
        parameters: &[f32],
        inputs: &Columns,
        rows: Range<usize>,
    ) -> Vec<f32> {
        let network = Network { shape, parameters };
        network.gradient(inputs, rows, |_, answers| {
            let all = answers.iter_mut().flat_map(|tile| tile.as_flattened_mut());
            all.for_each(|y| *y *= 2.0);
        })
    }

    /// Each of the sums over 147 rows rounds once a row, and each of their terms is the same.
    #[test]
    fn rows_of_whole_and_of_partial_tiles_add_up() {
        let shape = thesis();
        let parameters = shape.initial(5);
        let inputs = random_inputs(150, 10);
        let all = of_squares(&shape, &parameters, &inputs, 3..150);
        let rows = (3..150).map(|row| of_squares(&shape, &parameters, &inputs, row..row + 1));
        let rows: Vec<_> = rows.collect();
        for (index, &found) in all.iter().enumerate() {
            let terms = || rows.iter().map(|row| f64::from(row[index]));
            let error = (f64::from(found) - terms().sum::<f64>()).abs();
            let limit = 147.0 * UNIT_ROUNDOFF * terms().map(f64::abs).sum::<f64>();
            assert!(error <= limit, "{index}: {error} > {limit}");
        }
    }
}
