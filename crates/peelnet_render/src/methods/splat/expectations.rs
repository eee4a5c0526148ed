use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    known_failures: &[
        KnownFailure::new(
            Property::Background,
            "high-alpha deep wide-range apart lines",
            "what lies behind the depth at which 1/255 of the light is left is not drawn, and its coverage is missing",
        ),
        KnownFailure::unsettled(Property::Order, "near-overflow wide-range lines"),
        KnownFailure::new(
            Property::Scale,
            "passing",
            "depths are rounded otherwise, and a layer at the border of two bins falls into the other one",
        )
        .elsewhere(),
    ],
    ..Expectations::DEFAULT
};
