//! What networks read of a fragment between its slab's known ends. All inputs are free of scale and unit.

use super::Between;
use crate::features::Feature;

/// Keeps a share of two absorbances that are both 0 finite.
const FLOOR: f64 = 1e-6;

/// How much lies between a slab's ends, where the fragment lies, what is known of the share in front, how far apart the ends are, and how
/// the absorbances compare.
pub static NINE: [&Feature<Between>; 9] = [
    &Feature::new(
        "root_absorbance",
        "root of the absorbance between the slab's ends",
        "sqrt(between.absorbance)",
        |between| between.absorbance.sqrt(),
    ),
    &Feature::new(
        "depth_fraction",
        "of the depth between the slab's ends",
        "between.place",
        |between| between.place,
    ),
    &Feature::new(
        "mean_fraction",
        "of the depth between the slab's ends",
        "between.mean",
        |between| between.mean,
    ),
    &Feature::new(
        "share_low",
        "of the absorbance between the slab's ends",
        "between.low",
        |between| between.bounds[0],
    ),
    &Feature::new(
        "share_high",
        "of the absorbance between the slab's ends",
        "between.high",
        |between| between.bounds[1],
    ),
    &Feature::new(
        "root_own",
        "root of the fragment's absorbance",
        "sqrt(between.own)",
        |between| between.own.sqrt(),
    ),
    &Feature::new(
        "half_extent",
        "half of the depth between the slab's ends, in slabs",
        "between.extent",
        |between| between.extent,
    ),
    &Feature::new(
        "of_own",
        "absorbance between the ends, of that and the fragment's",
        "between.absorbance / (between.absorbance + between.own + 1e-6)",
        |between| between.absorbance / (between.absorbance + between.own + FLOOR),
    ),
    &Feature::new(
        "of_nearest",
        "absorbance between the ends, of that and the nearer end's",
        "between.absorbance / (between.absorbance + between.nearest + 1e-6)",
        |between| between.absorbance / (between.absorbance + between.nearest + FLOOR),
    ),
];

/// The first five of them.
pub static FIVE: [&Feature<Between>; 5] = [NINE[0], NINE[1], NINE[2], NINE[3], NINE[4]];
