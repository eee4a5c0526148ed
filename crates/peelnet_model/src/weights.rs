use crate::{Inputs, Model};
use peelnet_core::{
    absorbance::DepthWarp,
    features::Feature,
    methods::{anchored, deep, nmt, slabs},
    statistics::SumPrecision,
};

impl Model {
    /// The weight of every fragment of a pixel, an estimate of the transmittance in front of it, in 64 bits; fragments are
    /// (linear depth, α). Empty for a network that predicts none.
    pub fn transmittances(
        &self,
        points: &[(f32, f32)],
        warp: &DepthWarp,
        precision: SumPrecision,
    ) -> Vec<f64> {
        match self.meta.recipe.inputs {
            Inputs::Rest(features) => anchored::seen(points, warp, precision)
                .iter()
                .map(|seen| seen.weight(|rest| self.answer(features, rest)))
                .collect(),
            Inputs::Slabs(design, features) => slabs::seen(points, warp, design, precision)
                .iter()
                .map(|seen| seen.weight(|between| self.answer(features, between)))
                .collect(),
            Inputs::Moments(features) => {
                let all = nmt::Seen::all(points, warp);
                all.iter().map(|seen| self.answer(features, seen)).collect()
            }
            Inputs::Row(features) => {
                let alpha_sum = points.iter().map(|(_, alpha)| alpha).sum();
                let weight = |&(linear_depth, _): &(f32, f32)| {
                    let known = deep::Row {
                        linear_depth,
                        alpha_sum,
                        fragment_count: points.len() as f32,
                    };
                    let inputs = features.iter().map(|f| (f.value)(&known) as f32);
                    self.forward_raw(&inputs.collect::<Vec<_>>())[0].into()
                };
                points.iter().map(weight).collect()
            }
            Inputs::Layers(_) => Vec::new(),
        }
    }

    /// The network's outputs for what is known of a fragment or a pixel.
    pub fn answers<C>(&self, features: &[&Feature<C>], known: &C) -> Vec<f64> {
        let inputs: Vec<f64> = features.iter().map(|f| (f.value)(known)).collect();
        self.forward_raw(&inputs)
    }

    /// The first of [`Model::answers`].
    pub fn answer<C>(&self, features: &[&Feature<C>], known: &C) -> f64 {
        self.answers(features, known)[0]
    }
}
