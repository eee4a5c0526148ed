use crate::{Model, Output, Recipe};
use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    methods::{anchored, mboit4, nmt},
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
        let inputs = self.meta.inputs.len();
        match self.meta.output {
            Output::AnchoredShare | Output::AnchoredShareSeparateEnds => {
                anchored::seen(points, warp, precision)
                    .iter()
                    .map(|s| s.weight(|features| self.forward_raw_f64(&features[..inputs])[0]))
                    .collect()
            }
            Output::Transmittance if self.meta.recipe == Recipe::Nmt => {
                let zeta = |depth: f32| warp.apply(depth.into());
                let mut moments = mboit4::Moments::default();
                for &(depth, alpha) in points {
                    moments.add(absorbance(alpha), zeta(depth));
                }
                points
                    .iter()
                    .map(|&(depth, _)| {
                        let inputs = nmt::inputs(&moments, points.len(), zeta(depth));
                        self.forward_raw_f64(&inputs)[0]
                    })
                    .collect()
            }
            Output::Transmittance => {
                let sum: f32 = points.iter().map(|(_, alpha)| alpha).sum();
                points
                    .iter()
                    .map(|&(depth, _)| {
                        self.forward_raw(&[depth, sum, points.len() as f32])[0].into()
                    })
                    .collect()
            }
            Output::TailColor => Vec::new(),
        }
    }
}
