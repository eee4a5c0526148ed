//! `nmt`: a network reads the moments of a pixel (Tsopouridis, Vasilakos & Fudos 2024).

use crate::features::{About, Feature, Shared};

/// What is known of a fragment and its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Warped depth of the fragment.
    pub zeta: f64,
    /// Number of the pixel's fragments.
    pub count: usize,
    /// Moments `b_0 … b_4` of the pixel.
    pub moments: [f64; 5],
}

impl Seen {
    /// `b_k` over `b_0`.
    fn mean(&self, k: usize) -> f64 {
        self.moments[k] / self.moments[0].max(1e-6)
    }
}

/// A feature; in WGSL a function of `zeta`, `absorbance` and `moments`.
const fn feature(
    name: &'static str,
    unit: &'static str,
    wgsl: &'static str,
    value: fn(&Seen) -> f64,
) -> Feature<Seen> {
    Feature {
        about: About {
            name,
            unit,
            wgsl,
            shared: None,
        },
        value,
    }
}

/// `b_k` over `b_0`, `k` at least 1.
const fn mean(name: &'static str, wgsl: &'static str, value: fn(&Seen) -> f64) -> Feature<Seen> {
    const MEANS: Shared = Shared {
        name: "means",
        wgsl: "moments / max(absorbance.x, 1e-6)",
        module: None,
    };
    let mut mean = feature(name, "1", wgsl, value);
    mean.about.shared = Some(&MEANS);
    mean
}

/// The inputs of the network: ζ, the number of fragments, `b_0`, and `b_1 … b_4` over it.
pub static INPUTS: [&Feature<Seen>; 7] = [
    &feature(
        "depth",
        "warped, -1 .. 1 over the frame's transparent depth range",
        "zeta",
        |seen| seen.zeta,
    ),
    &feature("fragment_count", "1", "absorbance.y", |seen| {
        seen.count as f64
    }),
    &feature("absorbance", "1", "absorbance.x", |seen| seen.moments[0]),
    &mean("moment_1", "means.x", |seen| seen.mean(1)),
    &mean("moment_2", "means.y", |seen| seen.mean(2)),
    &mean("moment_3", "means.z", |seen| seen.mean(3)),
    &mean("moment_4", "means.w", |seen| seen.mean(4)),
];
