//! The inputs of the networks: each is one declaration with a name, a unit and a twin in Rust and in WGSL.
//!
//! A network that is asked about a fragment reads what a first pass knows of the fragment's pixel. For the anchored methods
//! that is the [`Rest`]: the fragment's *own share* is taken out of the pixel's moments, and the shares of the two ends, which
//! are known; the network is asked where the rest lies. What lies in front of a fragment does not depend on the fragment. All
//! features of the rest are free of scene scale and unit. The inputs of other networks are declared beside their methods
//! ([`methods::deep`](crate::methods::deep), [`methods::nmt`](crate::methods::nmt), [`methods::dfaoit`](crate::methods::dfaoit)).

use crate::{
    methods::moments::power::four_moment_bounds,
    statistics::{DEPTH_CODES, Statistics},
};

/// What several features have in common, computed once in the shader.
#[derive(Debug, PartialEq, Eq)]
pub struct Shared {
    /// The name that expressions refer to.
    pub name: &'static str,
    pub wgsl: &'static str,
    /// The shader module with the function that it calls.
    pub module: Option<&'static str>,
}

#[derive(Debug, PartialEq, Eq)]
pub struct About {
    /// Name in the model file, and of the parameter of the exported function.
    pub name: &'static str,
    pub unit: &'static str,
    /// Its value, a WGSL expression of what [`Feature::value`] is a function of, and of [`About::shared`].
    pub wgsl: &'static str,
    pub shared: Option<&'static Shared>,
}

/// One input of a network, a function of `C`: what is known of a fragment or a pixel.
#[derive(Debug)]
pub struct Feature<C: 'static> {
    pub about: About,
    pub value: fn(&C) -> f64,
}

impl<C> Feature<C> {
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        wgsl: &'static str,
        value: fn(&C) -> f64,
    ) -> Self {
        let about = About {
            name,
            unit,
            wgsl,
            shared: None,
        };
        Self { about, value }
    }

    /// One whose WGSL needs a value that several have in common.
    pub const fn sharing(mut self, shared: &'static Shared) -> Self {
        self.about.shared = Some(shared);
        self
    }
}

/// Below this share of the pixel's absorbance the moments of the rest are rounding noise of 16-bit sums.
const NOISE: f64 = 1.0 / 1024.0;

/// Pull of the moments towards a measure that can be inverted, for [`Rest::moment_bounds`].
const BIAS: f64 = 1.0 / 1024.0;

/// More of that pull for narrow pixels: moments of the frame's range lose `scale⁴` of their precision where they are moved to
/// the pixel's, and without it the bounds depend on the last bits of 32-bit sums.
const BIAS_BY_SCALE: f64 = 1.0 / 65_536.0;

/// Limit of the mean powers 2 to 4. In narrow pixels, the rounding of the ends and of the sums takes them beyond 1; bounds multiply
/// up to seven of them, which 32 bits hold.
const POWER_MAX: f64 = 65_536.0;

/// The most of that pull.
const BIAS_MAX: f64 = 0.25;

/// The rest of a pixel, seen from one fragment: all fragments but that one and the pixel's ends. Depths are over the pixel's
/// range, −1 at the nearest and 1 at the farthest fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    pub absorbance: f64,
    pub place: f64,
    /// Mean powers 1 to 4 of the rest's depth.
    pub means: [f64; 4],
    /// Pull of the moments towards a measure that can be inverted.
    bias: f64,
}

impl Rest {
    /// Of a fragment at depth `zeta`, given the pixel's statistics and the moments `m` of the rest.
    pub fn new(s: &Statistics, m: &[f64; 5], zeta: f64) -> Self {
        let level = 2.0 / f64::from(DEPTH_CODES - 1);
        let extent = (s.farthest - s.nearest).max(level);
        let total = m[0].max(s.moments[0] * NOISE).max(1e-6);
        // Moments over the pixel's range as −1 … 1: of (ζ − middle)·scale.
        let middle = (s.nearest + s.farthest) / 2.0;
        let scale = 2.0 / extent;
        let [m1, m2, m3, m4] = [m[1] / total, m[2] / total, m[3] / total, m[4] / total];
        let x1 = ((m1 - middle) * scale).clamp(-1.0, 1.0);
        let x2 = (m2 - middle * (2.0 * m1 - middle)) * scale.powi(2);
        let x3 = (m3 - middle * (3.0 * m2 - middle * (3.0 * m1 - middle))) * scale.powi(3);
        let x4 = {
            let inner = 6.0 * m2 - middle * (4.0 * m1 - middle);
            (m4 - middle * (4.0 * m3 - middle * inner)) * scale.powi(4)
        };
        let power = |mean: f64| mean.clamp(-POWER_MAX, POWER_MAX);
        Self {
            absorbance: m[0],
            place: ((zeta - middle) * scale).clamp(-1.0, 1.0),
            means: [x1, power(x2), power(x3), power(x4)],
            bias: (BIAS + BIAS_BY_SCALE * scale.powi(4)).min(BIAS_MAX),
        }
    }

    /// The least and the most of the rest's absorbance that can lie in front of the fragment, as shares, given four moments
    /// (Münstermann et al. 2018, §3.2; overestimation 0 and 1). NaN, where the points of a bound coincide, becomes 0.
    pub fn moment_bounds(&self) -> [f64; 2] {
        let (low, high) = four_moment_bounds(self.means, self.bias, self.place);
        [low, high].map(|share| if share > 0.0 { share.min(1.0) } else { 0.0 })
    }
}

const OF_REST: &str = "of the rest's absorbance";

const MOMENT_BOUNDS: Shared = Shared {
    name: "bounds",
    wgsl: "peelnet_moment_bounds(rest)",
    module: Some("learned::moment_bounds"),
};

/// All features of the rest, which the recipes of anchored networks read.
pub static FEATURES: [&Feature<Rest>; 5] = [
    &Feature::new(
        "root_absorbance",
        "root of the rest's absorbance",
        "rest.root_absorbance",
        |rest| rest.absorbance.sqrt(),
    ),
    &Feature::new(
        "depth_fraction",
        "of the pixel's depth range",
        "0.5 * rest.place + 0.5",
        |rest| (rest.place + 1.0) / 2.0,
    ),
    &Feature::new(
        "mean_fraction",
        "of the pixel's depth range",
        "0.5 * rest.means.x + 0.5",
        |rest| (rest.means[0] + 1.0) / 2.0,
    ),
    &Feature::<Rest>::new("share_low", OF_REST, "bounds.x", |r| r.moment_bounds()[0])
        .sharing(&MOMENT_BOUNDS),
    &Feature::<Rest>::new("share_high", OF_REST, "bounds.y", |r| r.moment_bounds()[1])
        .sharing(&MOMENT_BOUNDS),
];

pub fn all(rest: &Rest) -> [f64; 5] {
    FEATURES.map(|feature| (feature.value)(rest))
}
