use super::reference;
use crate::methods::prelude::*;

pub(super) const SLABS: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    reference: Some(reference::composite),
    estimate: Some(reference::transmittances),
    ..Expectations::DEFAULT
};

const BORDERS: KnownFailure = KnownFailure::new(
    Property::Steady,
    "moving-camera",
    "what lies between a slab's known ends is guessed, and where a layer passes a slab's border it is another guess, or none",
);

const HIDING: KnownFailure = KnownFailure::lines(
    "what lies between a slab's known ends is guessed, also where one of those layers hides what is behind it",
);

const ROUNDED_OTHERWISE: KnownFailure = KnownFailure::new(
    Property::Scale,
    "thin-slab",
    "depths are rounded otherwise, and of layers that differ by a few roundings another is the nearest",
);

const SWALLOWED: KnownFailure = KnownFailure::swallowed("deep");

pub(super) const METHOD: Expectations = SLABS.failing(&[SWALLOWED, BORDERS, HIDING]);

pub(super) const SMALL: Expectations = SLABS.failing(&[
    SWALLOWED,
    ROUNDED_OTHERWISE,
    KnownFailure::unsettled(Property::Order, "near-overflow"),
]);

pub(super) const MEDIUM: Expectations = SLABS.failing(&[BORDERS, ROUNDED_OTHERWISE, HIDING]);

pub(super) const LARGE: Expectations = SLABS.failing(&[SWALLOWED, BORDERS, HIDING]);
