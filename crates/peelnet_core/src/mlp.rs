//! The small fully connected network and its forward pass, in `f32` and `f64`.
//!
//! Training happens elsewhere; this is the arithmetic that the trainer, the exporter and the shaders must all
//! agree with. Weights are stored as PyTorch's `nn.Linear` stores them: row-major `[outputs][inputs]`,
//! `y = W x + b`.

use serde::{Deserialize, Serialize};

/// The function applied after a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Activation {
    /// `max(x, 0)`.
    Relu,
    /// `1 / (1 + exp(−x))`.
    Sigmoid,
    /// `x`.
    Identity,
}

impl Activation {
    /// Applies the function to one value.
    pub fn apply(self, x: f32) -> f32 {
        match self {
            Self::Relu => x.max(0.0),
            Self::Sigmoid => 1.0 / (1.0 + (-x).exp()),
            Self::Identity => x,
        }
    }

    /// Applies the function to one value in 64 bits.
    pub fn apply_f64(self, x: f64) -> f64 {
        match self {
            Self::Relu => x.max(0.0),
            Self::Sigmoid => 1.0 / (1.0 + (-x).exp()),
            Self::Identity => x,
        }
    }
}

/// One affine layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Number of inputs.
    pub inputs: usize,
    /// Number of outputs.
    pub outputs: usize,
    /// Row-major `[outputs][inputs]`.
    pub weights: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
}

/// Why layers do not make a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// A network needs at least one layer.
    #[error("the network has no layers")]
    Empty,
    /// The number of weights is not `outputs × inputs`.
    #[error("layer {layer}: {found} weights for a {outputs}×{inputs} matrix")]
    Weights {
        /// Index of the layer.
        layer: usize,
        /// Rows of the matrix.
        outputs: usize,
        /// Columns of the matrix.
        inputs: usize,
        /// Number of weights given.
        found: usize,
    },
    /// The number of biases is not `outputs`.
    #[error("layer {layer}: {found} biases for {outputs} outputs")]
    Bias {
        /// Index of the layer.
        layer: usize,
        /// Outputs of the layer.
        outputs: usize,
        /// Number of biases given.
        found: usize,
    },
    /// A layer's inputs are not the outputs of the layer before it.
    #[error("layer {layer} takes {inputs} inputs but the layer before it gives {before}")]
    Chain {
        /// Index of the layer.
        layer: usize,
        /// Inputs of the layer.
        inputs: usize,
        /// Outputs of the layer before.
        before: usize,
    },
}

/// A fully connected network. Its inputs are *normalised* features.
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    /// The affine layers, first to last.
    pub layers: Vec<Layer>,
    /// Applied after every layer but the last.
    pub hidden: Activation,
    /// Applied after the last layer.
    pub output: Activation,
}

impl Mlp {
    /// Builds a network and checks that its layers fit one another.
    ///
    /// # Errors
    /// [`ShapeError`] names the first layer that does not fit.
    pub fn new(
        layers: Vec<Layer>,
        hidden: Activation,
        output: Activation,
    ) -> Result<Self, ShapeError> {
        if layers.is_empty() {
            return Err(ShapeError::Empty);
        }
        for (i, layer) in layers.iter().enumerate() {
            let Layer {
                inputs, outputs, ..
            } = *layer;
            if layer.weights.len() != inputs * outputs {
                return Err(ShapeError::Weights {
                    layer: i,
                    outputs,
                    inputs,
                    found: layer.weights.len(),
                });
            }
            if layer.bias.len() != outputs {
                return Err(ShapeError::Bias {
                    layer: i,
                    outputs,
                    found: layer.bias.len(),
                });
            }
            if i > 0 && layers[i - 1].outputs != inputs {
                return Err(ShapeError::Chain {
                    layer: i,
                    inputs,
                    before: layers[i - 1].outputs,
                });
            }
        }
        Ok(Self {
            layers,
            hidden,
            output,
        })
    }

    /// Number of inputs of the first layer.
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |l| l.inputs)
    }

    /// Number of outputs of the last layer.
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |l| l.outputs)
    }

    /// Weights and biases together.
    pub fn parameters(&self) -> usize {
        self.layers
            .iter()
            .map(|l| l.weights.len() + l.bias.len())
            .sum()
    }

    /// `3-10-8-1` and the like.
    pub fn topology(&self) -> String {
        let mut text = self.inputs().to_string();
        for layer in &self.layers {
            text.push('-');
            text.push_str(&layer.outputs.to_string());
        }
        text
    }

    /// The forward pass in 32 bits.
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn forward(&self, input: &[f32]) -> Vec<f32> {
        assert_eq!(input.len(), self.inputs(), "network input length");
        let mut x = input.to_vec();
        for (i, layer) in self.layers.iter().enumerate() {
            let f = self.activation(i);
            x = layer
                .weights
                .chunks_exact(layer.inputs)
                .zip(&layer.bias)
                .map(|(row, &b)| f.apply(b + row.iter().zip(&x).map(|(w, v)| w * v).sum::<f32>()))
                .collect();
        }
        x
    }

    /// The forward pass in 64 bits, the judge of every other one.
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn forward_f64(&self, input: &[f64]) -> Vec<f64> {
        assert_eq!(input.len(), self.inputs(), "network input length");
        let mut x = input.to_vec();
        for (i, layer) in self.layers.iter().enumerate() {
            let f = self.activation(i);
            x = layer
                .weights
                .chunks_exact(layer.inputs)
                .zip(&layer.bias)
                .map(|(row, &b)| {
                    f.apply_f64(
                        f64::from(b)
                            + row
                                .iter()
                                .zip(&x)
                                .map(|(&w, v)| f64::from(w) * v)
                                .sum::<f64>(),
                    )
                })
                .collect();
        }
        x
    }

    /// The forward pass as a half-float unit does it: every product, sum and activation rounded to 16 bits.
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn forward_half(&self, input: &[f32]) -> Vec<f32> {
        assert_eq!(input.len(), self.inputs(), "network input length");
        let half = |x: f32| half::f16::from_f32(x).to_f32();
        let mut x: Vec<f32> = input.iter().map(|&v| half(v)).collect();
        for (i, layer) in self.layers.iter().enumerate() {
            let f = self.activation(i);
            x = layer
                .weights
                .chunks_exact(layer.inputs)
                .zip(&layer.bias)
                .map(|(row, &b)| {
                    let products = row.iter().zip(&x).map(|(&w, v)| half(half(w) * v));
                    half(f.apply(products.fold(half(b), |sum, p| half(sum + p))))
                })
                .collect();
        }
        x
    }

    /// The size that rounding errors of the last layer are relative to, the largest of its outputs': `Σ|w||x| + |b|`. A dot
    /// product in floating point errs by a multiple of that sum, not of its possibly cancelled result (Higham, "Accuracy and
    /// Stability of Numerical Algorithms", 2002, §3.1).
    ///
    /// # Panics
    /// If `input` does not have [`Mlp::inputs`] values.
    pub fn magnitude(&self, input: &[f64]) -> f64 {
        let Some((last, before)) = self.layers.split_last() else {
            return 0.0;
        };
        let hidden = Self {
            layers: before.to_vec(),
            hidden: self.hidden,
            output: self.hidden,
        };
        let x = if before.is_empty() {
            input.to_vec()
        } else {
            hidden.forward_f64(input)
        };
        let sizes = last.weights.chunks_exact(last.inputs).zip(&last.bias);
        sizes
            .map(|(row, &b)| {
                let terms = row.iter().zip(&x).map(|(&w, v)| (f64::from(w) * v).abs());
                f64::from(b).abs() + terms.sum::<f64>()
            })
            .fold(0.0, f64::max)
    }

    fn activation(&self, layer: usize) -> Activation {
        if layer + 1 == self.layers.len() {
            self.output
        } else {
            self.hidden
        }
    }
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
        let net = Mlp::new(
            vec![
                layer(2, 2, &[1.0, -1.0, 0.5, 2.0], &[0.25, -4.0]),
                layer(2, 1, &[2.0, 3.0], &[1.0]),
            ],
            Activation::Relu,
            Activation::Identity,
        )
        .expect("shapes fit");
        // hidden: 3 − 1 + 0.25 = 2.25; 1.5 + 2 − 4 = −0.5 → 0
        assert_eq!(net.forward(&[3.0, 1.0]), vec![5.5]);
        assert_eq!(net.forward_f64(&[3.0, 1.0]), vec![5.5]);
        assert_eq!(net.parameters(), 9);
        assert_eq!(net.topology(), "2-2-1");
    }

    #[test]
    fn wrong_shapes_are_named() {
        let e = Mlp::new(
            vec![
                layer(2, 2, &[0.0; 4], &[0.0; 2]),
                layer(3, 1, &[0.0; 3], &[0.0]),
            ],
            Activation::Relu,
            Activation::Identity,
        );
        assert_eq!(
            e,
            Err(ShapeError::Chain {
                layer: 1,
                inputs: 3,
                before: 2
            })
        );
        let e = Mlp::new(
            vec![layer(2, 2, &[0.0; 3], &[0.0; 2])],
            Activation::Relu,
            Activation::Identity,
        );
        assert!(matches!(
            e,
            Err(ShapeError::Weights {
                layer: 0,
                found: 3,
                ..
            })
        ));
    }
}
