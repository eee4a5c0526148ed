//! Adam (Kingma and Ba, 2015, algorithm 1) on the flat tensor of parameters.
//!
//! Ours instead of burn's, which takes a module's tensors one by one: an operation on so few numbers costs more than its arithmetic.

use crate::config::Config;

/// Parameters, first and second moments, and the number of steps taken.
#[derive(Clone)]
pub(crate) struct Adam {
    pub(crate) parameters: Vec<f32>,
    pub(crate) first: Vec<f32>,
    pub(crate) second: Vec<f32>,
    pub(crate) steps: u64,
}

impl Adam {
    pub(crate) fn new(parameters: Vec<f32>) -> Self {
        Self {
            first: vec![0.0; parameters.len()],
            second: vec![0.0; parameters.len()],
            parameters,
            steps: 0,
        }
    }

    /// One step against a gradient, given as its sum over so many examples.
    pub(crate) fn step(&mut self, config: &Config, rate: f64, sum: &[f32], examples: usize) {
        self.steps += 1;
        // 1 − βᵗ; beyond 2³¹ steps both are 1 to the last bit.
        let exponent = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let correction = |beta: f64| 1.0 - beta.powi(exponent);
        let [beta1, beta2] = [config.beta1, config.beta2].map(|beta| beta as f32);
        let scale = (1.0 / examples as f64) as f32;
        let rate = (rate / correction(config.beta1)) as f32;
        let root = (1.0 / correction(config.beta2).sqrt()) as f32;
        let epsilon = config.epsilon as f32;
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((parameter, (first, second)), sum) in self.parameters.iter_mut().zip(moments).zip(sum)
        {
            let gradient = sum * scale;
            *first = *first * beta1 + gradient * (1.0 - beta1);
            *second = *second * beta2 + gradient * gradient * (1.0 - beta2);
            *parameter -= *first * rate / (second.sqrt() * root + epsilon);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_model::Recipe;

    /// Against the algorithm written out in 64 bits. Each step rounds about ten operations on numbers below 1, and
    /// moves the parameters by at most the rate: 100 steps stay within 100 · 10 · 2⁻²⁴ ≈ 6e-5.
    #[test]
    fn steps_follow_the_written_out_algorithm() {
        let config = Config::for_recipe(Recipe::THESIS);
        let mut adam = Adam::new(vec![0.5, -0.25]);
        let (mut p, mut m, mut v) = ([0.5f64, -0.25], [0.0; 2], [0.0; 2]);
        let rate = 1e-2;
        for t in 1..=100 {
            let gradient = [(t as f32 * 0.7).sin(), 1e-3 * (t as f32 * 0.3).cos()];
            adam.step(&config, rate, &gradient.map(|g| 2.0 * g), 2);
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
        let found = adam.parameters;
        for i in 0..2 {
            assert!(
                (f64::from(found[i]) - p[i]).abs() < 6e-5,
                "{found:?} against {p:?}"
            );
        }
    }
}
