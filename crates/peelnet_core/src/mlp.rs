//! The small fully connected network and its forward pass, in `f32` and `f64`.
//!
//! Training happens elsewhere; this is the arithmetic that the trainer, the exporter and the shaders must all
//! agree with. Weights are stored as PyTorch's `nn.Linear` stores them: row-major `[outputs][inputs]`,
//! `y = W x + b`.

use num_traits::Float;
use serde::{Deserialize, Serialize};
use std::iter::Sum;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Activation {
    Relu,
    Sigmoid,
    Identity,
}

impl Activation {
    pub fn apply<F: Float>(self, x: F) -> F {
        match self {
            Self::Relu => x.max(F::zero()),
            Self::Sigmoid => F::one() / (F::one() + (-x).exp()),
            Self::Identity => x,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    pub inputs: usize,
    pub outputs: usize,
    /// Row-major `[outputs][inputs]`.
    pub weights: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// A fully connected network. Its inputs are *normalised* features.
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    pub layers: Vec<Layer>,
    pub hidden: Activation,
    pub output: Activation,
}

impl Mlp {
    /// Builds a network and checks that its layers fit one another.
    ///
    /// # Errors
    /// The first layer that does not fit.
    pub fn new(layers: Vec<Layer>, hidden: Activation, output: Activation) -> Result<Self, String> {
        if layers.is_empty() {
            return Err("the network has no layers".into());
        }
        for (i, layer) in layers.iter().enumerate() {
            let (inputs, outputs) = (layer.inputs, layer.outputs);
            let [weights, biases] = [&layer.weights, &layer.bias].map(Vec::len);
            let before = if i > 0 { layers[i - 1].outputs } else { inputs };
            let wrong = if weights != inputs * outputs {
                format!("layer {i}: {weights} weights for a {outputs}×{inputs} matrix")
            } else if biases != outputs {
                format!("layer {i}: {biases} biases for {outputs} outputs")
            } else if before != inputs {
                format!("layer {i} takes {inputs} inputs but the layer before it gives {before}")
            } else {
                continue;
            };
            return Err(wrong);
        }
        Ok(Self {
            layers,
            hidden,
            output,
        })
    }

    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |l| l.inputs)
    }

    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |l| l.outputs)
    }

    pub fn parameters(&self) -> usize {
        let layers = self.layers.iter();
        layers.map(|l| l.weights.len() + l.bias.len()).sum()
    }

    /// `3-10-8-1` and the like.
    pub fn topology(&self) -> String {
        let outputs = self.layers.iter().map(|layer| layer.outputs);
        let widths = std::iter::once(self.inputs()).chain(outputs);
        widths.map(|w| w.to_string()).collect::<Vec<_>>().join("-")
    }

    /// The forward pass: in 32 bits, or in 64 bits, which are the reference for every other one.
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn forward<F: Float + Sum>(&self, input: &[F]) -> Vec<F> {
        self.run(self.layers.len(), input.to_vec(), |f, b, row, x| {
            f.apply(wide::<F>(b) + products(row, x).sum())
        })
    }

    /// The forward pass as a half-float unit does it: every product, sum and activation rounded to 16 bits.
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn forward_half(&self, input: &[f32]) -> Vec<f32> {
        let half = |x: f32| half::f16::from_f32(x).to_f32();
        let input = input.iter().map(|&v| half(v)).collect();
        self.run(self.layers.len(), input, |f, b, row, x| {
            let products = row.iter().zip(x).map(|(&w, v)| half(half(w) * v));
            half(f.apply(products.fold(half(b), |sum, p| half(sum + p))))
        })
    }

    /// The outputs of the first `count` layers. `neuron` computes one from its activation, its bias, its weights and the layer's inputs.
    fn run<F>(
        &self,
        count: usize,
        input: Vec<F>,
        neuron: impl Fn(Activation, f32, &[f32], &[F]) -> F,
    ) -> Vec<F> {
        assert_eq!(input.len(), self.inputs(), "network input length");
        let layers = self.layers.iter().enumerate().take(count);
        layers.fold(input, |x, (i, layer)| {
            let is_last = i + 1 == self.layers.len();
            let f = if is_last { self.output } else { self.hidden };
            let rows = layer.weights.chunks_exact(layer.inputs).zip(&layer.bias);
            rows.map(|(row, &b)| neuron(f, b, row, &x)).collect()
        })
    }

    /// The size that rounding errors of the last layer are relative to, the largest of its outputs': `Σ|w||x| + |b|`. A dot
    /// product in floating point errs by a multiple of that sum, not of its possibly cancelled result (Higham, "Accuracy and
    /// Stability of Numerical Algorithms", 2002, §3.1).
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn magnitude(&self, input: &[f64]) -> f64 {
        let Some(last) = self.layers.last() else {
            return 0.0;
        };
        let before = self.layers.len() - 1;
        let x = self.run(before, input.to_vec(), |f, b, row, x| {
            f.apply(f64::from(b) + products(row, x).sum::<f64>())
        });
        let rows = last.weights.chunks_exact(last.inputs).zip(&last.bias);
        rows.map(|(row, &b)| f64::from(b).abs() + products(row, &x).map(f64::abs).sum::<f64>())
            .fold(0.0, f64::max)
    }
}

/// 32 and 64 bits hold every weight.
fn wide<F: Float>(weight: f32) -> F {
    F::from(weight).unwrap_or_else(F::nan)
}

fn products<F: Float>(row: &[f32], x: &[F]) -> impl Iterator<Item = F> {
    row.iter().zip(x).map(|(&w, &v)| wide::<F>(w) * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(inputs: usize, outputs: usize, weights: &[f32], bias: &[f32]) -> Layer {
        Layer {
            inputs,
            outputs,
            weights: weights.to_vec(),
            bias: bias.to_vec(),
        }
    }

    #[test]
    fn forward_is_the_written_out_sum() {
        let layers = vec![
            layer(2, 2, &[1.0, -1.0, 0.5, 2.0], &[0.25, -4.0]),
            layer(2, 1, &[2.0, 3.0], &[1.0]),
        ];
        let net = Mlp::new(layers, Activation::Relu, Activation::Identity);
        let net = net.expect("shapes fit");
        // hidden: 3 − 1 + 0.25 = 2.25; 1.5 + 2 − 4 = −0.5 → 0
        assert_eq!(net.forward(&[3.0f32, 1.0]), vec![5.5]);
        assert_eq!(net.forward(&[3.0f64, 1.0]), vec![5.5]);
        assert_eq!(net.parameters(), 9);
        assert_eq!(net.topology(), "2-2-1");
    }

    #[test]
    fn wrong_shapes_are_named() {
        let good = || layer(2, 2, &[0.0; 4], &[0.0; 2]);
        let wide = layer(3, 1, &[0.0; 3], &[0.0]);
        let few_weights = layer(2, 2, &[0.0; 3], &[0.0; 2]);
        let few_biases = layer(2, 2, &[0.0; 4], &[0.0]);
        let misfit = "layer 1 takes 3 inputs but the layer before it gives 2";
        for (layers, want) in [
            (vec![], "the network has no layers"),
            (vec![good(), wide], misfit),
            (vec![few_weights], "layer 0: 3 weights for a 2×2 matrix"),
            (vec![few_biases], "layer 0: 1 biases for 2 outputs"),
        ] {
            let error = Mlp::new(layers, Activation::Relu, Activation::Identity).err();
            assert_eq!(error.as_deref(), Some(want));
        }
    }
}
