use super::{reference, tail};
use crate::methods::{prelude::*, stored_colors};

/// Few enough places that tails of hundreds of fragments are left in the stress cases.
fn long_tails(spec: &MethodSpec) -> bool {
    spec.number() <= 8 && half_sums(spec)
}

const TOO_FEW_PLACES: KnownFailure = KnownFailure::coincident(
    "of more coincident fragments than places, those that arrive first are kept: places are ordered by depth in one atomic word, and portable WebGPU has no atomics of 64 bits, which the triangle would need beside it",
)
.when(|s| s.number() < 16);

const fn arriving(property: Property) -> KnownFailure {
    let reason = "of more coincident fragments than places, those that arrive first are kept, and on a GPU they arrive in no certain order";
    KnownFailure::new(property, "coplanar", reason)
        .when(|s| s.number() < 16)
        .elsewhere()
}

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| stored_colors::guarantees(s, Guarantees::NORMALISED),
    reference: Some(|s, p| {
        let (fragments, c0, places) = (p.fragments, p.background, s.number() as usize);
        let (weight, colors) = (tail(s).0, stored_colors::colors(s));
        Some(reference::composite(fragments, c0, places, weight, colors))
    }),
    ..Expectations::DEFAULT
};

const BACKGROUND: KnownFailure = stored_colors::in_bytes(
    Property::Background,
    "alpha-zero coplanar emissive far grazing intersecting isolated lines moving-camera opaque-mix thin-slab \
     two-layers wide-range",
);

/// Of eight places, all of ten faint layers but two are in bytes.
const FAINT: KnownFailure = stored_colors::in_bytes(Property::Background, "alpha-tiny")
    .when(|s| s.number() == 8 && stored_colors::are_bytes(s));

const SINGLE: KnownFailure = stored_colors::in_bytes(Property::Single, "emissive grazing");

pub(super) const PLAIN: Expectations = METHOD.failing(&[
    TOO_FEW_PLACES,
    arriving(Property::Scale),
    arriving(Property::Image),
    KnownFailure::swallowed("alpha-tiny deep").when(long_tails),
    BACKGROUND,
    FAINT,
    stored_colors::in_bytes(
        Property::Hull,
        "coplanar emissive grazing intersecting moving-camera near-overflow",
    ),
    SINGLE,
    KnownFailure::lines("of layers beyond the places, which one hides others is not known")
        .when(|s| s.number() <= 4),
]);

pub(super) const HYBRID: Expectations = METHOD.failing(&[
    TOO_FEW_PLACES,
    arriving(Property::Scale),
    arriving(Property::Image),
    KnownFailure::in_scene_units("apart coplanar wide-range"),
    KnownFailure::in_scene_units("alpha-tiny deep near-overflow").when(long_tails),
    KnownFailure::swallowed("deep").when(long_tails),
    KnownFailure::reordered("deep").when(long_tails),
    KnownFailure::overflowing("near-overflow").when(long_tails),
    BACKGROUND,
    FAINT,
    stored_colors::in_bytes(
        Property::Hull,
        "alpha-tiny coplanar emissive grazing intersecting moving-camera",
    ),
    SINGLE,
]);
