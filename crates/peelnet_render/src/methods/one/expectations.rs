use super::{is_framed, reference};
use crate::methods::prelude::*;

pub(super) const ONE: Expectations = Expectations {
    guarantees: |spec| Guarantees {
        per_pixel: is_framed(spec),
        // The nearest fragment's steps are hidden by noise.
        noisy: true,
        rounds_fragments: true,
        ..Guarantees::TINTED
    },
    reference: Some(reference::composite),
    estimate: Some(reference::transmittances),
    known_failures: &[
        KnownFailure::new(
            Property::Scale,
            "thin-slab",
            "depths are rounded otherwise, and of layers that differ by a few roundings another is the nearest",
        ),
        KnownFailure::new(
            Property::Transmittance,
            "coplanar",
            "of sixteen coincident layers one is the nearest, and where the others lie is known as well as a sum knows it",
        ),
    ],
};
