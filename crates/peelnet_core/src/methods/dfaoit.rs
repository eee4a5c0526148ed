//! `dfaoit`: the two nearest fragments exactly, and from three fragments on the colour of all of them from a network ("Deep and Fast
//! Approximate Order Independent Transparency", Tsopouridis, Vasilakis & Fudos 2024).
//!
//! Inputs and network (10-32-16-3) are those of the authors' shaders (github.com/gtsopus/DFA): averages of α and of the colour that is
//! *not* premultiplied over the fragments behind the two nearest, `Σ α c` of *all* fragments, and the two nearest composited. The network
//! predicts everything but the background, which is added with `T_∞`. One thing is ours, and changes nothing but rounding: the averages
//! are summed behind the two nearest, where they subtract those from sums over all.

use super::over;
use crate::{
    features::{Feature, Shared},
    fragment::Fragment,
};

/// Fragments that are composited exactly.
pub const FRONT: usize = 2;

/// What is known of a pixel with more than [`FRONT`] fragments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layers {
    /// Mean opacity of the fragments behind the front.
    pub average_alpha: f64,
    /// Their mean colour, not premultiplied, each with the same weight.
    pub average: [f64; 3],
    /// `Σ α c` of all fragments.
    pub sum: [f64; 3],
    /// The front, composited and premultiplied.
    pub front: [f64; 3],
}

impl Layers {
    /// Of a pixel's fragments, given as (α, radiance), nearest first.
    pub fn of(fragments: impl IntoIterator<Item = (f32, [f32; 3])>) -> Self {
        let mut layers = Self::default();
        let (mut through, mut behind) = (1.0, 0.0);
        for (i, (alpha, color)) in fragments.into_iter().enumerate() {
            let alpha = f64::from(alpha);
            for (k, c) in color.map(f64::from).into_iter().enumerate() {
                layers.sum[k] += alpha * c;
                if i < FRONT {
                    layers.front[k] += through * alpha * c;
                } else {
                    layers.average[k] += c;
                }
            }
            if i < FRONT {
                through *= 1.0 - alpha;
            } else {
                layers.average_alpha += alpha;
                behind += 1.0;
            }
        }
        if behind > 0.0 {
            layers.average_alpha /= behind;
            layers.average = layers.average.map(|c| c / behind);
        }
        layers
    }
}

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

/// The inputs of the network, in the published order; in WGSL functions of `front`, `behind`, `all` and `count`.
pub static INPUTS: [&Feature<Layers>; 10] = [
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

/// Composites a pixel; `network` predicts the colour of all fragments over black.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    network: impl FnOnce(&Layers) -> [f32; 3],
) -> [f32; 3] {
    let sorted = over::sorted(fragments);
    let transmittance: f32 = sorted.iter().map(|f| 1.0 - f.alpha).product();
    if sorted.len() <= FRONT || transmittance == 1.0 {
        return over::composite(&sorted, background);
    }
    let color = network(&Layers::of(sorted.iter().map(|f| (f.alpha, f.color))));
    std::array::from_fn(|k| color[k] + transmittance * background[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::worked_example;

    /// From three layers on the network's colour stands in front of the background, with T_∞ = ½³·0.1.
    #[test]
    fn the_background_shines_through() {
        let c0 = [0.1, 0.2, 0.9];
        let got = composite(&worked_example(), c0, |_| [0.5; 3]);
        for (g, b) in got.iter().zip(c0) {
            assert!((g - (0.5 + 0.0125 * b)).abs() < 1e-6, "{got:?}");
        }
    }

    /// The worked example: ½ red, ½ green in front, ½ blue and 0.9 white behind them.
    #[test]
    fn known_fragments_have_known_inputs() {
        let mut inputs = [0.0; 10];
        composite(&worked_example(), [0.0; 3], |layers| {
            inputs = INPUTS.map(|f| (f.value)(layers));
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
