//! `dfaoit`: the two nearest fragments exactly, the colour of the rest from a network (Tsopouridis, Vasilakos & Fudos 2024).

use super::over;
use crate::{
    absorbance::absorbance,
    features::{About, Feature, Shared},
    fragment::Fragment,
};

/// Fragments that are composited exactly.
pub const FRONT: usize = 2;

/// What is known of a pixel: its two nearest fragments composited, and sums over the others, the tail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tail {
    /// Colour of the front, premultiplied.
    pub front: [f64; 3],
    /// Transmittance of the front.
    pub front_transmittance: f64,
    /// Mean colour of the tail, weighted by opacity.
    pub average: [f64; 3],
    /// Mean opacity of the tail's fragments.
    pub alpha: f64,
    /// Transmittance of the tail.
    pub transmittance: f64,
    /// Number of the tail's fragments.
    pub count: f64,
}

/// A feature; in WGSL a function of `front`, `tail`, `sums` and `average`.
const fn feature(
    name: &'static str,
    wgsl: &'static str,
    shared: Option<&'static Shared>,
    value: fn(&Tail) -> f64,
) -> Feature<Tail> {
    Feature {
        about: About {
            name,
            unit: "1",
            wgsl,
            shared,
        },
        value,
    }
}

const AVERAGE: Shared = Shared {
    name: "average",
    wgsl: "peelnet_average(tail)",
    module: None,
};

/// The inputs of the network.
pub static INPUTS: [&Feature<Tail>; 10] = [
    &feature("front_r", "front.r", None, |tail| tail.front[0]),
    &feature("front_g", "front.g", None, |tail| tail.front[1]),
    &feature("front_b", "front.b", None, |tail| tail.front[2]),
    &feature("front_transmittance", "front.a", None, |tail| {
        tail.front_transmittance
    }),
    &feature("tail_r", "average.r", Some(&AVERAGE), |tail| {
        tail.average[0]
    }),
    &feature("tail_g", "average.g", Some(&AVERAGE), |tail| {
        tail.average[1]
    }),
    &feature("tail_b", "average.b", Some(&AVERAGE), |tail| {
        tail.average[2]
    }),
    &feature("tail_alpha", "tail.a / max(sums.y, 1.0)", None, |tail| {
        tail.alpha
    }),
    &feature("tail_transmittance", "exp(-sums.x)", None, |tail| {
        tail.transmittance
    }),
    &feature("tail_count", "sums.y", None, |tail| tail.count),
];

/// Composites a pixel; `network` predicts the colour of the tail.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    network: impl FnOnce(&Tail) -> [f32; 3],
) -> [f32; 3] {
    let sorted = over::sorted(fragments);
    let (front, tail) = sorted.split_at(sorted.len().min(FRONT));
    if tail.is_empty() {
        return over::composite(front, background);
    }
    let near = over::composite(front, [0.0; 3]);
    let near_transmittance: f32 = front.iter().map(|f| 1.0 - f.alpha).product();
    let n = tail.len() as f32;
    let alpha: f32 = tail.iter().map(|f| f.alpha).sum();
    let total: f64 = tail.iter().map(|f| absorbance(f.alpha)).sum();
    let transmittance = (-total).exp() as f32;
    let mean: [f32; 3] = std::array::from_fn(|k| {
        let sum: f32 = tail.iter().map(|f| f.premultiplied()[k]).sum();
        sum / alpha.max(1e-6)
    });
    // A tail of one fragment is its colour.
    let color = if tail.len() == 1 {
        mean
    } else {
        network(&Tail {
            front: near.map(f64::from),
            front_transmittance: near_transmittance.into(),
            average: mean.map(f64::from),
            alpha: (alpha / n).into(),
            transmittance: transmittance.into(),
            count: n.into(),
        })
    };
    std::array::from_fn(|k| {
        let behind = color[k] * (1.0 - transmittance) + background[k] * transmittance;
        near[k] + near_transmittance * behind
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::worked_example;

    /// Up to three layers are exact whatever the network predicts, and what it predicts is what lies behind two.
    #[test]
    fn few_layers_are_exact() {
        let f = worked_example();
        let c0 = [0.1, 0.2, 0.9];
        for n in 0..=3 {
            let (got, want) = (
                composite(&f[..n], c0, |_| [9.0; 3]),
                over::composite(&f[..n], c0),
            );
            for k in 0..3 {
                assert!((got[k] - want[k]).abs() < 1e-6, "{n}: {got:?} {want:?}");
            }
        }
        let mut seen = 0.0;
        composite(&f, c0, |tail| {
            seen = tail.count;
            [0.0; 3]
        });
        assert_eq!(seen, 2.0);
    }
}
