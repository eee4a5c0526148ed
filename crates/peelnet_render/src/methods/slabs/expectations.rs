use super::{KEEP, RANGE, reference};
use crate::methods::prelude::*;

fn is_small(spec: &MethodSpec) -> bool {
    KEEP.word(spec) == "small"
}

fn is_of_tiles(spec: &MethodSpec) -> bool {
    RANGE.word(spec) == "tiles"
}

pub(super) const SLABS: Expectations = Expectations {
    guarantees: |spec| Guarantees {
        apart: is_of_tiles(spec),
        ..Guarantees::TINTED
    },
    reference: Some(reference::composite),
    estimate: Some(reference::transmittances),
    ..Expectations::DEFAULT
};

const BORDERS: KnownFailure = KnownFailure::new(
    Property::Steady,
    "moving-camera",
    "what lies between a slab's known ends is guessed, and where a layer passes a slab's border it is another guess, or none",
);

const ROUNDED_OTHERWISE: KnownFailure = KnownFailure::new(
    Property::Scale,
    "thin-slab",
    "depths are rounded otherwise, and of layers that differ by a few roundings another is the nearest",
);

const COINCIDENT: KnownFailure = KnownFailure::new(
    Property::Transmittance,
    "coplanar",
    "sixteen coincident layers are a slab's nearest all at once, and without its farthest what lies behind them is guessed",
);

/// Hundreds of layers of a frame's slabs; quantiles part them.
const SWALLOWED: KnownFailure = KnownFailure::swallowed("deep").when(|s| !is_of_tiles(s));

const FEW_PIXELS: KnownFailure = KnownFailure::new(
    Property::Apart,
    "apart",
    "in a frame of a few pixels one of them says where the layers of all lie",
);

pub(super) const METHOD: Expectations = SLABS.failing(&[
    KnownFailure::swallowed("deep"),
    KnownFailure::reordered("deep").when(|s| !is_of_tiles(s) || KEEP.word(s) != "large"),
    BORDERS.when(is_of_tiles),
    COINCIDENT.when(is_small),
    FEW_PIXELS.when(is_of_tiles),
]);

pub(super) const SMALL: Expectations = SLABS.failing(&[
    ROUNDED_OTHERWISE.when(is_of_tiles),
    KnownFailure::unsettled(Property::Order, "near-overflow").when(is_of_tiles),
    FEW_PIXELS.when(is_of_tiles),
]);

pub(super) const MEDIUM: Expectations = SLABS.failing(&[
    SWALLOWED,
    BORDERS.when(is_of_tiles),
    ROUNDED_OTHERWISE.when(is_of_tiles),
]);

pub(super) const LARGE: Expectations = SLABS.failing(&[SWALLOWED, BORDERS.when(is_of_tiles)]);
