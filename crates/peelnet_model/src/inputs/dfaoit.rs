//! `dfaoit`: sums over the layers of a pixel. Every pixel with more fragments than are composited exactly is an example.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::methods::dfaoit::{FRONT, Layers};

const AVERAGE: Shared = Shared {
    name: "average",
    wgsl: "behind / max(count, 1.0)",
    module: None,
};

const fn feature(
    name: &'static str,
    wgsl: &'static str,
    value: fn(&Layers) -> f64,
) -> Feature<Layers> {
    Feature::new(name, "1", wgsl, value)
}

/// The inputs of the network, in the published order.
pub static DFAOIT: [&Feature<Layers>; 10] = [
    &feature("average_alpha", "average.a", |l| l.average_alpha).sharing(&AVERAGE),
    &feature("average_r", "average.r", |l| l.average[0]).sharing(&AVERAGE),
    &feature("average_g", "average.g", |l| l.average[1]).sharing(&AVERAGE),
    &feature("average_b", "average.b", |l| l.average[2]).sharing(&AVERAGE),
    &feature("sum_r", "all.r", |layers| layers.sum[0]),
    &feature("sum_g", "all.g", |layers| layers.sum[1]),
    &feature("sum_b", "all.b", |layers| layers.sum[2]),
    &feature("front_r", "front.r", |layers| layers.front[0]),
    &feature("front_g", "front.g", |layers| layers.front[1]),
    &feature("front_b", "front.b", |layers| layers.front[2]),
];

/// The layers of a pixel.
#[derive(Debug)]
pub struct DfaoitInputs;

impl NetworkInputs for DfaoitInputs {
    fn features(&self) -> Vec<&'static About> {
        about(&DFAOIT)
    }

    fn surroundings(&self) -> &'static Surroundings {
        &SURROUNDINGS
    }

    fn examples(&self, pixel: &PeeledPixel<'_>) -> Examples {
        let fragments = pixel.observed.fragments;
        if fragments.len() <= FRONT || pixel.transmittance_behind() >= 1.0 {
            return Examples::Rows(Vec::new());
        }
        let mut exact = [0.0f64; 3];
        for (contribution, color) in pixel.contributions().zip(pixel.colors) {
            for (sum, &c) in exact.iter_mut().zip(color) {
                *sum += contribution * f64::from(c);
            }
        }
        let alphas = fragments.iter().map(|&(_, alpha)| alpha);
        let layers = Layers::from_fragments(alphas.zip(pixel.colors.iter().copied()));
        Examples::Rows(vec![RowExample {
            inputs: values(&DFAOIT, &layers),
            targets: exact.map(|c| c.min(1.0)).to_vec(),
        }])
    }
}

const OVER: ([f32; 4], Blend, Blend) = ([0.0, 0.0, 0.0, 1.0], Blend::Add, Blend::Transmit);

static SURROUNDINGS: Surroundings = Surroundings {
    parameters: "front: vec4f, behind: vec4f, all: vec4f, count: f32",
    modules: &["learned::dfaoit"],
    before: "Composite the two nearest fragments of each pixel exactly, by depth peeling or insertion, into front: premultiplied colour, \
        and transmittance in alpha. The pass below draws them again, with front = true.",
    around: None,
    passes: PASSES,
    resolve: "peelnet_resolve(front, behind, all, count, background)",
};

const PASSES: &[Pass] = &[pass(
    "statistics",
    &["front"],
    statistics("peelnet_statistics(vec4f(rgb, alpha), front)"),
    &[
        sum("behind", HALF, "s.behind"),
        target("all", HALF, OVER, "s.all"),
        sum("count", "r16float", "s.count"),
    ],
)];

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::{fragment::worked_example, methods::dfaoit::composite};

    /// The worked example: ½ red, ½ green in front, ½ blue and 0.9 white behind them.
    #[test]
    fn known_fragments_have_known_inputs() {
        let mut inputs = [0.0; 10];
        composite(&worked_example(), [0.0; 3], |layers| {
            inputs = DFAOIT.map(|f| (f.value)(layers));
            [0.0; 3]
        });
        // Behind: α (0.5 + 0.9)/2, colour (blue + white)/2. Sum: ½ of each and 0.9. Front: ½ red and ¼ green.
        let want = [0.7, 0.5, 0.5, 1.0, 1.4, 1.4, 1.4, 0.5, 0.25, 0.0];
        for (got, want) in inputs.iter().zip(want) {
            // 0.9 in 32 bits.
            assert!((got - want).abs() < 1e-7, "{inputs:?}");
        }
    }
}
