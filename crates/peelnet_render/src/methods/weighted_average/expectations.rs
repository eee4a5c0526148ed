use super::reference;
use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    reference: Some(|_, p| Some(reference::composite(p.fragments, p.background))),
    known_failures: &[
        KnownFailure::new(
            Property::Background,
            "apart alpha-zero alpha-one coplanar emissive far grazing intersecting lines moving-camera passing",
            "covers as layers of the mean opacity would, not as those that are there (Bavoil & Myers 2008)",
        ),
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::reordered("lines"),
        KnownFailure::BLIND,
    ],
    ..Expectations::DEFAULT
};
