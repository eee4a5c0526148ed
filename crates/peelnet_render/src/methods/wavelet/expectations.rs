use super::{reference, settings};
use crate::methods::{bins::range::Bounds, prelude::*};

fn of_frame(spec: &MethodSpec) -> bool {
    settings(spec).bounds == Bounds::Frame
}

const fn own_share_in(property: Property, cases: &'static str) -> KnownFailure {
    let reason =
        "a fragment's own absorbance counts by its place in its bin; own=out leaves it out";
    KnownFailure::new(property, cases, reason).when(|s| of_frame(s) && !settings(s).own_share_out)
}

pub(super) const METHOD: Expectations = Expectations {
    reference: Some(weighted_reference),
    estimate: Some(|s, fragments, warp, _| {
        Some(reference::transmittances(fragments, warp, &settings(s)))
    }),
    known_failures: &[
        KnownFailure::swallowed("deep"),
        KnownFailure::unsettled(Property::Order, "deep near-overflow"),
        KnownFailure::new(
            Property::Transmittance,
            "two-layers",
            "rank 3 separates eight depths (Aizenshtein et al. 2022)",
        )
        .when(|s| of_frame(s) && settings(s).own_share_out),
        KnownFailure::translucent(
            "eight bins over the whole frame's depth blur what lies close together",
        )
        .when(|s| of_frame(s) && s.number() == 2),
        KnownFailure::lines("rank 3 separates eight depths of the frame (Aizenshtein et al. 2022)")
            .when(|s| of_frame(s) && s.number() > 2 && settings(s).own_share_out),
        own_share_in(Property::Transmittance, "isolated two-layers"),
        own_share_in(Property::Opaque, "alpha-near-one lines"),
    ],
    ..Expectations::DEFAULT
};
