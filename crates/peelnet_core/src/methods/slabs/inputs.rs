//! What networks read of a fragment between its slab's known ends. All inputs are free of scale and unit.

use super::Between;
use crate::features::{About, Feature};

const fn of_between(
    name: &'static str,
    unit: &'static str,
    wgsl: &'static str,
    value: fn(&Between) -> f64,
) -> Feature<Between> {
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

/// Keeps a share of two absorbances that are both 0 finite.
const FLOOR: f64 = 1e-6;

static ROOT_ABSORBANCE: Feature<Between> = of_between(
    "root_absorbance",
    "root of the absorbance between the slab's ends",
    "sqrt(between.absorbance)",
    |between| between.absorbance.sqrt(),
);

static DEPTH_FRACTION: Feature<Between> = of_between(
    "depth_fraction",
    "of the depth between the slab's ends",
    "between.place",
    |between| between.place,
);

static MEAN_FRACTION: Feature<Between> = of_between(
    "mean_fraction",
    "of the depth between the slab's ends",
    "between.mean",
    |between| between.mean,
);

static SHARE_LOW: Feature<Between> = of_between(
    "share_low",
    "of the absorbance between the slab's ends",
    "between.low",
    |between| between.bounds[0],
);

static SHARE_HIGH: Feature<Between> = of_between(
    "share_high",
    "of the absorbance between the slab's ends",
    "between.high",
    |between| between.bounds[1],
);

static ROOT_OWN: Feature<Between> = of_between(
    "root_own",
    "root of the fragment's absorbance",
    "sqrt(between.own)",
    |between| between.own.sqrt(),
);

static HALF_EXTENT: Feature<Between> = of_between(
    "half_extent",
    "half of the depth between the slab's ends, in slabs",
    "between.extent",
    |between| between.extent,
);

static OF_OWN: Feature<Between> = of_between(
    "of_own",
    "absorbance between the ends, of that and the fragment's",
    "between.absorbance / (between.absorbance + between.own + 1e-6)",
    |between| between.absorbance / (between.absorbance + between.own + FLOOR),
);

static OF_NEAREST: Feature<Between> = of_between(
    "of_nearest",
    "absorbance between the ends, of that and the nearer end's",
    "between.absorbance / (between.absorbance + between.nearest + 1e-6)",
    |between| between.absorbance / (between.absorbance + between.nearest + FLOOR),
);

/// How much lies between a slab's ends, where the fragment lies, and what is known of the share in front.
pub static FIVE: [&Feature<Between>; 5] = [
    &ROOT_ABSORBANCE,
    &DEPTH_FRACTION,
    &MEAN_FRACTION,
    &SHARE_LOW,
    &SHARE_HIGH,
];

/// The same, how far apart the ends are, and how the absorbances compare.
pub static NINE: [&Feature<Between>; 9] = [
    &ROOT_ABSORBANCE,
    &DEPTH_FRACTION,
    &MEAN_FRACTION,
    &SHARE_LOW,
    &SHARE_HIGH,
    &ROOT_OWN,
    &HALF_EXTENT,
    &OF_OWN,
    &OF_NEAREST,
];
