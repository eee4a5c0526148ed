//! What tests and `peelnet stress` expect of the methods in this folder.

use super::reference;
use crate::methods::expected::*;

pub(super) const METHOD: Expectations = Expectations {
    reference: Some(|_, p| Some(reference::composite(p.fragments, p.background))),
    known_failures: &[
        KnownFailure::new(
            Property::Background,
            "alpha-zero alpha-one coplanar emissive far grazing intersecting moving-camera passing",
            "covers as layers of the mean opacity would, not as those that are there (Bavoil & Myers 2008)",
        ),
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::BLIND,
    ],
    ..Expectations::DEFAULT
};
