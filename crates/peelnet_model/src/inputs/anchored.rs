//! `deep-anchored-*`: the rest of a pixel, seen from a fragment. Whole pixels are examples.
//!
//! A network that is asked about a fragment reads what a first pass knows of the fragment's pixel: the fragment's *own share* is taken out of
//! the pixel's moments, and the shares of the two ends, which are known; the network is asked where the rest lies. What lies in front of a
//! fragment does not depend on the fragment. All features of the rest are free of scene scale and unit.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::methods::{
    anchored::{self, Residual},
    known::KnownFragment,
};

const MOMENT_BOUNDS: Shared = Shared {
    name: "bounds",
    wgsl: "peelnet_moment_bounds(rest)",
    module: Some("learned::moment_bounds"),
};

const fn share(
    name: &'static str,
    wgsl: &'static str,
    value: fn(&Residual) -> f64,
) -> Feature<Residual> {
    Feature::new(name, "of the rest's absorbance", wgsl, value).sharing(&MOMENT_BOUNDS)
}

/// All features of the rest. The first must be the root of its absorbance.
pub static ANCHORED: [&Feature<Residual>; 5] = [
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
    &share("share_low", "bounds.x", |rest| rest.moment_bounds()[0]),
    &share("share_high", "bounds.y", |rest| rest.moment_bounds()[1]),
];

/// The rest of a pixel.
#[derive(Debug)]
pub struct AnchoredInputs {
    /// Whether the nearest and the farthest fragment accumulate apart.
    pub separate_extremes: bool,
}

impl NetworkInputs for AnchoredInputs {
    fn features(&self) -> Vec<&'static About> {
        about(&ANCHORED)
    }

    fn surroundings(&self) -> &'static Surroundings {
        if self.separate_extremes {
            &SEPARATE_EXTREMES
        } else {
            &ONE_SUM
        }
    }

    fn known(&self, pixel: &Observed<'_>) -> Vec<KnownFragment<Vec<f64>>> {
        let known = anchored::known_fragments(pixel.fragments, &pixel.warp, pixel.precision);
        let read = |f: KnownFragment<_>| f.map(|residual| values(&ANCHORED, residual));
        known.into_iter().map(read).collect()
    }

    fn known_apart(&self) -> bool {
        self.separate_extremes
    }
}

static ONE_SUM: Surroundings = Surroundings {
    parameters: "rest: PeelnetRest",
    modules: &[
        "learned::zeta",
        "learned::absorbance",
        "learned::levels",
        "learned::anchored",
        "learned::anchored_fragment",
        "learned::resolve",
        "learned::composite",
    ],
    before: ZETA,
    around: None,
    passes: &[
        STATISTICS,
        pass(
            "weights",
            &["moments", "extent"],
            weight("peelnet_fragment(alpha, zeta, moments, extent).x"),
            SUMS,
        ),
    ],
    resolve: "peelnet_resolve(sums, moments.x, background)",
};

static SEPARATE_EXTREMES: Surroundings = Surroundings {
    modules: &[
        "learned::zeta",
        "learned::absorbance",
        "learned::levels",
        "learned::anchored",
        "learned::anchored_fragment",
        "learned::resolve_separate_ends",
    ],
    passes: &[
        STATISTICS,
        pass(
            "weights",
            &["moments", "extent"],
            value(
                "f",
                ValueKind::Pair,
                "peelnet_fragment(alpha, zeta, moments, extent)",
            ),
            &[sum("sums", HALF, INTERIOR), sum("ends", HALF, EXTREMES)],
        ),
    ],
    resolve: "peelnet_resolve(sums, ends, moments.x, background)",
    ..ONE_SUM
};

const STATISTICS: Pass = pass(
    "statistics",
    &[],
    statistics("peelnet_statistics(alpha, zeta)"),
    &[
        sum("moments", HALF, "s.moments"),
        most_and_sum("extent", "s.extent"),
    ],
);

const INTERIOR: &str = "vec4f(alpha * rgb, alpha) * (f.x * (1.0 - min(f.y, 1.0)))";

const EXTREMES: &str = "vec4f(alpha * rgb, alpha) * (f.x * min(f.y, 1.0))";
