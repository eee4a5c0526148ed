//! Adam (Kingma and Ba, 2015, algorithm 1) on the flat tensor of parameters.
//!
//! Ours instead of burn's, because burn's takes a module's tensors one by one: six times as many operations, on tensors so
//! small that an operation costs more than its arithmetic.

use burn::tensor::Tensor;

use crate::config::Config;

/// Parameters, first and second moments, and the number of steps taken. Cloning it copies references to tensors, not their values.
#[derive(Clone)]
pub(crate) struct Adam {
    pub(crate) parameters: Tensor<1>,
    pub(crate) first: Tensor<1>,
    pub(crate) second: Tensor<1>,
    pub(crate) steps: u64,
}

impl Adam {
    pub(crate) fn new(parameters: Tensor<1>) -> Self {
        Self {
            first: parameters.zeros_like(),
            second: parameters.zeros_like(),
            parameters,
            steps: 0,
        }
    }

    pub(crate) fn step(&self, config: &Config, rate: f64, gradient: Tensor<1>) -> Self {
        let (beta1, beta2) = (config.beta1, config.beta2);
        let steps = self.steps + 1;
        // 1 − βᵗ; beyond 2³¹ steps both are 1 to the last bit.
        let exponent = i32::try_from(steps).unwrap_or(i32::MAX);
        let correction1 = 1.0 - beta1.powi(exponent);
        let correction2 = 1.0 - beta2.powi(exponent);
        let first = self.first.clone() * beta1 + gradient.clone() * (1.0 - beta1);
        let second = self.second.clone() * beta2 + gradient.clone() * gradient * (1.0 - beta2);
        let root = second.clone().sqrt() * (1.0 / correction2.sqrt()) + config.epsilon;
        Self {
            parameters: self.parameters.clone() - first.clone() * (rate / correction1) / root,
            first,
            second,
            steps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use burn::tensor::{Device, TensorData};
    use peelnet_model::Recipe;

    /// Against the algorithm written out in 64 bits. Each step rounds about ten operations on numbers below 1, and
    /// moves the parameters by at most the rate: 100 steps stay within 100 · 10 · 2⁻²⁴ ≈ 6e-5.
    #[test]
    fn steps_follow_the_written_out_algorithm() {
        let config = Config::for_recipe(Recipe::THESIS);
        let tensor = |values: [f32; 2]| {
            Tensor::<1>::from_data(TensorData::new(values.to_vec(), [2]), &Device::flex())
        };
        let mut adam = Adam::new(tensor([0.5, -0.25]));
        let (mut p, mut m, mut v) = ([0.5f64, -0.25], [0.0; 2], [0.0; 2]);
        let rate = 1e-2;
        for t in 1..=100 {
            let gradient = [(t as f32 * 0.7).sin(), 1e-3 * (t as f32 * 0.3).cos()];
            adam = adam.step(&config, rate, tensor(gradient));
            for i in 0..2 {
                let g = f64::from(gradient[i]);
                m[i] = config.beta1 * m[i] + (1.0 - config.beta1) * g;
                v[i] = config.beta2 * v[i] + (1.0 - config.beta2) * g * g;
                let m_hat = m[i] / (1.0 - config.beta1.powi(t));
                let v_hat = v[i] / (1.0 - config.beta2.powi(t));
                p[i] -= rate * m_hat / (v_hat.sqrt() + config.epsilon);
            }
        }
        assert_eq!(adam.steps, 100);
        let found: Vec<f32> = adam.parameters.into_data().try_into_vec().unwrap();
        for i in 0..2 {
            assert!(
                (f64::from(found[i]) - p[i]).abs() < 6e-5,
                "{found:?} against {p:?}"
            );
        }
    }
}
