use super::reference;
use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        normalised: false,
        ..Guarantees::NORMALISED
    },
    reference: Some(|_, p| Some(reference::composite(p.fragments, p.background))),
    known_failures: &[
        KnownFailure::reordered("deep near-overflow apart"),
        KnownFailure::new(
            Property::Background,
            "apart alpha-zero alpha-tiny alpha-one alpha-near-one high-alpha deep near-overflow far wide-range \
             coplanar thin-slab two-layers intersecting lines grazing emissive opaque-mix moving-camera passing",
            "covers by the sum of opacities, which may exceed 1 (Meshkin 2007)",
        ),
        KnownFailure::new(
            Property::Dark,
            "alpha-one alpha-near-one high-alpha coplanar intersecting lines",
            "takes more of C_0 than there is where opacities add up to more than 1 (Meshkin 2007)",
        ),
        KnownFailure::BLIND,
    ],
    ..Expectations::DEFAULT
};
