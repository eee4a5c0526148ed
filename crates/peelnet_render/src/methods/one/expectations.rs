use super::reference;
use crate::methods::prelude::*;

const COINCIDENT: KnownFailure = KnownFailure::new(
    Property::Hull,
    "coplanar thin-slab",
    "of layers that coincide, or lie in one of 480 bins of depth, the nearest is kept as the largest of each channel, a colour that none has",
);

const STEPS: KnownFailure = KnownFailure::new(
    Property::Opaque,
    "alpha-near-one",
    "the nearest fragment's colour is kept in 128 steps of a root: bright ones err by two steps of an 8-bit display",
);

const HIDING: KnownFailure =
    KnownFailure::lines("of the layers behind the nearest, which hides which is guessed from sums");

const OTHER_NEAREST: KnownFailure = KnownFailure::new(
    Property::Scale,
    "thin-slab",
    "depths are rounded otherwise, and of layers that differ by a few roundings another is the nearest",
);

const BEHIND_COINCIDENT: KnownFailure = KnownFailure::new(
    Property::Transmittance,
    "coplanar",
    "of sixteen coincident layers one is the nearest, and where the others lie is known as well as a sum knows it",
);

pub(super) const ONE: Expectations = Expectations {
    guarantees: |_| Guarantees {
        noisy: true,
        nearest_in_steps: true,
        rounds_fragments: true,
        ..Guarantees::TINTED
    },
    reference: Some(reference::composite),
    estimate: Some(reference::transmittances),
    known_failures: &[
        COINCIDENT,
        STEPS,
        HIDING,
        OTHER_NEAREST,
        BEHIND_COINCIDENT,
        KnownFailure::new(
            Property::Hull,
            "deep",
            "colour and absorbance of a thousand layers are rounded a thousand times each, to half floats",
        ),
    ],
};

pub(super) const WIDE: Expectations = Expectations {
    known_failures: &[
        COINCIDENT,
        STEPS,
        HIDING,
        OTHER_NEAREST,
        BEHIND_COINCIDENT,
        KnownFailure::new(
            Property::Order,
            "apart passing",
            "sums in half floats that were added in another order move the quantiles of the next frame by a step",
        )
        .when(super::from_last),
    ],
    ..ONE
};
