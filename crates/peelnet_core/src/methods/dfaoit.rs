//! `dfaoit`: the two nearest fragments exactly, and from three fragments on the colour of all of them from a network ("Deep and Fast
//! Approximate Order Independent Transparency", Tsopouridis, Vasilakis & Fudos 2024).
//!
//! Inputs and network (10-32-16-3) are those of the authors' shaders (github.com/gtsopus/DFA): averages of α and of the colour that is
//! *not* premultiplied over the fragments behind the two nearest, `Σ α c` of *all* fragments, and the two nearest composited. The network
//! predicts everything but the background, which is added with `T_∞`. One thing is ours, and changes nothing but rounding: the averages
//! are summed behind the two nearest, where they subtract those from sums over all.

use super::over;
use crate::fragment::Fragment;

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
    pub fn from_fragments(fragments: impl IntoIterator<Item = (f32, [f32; 3])>) -> Self {
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
    let layers = sorted.iter().map(|f| (f.alpha, f.color));
    let color = network(&Layers::from_fragments(layers));
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
}
