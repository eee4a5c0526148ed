use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    known_failures: &[
        KnownFailure::new(
            Property::Hull,
            "deep",
            "colour and weights of a thousand layers are rounded a thousand times each, to half floats",
        ),
        KnownFailure::unsettled(Property::Order, "near-overflow lines").elsewhere(),
        KnownFailure::new(
            Property::Scale,
            "passing",
            "depths are rounded otherwise, and a layer at the border of two bins falls into the other one",
        )
        .elsewhere(),
    ],
    ..Expectations::DEFAULT
};
