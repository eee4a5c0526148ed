use crate::methods::{learned::learned_transmittances, prelude::*};
use peelnet_core::methods::anchored;
use peelnet_model::inputs::{ANCHORED as FEATURES, AnchoredInputs};

pub(super) const ANCHORED: Expectations = Expectations {
    guarantees: |_| Guarantees {
        root: Some(2),
        close_estimate: true,
        ..Guarantees::TINTED
    },
    reference: Some(|_, p| {
        let model = p.model?;
        let inputs = model.meta.recipe.inputs.downcast::<AnchoredInputs>()?;
        let (fragments, c0) = (p.fragments, p.background);
        let (apart, share) = (inputs.separate_extremes, |rest: &_| {
            model.answer(&FEATURES, rest)
        });
        Some(anchored::composite(fragments, c0, &p.warp, apart, share))
    }),
    estimate: Some(learned_transmittances),
    ..Expectations::DEFAULT
};

/// Crossing and many layers, where what is left of a sum without the fragment's own share and the ends is a small part of it.
const UNSETTLED: KnownFailure = KnownFailure::unsettled(
    Property::Order,
    "apart high-alpha intersecting lines moving-camera",
);

const HIDING: KnownFailure = KnownFailure::lines(
    "which of the layers between the ends hides others is guessed from moments",
);

const BEHIND_COINCIDENT: KnownFailure = KnownFailure::new(
    Property::Transmittance,
    "coplanar",
    "the network's own error at a layer between sixteen coincident ones and the end, up to 0.010; where the sixteen stand before one, it is exact",
);

const ROUNDED_OTHERWISE: KnownFailure = KnownFailure::new(
    Property::Scale,
    "high-alpha",
    "depths are rounded otherwise, and a sum in half floats falls on the other side of a rounding (docs/learned-weights.md)",
)
.when(half_sums);

/// Depths that are rounded otherwise, and sums in 32 bits.
const MAGNIFIED_AT_SCALE: KnownFailure = KnownFailure::new(
    Property::Scale,
    "lines",
    "next to nothing passes a line: what is left of moments behind it magnifies roundings of depth",
)
.when(|s| !half_sums(s));

pub(super) const SMALL: Expectations = ANCHORED.failing(&[
    KnownFailure::swallowed("deep"),
    ROUNDED_OTHERWISE,
    UNSETTLED,
    BEHIND_COINCIDENT,
    HIDING,
    MAGNIFIED_AT_SCALE,
    MAGNIFIED_AT_SCALE.when(half_sums).elsewhere(),
    KnownFailure::unsettled(Property::Order, "grazing").elsewhere(),
    KnownFailure::MAGNIFIED,
]);

pub(super) const MEDIUM: Expectations = ANCHORED.failing(&[
    KnownFailure::swallowed("deep").elsewhere(),
    ROUNDED_OTHERWISE,
    UNSETTLED,
    KnownFailure::unsettled(Property::Order, "deep"),
    BEHIND_COINCIDENT,
    HIDING,
    KnownFailure::new(
        Property::Order,
        "lines",
        "sums in 32 bits of layers that hide all, of which every order has other roundings",
    )
    .when(|s| !half_sums(s)),
]);
