//! What networks read of a fragment between its slab's known ends. All inputs are free of scale and unit.

use super::Between;
use crate::features::Feature;

/// Keeps a share of two absorbances that are both 0 finite.
const FLOOR: f64 = 1e-6;

const OF_DEPTH: &str = "of the depth between the slab's ends";

const OF_ABSORBANCE: &str = "of the absorbance between the slab's ends";

/// How much lies between a slab's ends, where the fragment lies, what is known of the share in front, how far apart the ends are, and how
/// the absorbances compare.
pub static NINE: [&Feature<Between>; 9] = [
    &Feature::new(
        "root_absorbance",
        "root of the absorbance between the slab's ends",
        "sqrt(between.absorbance)",
        |between| between.absorbance.sqrt(),
    ),
    &Feature::new("depth_fraction", OF_DEPTH, "between.place", |b| b.place),
    &Feature::new("mean_fraction", OF_DEPTH, "between.mean", |b| b.mean),
    &Feature::new("share_low", OF_ABSORBANCE, "between.low", |b| b.bounds[0]),
    &Feature::new("share_high", OF_ABSORBANCE, "between.high", |b| b.bounds[1]),
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
