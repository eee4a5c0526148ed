//! The network: a shape, and views into one flat tensor of parameters.

use burn::tensor::activation::{relu, sigmoid};
use burn::tensor::{Gradients, Tensor};
use peelnet_core::mlp::{Activation, Layer, Mlp};

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

pub(crate) struct Network {
    weights: Vec<Tensor<2>>,
    biases: Vec<Tensor<2>>,
    hidden: Activation,
    output: Activation,
}

impl Network {
    /// Views of `parameters` (`[Shape::parameters]`) for evaluation.
    pub(crate) fn new(shape: &Shape, parameters: &Tensor<1>) -> Self {
        Self::build(shape, parameters, |tensor| tensor)
    }

    /// Views that record what is done with them, for [`Network::gradient`].
    ///
    /// Every call makes leaves of its own: graphs on different threads then share no node and no lock.
    pub(crate) fn tracked(shape: &Shape, parameters: &Tensor<1>) -> Self {
        Self::build(shape, parameters, |tensor| tensor.autodiff().require_grad())
    }

    fn build(shape: &Shape, parameters: &Tensor<1>, leaf: impl Fn(Tensor<2>) -> Tensor<2>) -> Self {
        let mut at = 0;
        let mut take = |rows: usize, columns: usize| {
            let view = parameters.clone().narrow(0, at, rows * columns);
            at += rows * columns;
            leaf(view.reshape([rows, columns]))
        };
        let (weights, biases) = shape
            .layers()
            .map(|(inputs, outputs)| (take(outputs, inputs), take(outputs, 1)))
            .unzip();
        Self {
            weights,
            biases,
            hidden: shape.hidden,
            output: shape.output,
        }
    }

    /// Evaluates normalised inputs `[inputs, rows]` to `[outputs, rows]`.
    pub(crate) fn forward(&self, inputs: Tensor<2>) -> Tensor<2> {
        let last = self.weights.len() - 1;
        let mut x = inputs;
        for (i, (weights, bias)) in self.weights.iter().zip(&self.biases).enumerate() {
            x = weights.clone().matmul(x) + bias.clone();
            let activation = if i == last { self.output } else { self.hidden };
            x = match activation {
                Activation::Relu => relu(x),
                Activation::Sigmoid => sigmoid(x),
                Activation::Identity => x,
            };
        }
        x
    }

    /// The gradient of `loss` by all parameters, followed by the loss itself: `[Shape::parameters + 1]`.
    ///
    /// One tensor, so that adding up chunks is one operation for gradient and loss.
    pub(crate) fn gradient(&self, loss: Tensor<1>) -> Tensor<1> {
        let mut gradients = loss.backward();
        let mut parts = Vec::with_capacity(2 * self.weights.len() + 1);
        for (weights, bias) in self.weights.iter().zip(&self.biases) {
            parts.push(Self::part(&mut gradients, weights));
            parts.push(Self::part(&mut gradients, bias));
        }
        parts.push(loss.inner());
        Tensor::cat(parts, 0)
    }

    /// A loss that does not depend on a parameter leaves no gradient behind: zero.
    fn part(gradients: &mut Gradients, leaf: &Tensor<2>) -> Tensor<1> {
        leaf.grad_remove(gradients)
            .unwrap_or_else(|| leaf.clone().inner().zeros_like())
            .reshape([-1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use burn::tensor::{Device, TensorData};

    fn thesis() -> Shape {
        Shape {
            widths: vec![3, 10, 8, 1],
            hidden: Activation::Relu,
            output: Activation::Identity,
        }
    }

    fn random_inputs(rows: usize, seed: u64) -> Vec<f32> {
        let mut random = Stream::Split.random(seed);
        (0..3 * rows).map(|_| random.between(-3.0, 3.0)).collect()
    }

    /// Both forward passes round every product and sum once, in different orders. A sum of k terms errs by at most
    /// about k unit roundoffs of the sum of the terms' magnitudes; through 3 + 10 + 8 terms that is below 25·2⁻²⁴ ≈
    /// 1.5e-6 of that sum in the worst case and, as errors cancel, a fraction of it in practice. The scale is the
    /// larger of the answer and 1, the size of the sums of magnitudes.
    #[test]
    fn burn_and_the_mathematics_crate_agree_to_a_millionth() {
        let device = Device::flex();
        for (seed, hidden, output) in [
            (1, Activation::Relu, Activation::Identity),
            (2, Activation::Sigmoid, Activation::Sigmoid),
            (3, Activation::Relu, Activation::Relu),
        ] {
            let mut shape = thesis();
            (shape.hidden, shape.output) = (hidden, output);
            let parameters = shape.initial(seed);
            let mlp = shape.to_mlp(&parameters);
            let flat = Tensor::from_data(TensorData::new(parameters, [137]), &device);
            let n = 4096;
            let inputs = random_inputs(n, seed);
            let x = Tensor::from_data(TensorData::new(inputs.clone(), [3, n]), &device);
            let y = Network::new(&shape, &flat).forward(x).into_data();
            let y: Vec<f32> = y.try_into_vec().unwrap();
            for row in 0..n {
                let input = [inputs[row], inputs[n + row], inputs[2 * n + row]];
                let expected = mlp.forward(&input)[0];
                let error = (y[row] - expected).abs() / expected.abs().max(1.0);
                assert!(error <= 1e-6, "{input:?}: {} against {expected}", y[row]);
            }
        }
    }

    /// Central differences of the 64-bit forward pass. With a step of 1e-4 and values of size 1 their own error is
    /// about 1e-8, except where a ReLU switches within the step: smooth activations avoid that.
    #[test]
    fn the_gradient_is_the_difference_quotient() {
        let device = Device::flex();
        let mut shape = thesis();
        shape.hidden = Activation::Sigmoid;
        let parameters = shape.initial(4);
        let rows = 5;
        let inputs = random_inputs(rows, 9);
        let flat = Tensor::from_data(TensorData::new(parameters.clone(), [137]), &device);
        let x = Tensor::from_data(TensorData::new(inputs.clone(), [3, rows]), &device);
        let network = Network::tracked(&shape, &flat);
        let loss = network.forward(x).square().sum();
        let gradient: Vec<f32> = network.gradient(loss).into_data().try_into_vec().unwrap();
        let loss_f64 = |index: usize, step: f64| -> f64 {
            let mut parameters = parameters.clone();
            parameters[index] = (f64::from(parameters[index]) + step) as f32;
            let mlp = shape.to_mlp(&parameters);
            let answers = (0..rows).map(|r| {
                let input = [0, 1, 2].map(|i| f64::from(inputs[i * rows + r]));
                mlp.forward(&input)[0].powi(2)
            });
            answers.sum()
        };
        assert!((f64::from(gradient[137]) - loss_f64(0, 0.0)).abs() < 1e-5);
        for (index, &found) in gradient[..137].iter().enumerate() {
            // The step is taken in 32 bits, which moves a parameter of size ½ by 2⁻⁸ ± 2⁻²⁵.
            let step = 1.0 / 256.0;
            let expected = (loss_f64(index, step) - loss_f64(index, -step)) / (2.0 * step);
            let error = (f64::from(found) - expected).abs();
            assert!(error < 1e-3, "{index}: {found} against {expected}");
        }
    }
}
