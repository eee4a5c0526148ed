//! The inputs of the networks: each is one declaration with a name, a unit and a twin in Rust and in WGSL.
//!
//! A network that is asked about a fragment reads what a first pass knows of the fragment's pixel. For the anchored methods
//! that is the [`Rest`]: the fragment's *own share* is taken out of the pixel's moments, and the shares of the two ends, which
//! are known; the network is asked where the rest lies. What lies in front of a fragment does not depend on the fragment. All
//! features of the rest are free of scene scale and unit. The inputs of other networks are declared beside their methods
//! ([`methods::deep`](crate::methods::deep), [`methods::nmt`](crate::methods::nmt), [`methods::dfaoit`](crate::methods::dfaoit)).
//!
//! Written once for 32 and 64 bits: shaders compute in 32, training and tests in 64.

use crate::{
    methods::moments::power::four_moment_bounds,
    statistics::{DEPTH_CODES, Statistics},
};
use num_traits::Float;

/// What several features have in common, computed once in the shader.
#[derive(Debug, PartialEq, Eq)]
pub struct Shared {
    /// The name that expressions refer to.
    pub name: &'static str,
    /// Its value, a WGSL expression.
    pub wgsl: &'static str,
    /// The shader module with the function that it calls.
    pub module: Option<&'static str>,
}

/// A feature's name, unit and twin in WGSL.
#[derive(Debug, PartialEq, Eq)]
pub struct About {
    /// Name in the model file, and of the parameter of the exported function.
    pub name: &'static str,
    /// Unit, for readers of the model file.
    pub unit: &'static str,
    /// Its value, a WGSL expression of what [`Feature::value`] is a function of, and of [`About::shared`].
    pub wgsl: &'static str,
    /// A value that the expression needs.
    pub shared: Option<&'static Shared>,
}

/// One input of a network, a function of `C`: what is known of a fragment or a pixel.
#[derive(Debug)]
pub struct Feature<C: 'static> {
    /// Name, unit and WGSL.
    pub about: About,
    /// Its value, in Rust.
    pub value: fn(&C) -> f64,
}

impl<C> Feature<C> {
    /// A feature by name, unit, WGSL and value.
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
pub struct Rest<F> {
    /// Its absorbance, `m_0`.
    pub absorbance: F,
    /// Depth of the fragment, −1 … 1.
    pub place: F,
    /// Mean powers 1 to 4 of the rest's depth.
    pub means: [F; 4],
    /// Pull of the moments towards a measure that can be inverted.
    bias: F,
}

/// Every constant here is exactly a 32-bit float.
fn c<F: Float>(x: f64) -> F {
    F::from(x).unwrap_or_else(F::zero)
}

impl<F: Float> Rest<F> {
    /// Of a fragment at depth `zeta`, given the pixel's statistics and the moments `m` of the rest.
    pub fn new(s: &Statistics<F>, m: &[F; 5], zeta: F) -> Self {
        let (one, two) = (F::one(), c::<F>(2.0));
        let level = two / c(f64::from(DEPTH_CODES - 1));
        let extent = (s.farthest - s.nearest).max(level);
        let total = m[0].max(s.moments[0] * c(NOISE)).max(c(1e-6));
        // Moments over the pixel's range as −1 … 1: of (ζ − middle)·scale.
        let middle = (s.nearest + s.farthest) / two;
        let scale = two / extent;
        let [m1, m2, m3, m4] = [m[1] / total, m[2] / total, m[3] / total, m[4] / total];
        let x1 = ((m1 - middle) * scale).max(-one).min(one);
        let x2 = (m2 - middle * (two * m1 - middle)) * scale.powi(2);
        let x3 = (m3 - middle * (c::<F>(3.0) * m2 - middle * (c::<F>(3.0) * m1 - middle)))
            * scale.powi(3);
        let x4 = {
            let inner = c::<F>(6.0) * m2 - middle * (c::<F>(4.0) * m1 - middle);
            (m4 - middle * (c::<F>(4.0) * m3 - middle * inner)) * scale.powi(4)
        };
        let power = |mean: F| mean.max(c(-POWER_MAX)).min(c(POWER_MAX));
        Self {
            absorbance: m[0],
            place: ((zeta - middle) * scale).max(-one).min(one),
            means: [x1, power(x2), power(x3), power(x4)],
            bias: (c::<F>(BIAS) + c::<F>(BIAS_BY_SCALE) * scale.powi(4)).min(c(BIAS_MAX)),
        }
    }

    /// `√m_0`.
    pub fn root_absorbance(&self) -> F {
        self.absorbance.sqrt()
    }

    /// Where in the pixel's range the fragment lies, 0 … 1.
    pub fn depth_fraction(&self) -> F {
        (self.place + F::one()) / c(2.0)
    }

    /// Where the rest's mean lies, 0 … 1.
    pub fn mean_fraction(&self) -> F {
        (self.means[0] + F::one()) / c(2.0)
    }

    /// The least and the most of the rest's absorbance that can lie in front of the fragment, as shares, given four moments
    /// (Münstermann et al. 2018, §3.2; overestimation 0 and 1).
    pub fn moment_bounds(&self) -> (F, F) {
        clamped(four_moment_bounds(self.means, self.bias, self.place))
    }
}

/// Both shares in 0 … 1; NaN, where the points of a bound coincide, becomes 0.
fn clamped<F: Float>((low, high): (F, F)) -> (F, F) {
    let clamp = |share: F| share.max(F::zero()).min(F::one());
    (clamp(low), clamp(high))
}

const MOMENT_BOUNDS: Shared = Shared {
    name: "bounds",
    wgsl: "peelnet_moment_bounds(rest)",
    module: Some("learned::moment_bounds"),
};

/// All features of the rest, which the recipes of anchored networks read.
pub static FEATURES: [&Feature<Rest<f64>>; 5] = [
    &Feature::new(
        "root_absorbance",
        "root of the rest's absorbance",
        "rest.root_absorbance",
        Rest::root_absorbance,
    ),
    &Feature::new(
        "depth_fraction",
        "of the pixel's depth range",
        "0.5 * rest.place + 0.5",
        Rest::depth_fraction,
    ),
    &Feature::new(
        "mean_fraction",
        "of the pixel's depth range",
        "0.5 * rest.means.x + 0.5",
        Rest::mean_fraction,
    ),
    &Feature::new(
        "share_low",
        "of the rest's absorbance",
        "bounds.x",
        |rest: &Rest<f64>| rest.moment_bounds().0,
    )
    .sharing(&MOMENT_BOUNDS),
    &Feature::new(
        "share_high",
        "of the rest's absorbance",
        "bounds.y",
        |rest: &Rest<f64>| rest.moment_bounds().1,
    )
    .sharing(&MOMENT_BOUNDS),
];

/// The values of all [`FEATURES`].
pub fn all(rest: &Rest<f64>) -> Vec<f64> {
    FEATURES
        .iter()
        .map(|feature| (feature.value)(rest))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distributions of a few points on −1 … 1: the share in front of any x lies within both bounds.
    #[test]
    fn bounds_hold() {
        let mut random = crate::random::Random::new(5, &[]);
        for _ in 0..2000 {
            let n = 3 + random.below(6);
            let points: Vec<(f64, f64)> = (0..n)
                .map(|_| {
                    (
                        f64::from(random.between(-1.0, 1.0)),
                        0.05 + f64::from(random.unit()),
                    )
                })
                .collect();
            let total: f64 = points.iter().map(|p| p.1).sum();
            let moment = |k: i32| points.iter().map(|p| p.1 * p.0.powi(k)).sum::<f64>() / total;
            let m = [moment(1), moment(2), moment(3), moment(4)];
            let x = f64::from(random.between(-0.96, 0.96));
            let share = points.iter().filter(|p| p.0 < x).map(|p| p.1).sum::<f64>() / total;
            // The bias gives way by up to its square root times a few.
            let (low, high) = clamped(four_moment_bounds(m, BIAS, x));
            let slack = 4.0 * BIAS.sqrt();
            assert!(
                low <= share + slack && share <= high + slack,
                "{low} {share} {high}"
            );
        }
    }

    /// The 32-bit features follow the 64-bit ones. Mean powers err by a few roundings (2⁻²⁴) of values ≤ 1; moving them to the
    /// pixel's range multiplies by up to its inverse (here 10, as the range is at least a tenth of the frame's).
    #[test]
    fn both_precisions_agree() {
        let mut stream = crate::random::Random::new(9, &[]);
        let mut random = move || f64::from(stream.unit());
        for _ in 0..500 {
            let n = 2 + (random() * 20.0) as usize;
            let (centre, width) = (random() - 0.5, 0.1 + 0.4 * random());
            let points: Vec<(f64, f64)> = (0..n)
                .map(|_| {
                    (
                        0.02 + 3.0 * random(),
                        centre + width * (2.0 * random() - 1.0),
                    )
                })
                .collect();
            let wide = Statistics::of(points.iter().copied());
            let narrow = Statistics::of(points.iter().map(|&(b, z)| (b as f32, z as f32)));
            for &(b, z) in &points {
                let m = wide.without(&[(b, z)]);
                let (b32, z32) = (b as f32, z as f32);
                let a = Rest::new(&wide, &m, z);
                let c = Rest::new(&narrow, &narrow.without(&[(b32, z32)]), z32);
                for (a, c) in [
                    (a.root_absorbance(), c.root_absorbance()),
                    (a.depth_fraction(), c.depth_fraction()),
                    (a.mean_fraction(), c.mean_fraction()),
                ] {
                    let roundings = 4.0 / f64::from(1 << 24);
                    let width = f64::from(narrow.farthest - narrow.nearest) / 2.0;
                    let tolerance = roundings / width * 8.0;
                    let noisy = m[0] < 0.1 * wide.moments[0];
                    assert!(noisy || (a - f64::from(c)).abs() < tolerance, "{a} {c}");
                }
            }
        }
    }
}
