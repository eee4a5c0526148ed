//! `nmt`: four raw moments of a pixel, and a depth. Whole pixels are examples.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::methods::{known::KnownFragment, nmt::FragmentMoments};

/// The inputs of the network, in the published order: depth, the number of fragments, `b_0`, and `b_1 … b_4`.
pub static NMT: [&Feature<FragmentMoments>; 7] = [
    &Feature::new(
        "depth",
        "exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment",
        "peelnet_depth(zeta, extent)",
        FragmentMoments::depth,
    ),
    &Feature::new("fragment_count", "1", "totals.y", |f| f.count as f64),
    &Feature::new("absorbance", "1", "totals.x", |f| f.moments[0]),
    &Feature::new("moment_1", "1", "moments.x", |f| f.moments[1]),
    &Feature::new("moment_2", "1", "moments.y", |f| f.moments[2]),
    &Feature::new("moment_3", "1", "moments.z", |f| f.moments[3]),
    &Feature::new("moment_4", "1", "moments.w", |f| f.moments[4]),
];

/// The moments of a pixel and a depth.
#[derive(Debug)]
pub struct NmtInputs;

impl NetworkInputs for NmtInputs {
    fn features(&self) -> Vec<&'static About> {
        about(&NMT)
    }

    fn surroundings(&self) -> &'static Surroundings {
        &SURROUNDINGS
    }

    fn transmittances(&self, pixel: &Observed<'_>, network: Forward<'_>) -> Vec<f64> {
        let all = FragmentMoments::all(pixel.fragments, &pixel.warp).into_iter();
        let inputs = all.map(|fragment| values(&NMT, &fragment));
        inputs.map(|inputs| network(&inputs)).collect()
    }

    fn examples(&self, pixel: &PeeledPixel<'_>) -> Examples {
        let all = FragmentMoments::all(pixel.observed.fragments, &pixel.observed.warp);
        let fragments = all.iter().map(|fragment| KnownFragment {
            unknown: Some(values(&NMT, fragment)),
            ..KnownFragment::known(0.0)
        });
        Examples::Pixel(fragments.collect())
    }
}

static SURROUNDINGS: Surroundings = Surroundings {
    parameters: "zeta: f32, extent: vec2f, totals: vec4f, moments: vec4f",
    modules: &[
        "learned::zeta",
        "learned::absorbance",
        "learned::nmt",
        "learned::resolve",
        "learned::composite",
    ],
    before: ZETA,
    around: None,
    passes: PASSES,
    resolve: "peelnet_resolve(sums, totals.x, background)",
};

const WHOLE: &str = "rgba32float";

const PASSES: &[Pass] = &[
    pass(
        "statistics",
        &[],
        statistics("peelnet_statistics(alpha, zeta)"),
        &[
            sum("totals", WHOLE, "s.totals"),
            sum("moments", WHOLE, "s.moments"),
            most("extent", "rg32float", LEAST, "s.extent"),
        ],
    ),
    pass(
        "weights",
        &["totals", "moments", "extent"],
        weight("peelnet_fragment(zeta, totals, moments, extent)"),
        &[sum("sums", WHOLE, WEIGHTED)],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::absorbance::DepthWarp;

    /// Of a range 1 … e², ζ = ln z − 1.
    fn inputs(points: &[(f32, f32)]) -> Vec<[f64; 7]> {
        let warp = DepthWarp::new(1.0, 2f64.exp());
        let all = FragmentMoments::all(points, &warp).into_iter();
        all.map(|fragment| NMT.map(|f| (f.value)(&fragment)))
            .collect()
    }

    /// 32-bit depths and opacities.
    fn close(got: [f64; 7], want: [f64; 7]) {
        for (a, b) in got.iter().zip(&want) {
            assert!((a - b).abs() < 1e-6, "{got:?} {want:?}");
        }
    }

    /// Two fragments of α = ½ and ¾ at ζ = −½ and 1, one between them at ζ = ½: b = ln 2, ln 4 and 0. The middle one's depth is
    /// `(e^½ − 1)/(e^¾ − 1)`.
    #[test]
    fn known_fragments_have_known_inputs() {
        let (a, b) = (0.5f32.exp(), 2f32.exp());
        let middle = 1.5f32.exp();
        let ln2 = 2f64.ln();
        let [b1, b2, b3, b4] = [-0.5, 0.25, -0.125, 0.0625].map(|power| (power + 2.0) * ln2);
        let with = |depth: f64| [depth, 3.0, 3.0 * ln2, b1, b2, b3, b4];
        let got = inputs(&[(b, 0.75), (middle, 0.0), (a, 0.5)]);
        close(got[0], with(1.0));
        close(got[1], with((0.5f64.exp() - 1.0) / (0.75f64.exp() - 1.0)));
        close(got[2], with(0.0));
    }

    /// A pixel without an extent has the depth 0, and opaque fragments an absorbance of 10.
    #[test]
    fn single_and_opaque_fragments_are_finite() {
        let got = inputs(&[(1f32.exp(), 1.0)]);
        close(got[0], [0.0, 1.0, 10.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
