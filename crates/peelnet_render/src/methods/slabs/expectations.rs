use super::{KEEP, RANGE, reference};
use crate::methods::prelude::*;

fn is_small(spec: &MethodSpec) -> bool {
    KEEP.word(spec) == "small"
}

fn is_of_pixel(spec: &MethodSpec) -> bool {
    RANGE.word(spec) == "pixel"
}

pub(super) const SLABS: Expectations = Expectations {
    guarantees: |spec| Guarantees {
        apart: is_of_pixel(spec),
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

/// Hundreds of layers of a frame's slabs; a pixel's own scale parts them.
const SWALLOWED: KnownFailure = KnownFailure::swallowed("deep").when(|s| !is_of_pixel(s));

pub(super) const METHOD: Expectations = SLABS.failing(&[
    KnownFailure::swallowed("deep"),
    KnownFailure::reordered("deep").when(|s| !is_of_pixel(s) || KEEP.word(s) != "large"),
    BORDERS.when(is_of_pixel),
    COINCIDENT.when(is_small),
]);

pub(super) const SMALL: Expectations =
    SLABS.failing(&[KnownFailure::swallowed("alpha-tiny").when(is_of_pixel)]);

pub(super) const MEDIUM: Expectations = SLABS.failing(&[
    SWALLOWED,
    BORDERS.when(is_of_pixel),
    ROUNDED_OTHERWISE.when(is_of_pixel),
    KnownFailure::unsettled(Property::Order, "thin-slab").when(is_of_pixel),
]);

pub(super) const LARGE: Expectations = SLABS.failing(&[
    SWALLOWED,
    BORDERS.when(is_of_pixel),
    ROUNDED_OTHERWISE.when(is_of_pixel),
]);
