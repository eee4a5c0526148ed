use super::{OVERESTIMATION, own_out, published, settings};
use crate::methods::prelude::*;
use peelnet_core::methods::moments::{self, Basis};

/// Of n power moments roots of a polynomial of degree n / 2 are taken, of n trigonometric ones of degree n.
fn guarantees(spec: &MethodSpec) -> Guarantees {
    let root = match published(spec).0.basis {
        Basis::Power(n) => n / 2,
        Basis::Trigonometric(n) => n,
    };
    Guarantees {
        own_share: if own_out(spec) {
            0.0
        } else {
            OVERESTIMATION.number(spec)
        },
        statistics: Precision::Full,
        root: Some(root as u32),
        ..Guarantees::TINTED
    }
}

const BLUR: &str = "moments blur what lies close together (Münstermann et al. 2018)";

const BLURRED: KnownFailure = KnownFailure::translucent(BLUR);

const BLURRED_LINES: KnownFailure = KnownFailure::lines(BLUR);

const fn jumping(cases: &'static str) -> KnownFailure {
    let reason =
        "16-bit moments without the paper's quantisation: roots jump where they come close";
    KnownFailure::new(Property::Steady, cases, reason).when(half_statistics)
}

pub(super) const ESTIMATED: Expectations = Expectations {
    guarantees,
    reference: Some(weighted_reference),
    estimate: Some(|s, fragments, warp, _| {
        Some(moments::transmittances(fragments, warp, &settings(s)))
    }),
    ..Expectations::DEFAULT
};

/// Depths that are rounded otherwise at another scale.
const fn magnified(cases: &'static str) -> KnownFailure {
    let reason = "where layers nearly coincide or let next to nothing through, what is made of moments magnifies the roundings of depth";
    KnownFailure::new(Property::Scale, cases, reason)
}

pub(super) const FOUR: Expectations = ESTIMATED.failing(&[
    magnified("high-alpha").when(half_statistics),
    KnownFailure::swallowed("deep near-overflow"),
    BLURRED,
    KnownFailure::new(
        Property::Transmittance,
        "coplanar",
        "moments blur a layer close to sixteen coincident ones: its transmittance is off by 0.13",
    ),
    jumping("passing"),
    KnownFailure::unsettled(Property::Transmittance, "isolated"),
    KnownFailure::unsettled(
        Property::Order,
        "alpha-near-one grazing high-alpha intersecting lines moving-camera passing",
    ),
    KnownFailure::reordered("deep near-overflow"),
    magnified("lines").when(half_statistics).elsewhere(),
]);

pub(super) const SIX: Expectations = ESTIMATED.failing(&[
    magnified("passing"),
    magnified("apart high-alpha").when(half_statistics),
    KnownFailure::swallowed("deep"),
    BLURRED.when(half_statistics),
    BLURRED_LINES,
    jumping("passing moving-camera"),
    KnownFailure::unsettled(Property::Transmittance, "isolated two-layers"),
    KnownFailure::unsettled(
        Property::Order,
        "alpha-near-one apart deep emissive grazing high-alpha intersecting lines moving-camera opaque-mix two-layers passing",
    ),
    KnownFailure::new(
        Property::Order,
        "wide-range",
        "six moments in 32 bits: where points come close, roundings of the sums move the others",
    )
    .when(|s| !half_statistics(s)),
    KnownFailure::new(
        Property::Order,
        "passing",
        "the same, on adapters that add in another order",
    )
    .when(|s| !half_statistics(s))
    .elsewhere(),
    magnified("lines").when(half_statistics).elsewhere(),
    KnownFailure::unsettled(Property::Image, "alpha-near-one opaque-mix").elsewhere(),
]);

pub(super) const EIGHT: Expectations = ESTIMATED.failing(&[
    magnified("apart high-alpha intersecting moving-camera").when(half_statistics),
    KnownFailure::swallowed("deep"),
    KnownFailure::swallowed("near-overflow").when(|s| own_out(s) && half_sums(s)),
    KnownFailure::reordered("deep").when(|s| own_out(s) && half_sums(s) && !half_statistics(s)),
    BLURRED.when(half_statistics),
    BLURRED_LINES,
    jumping("passing moving-camera"),
    KnownFailure::unsettled(Property::Transmittance, "isolated two-layers"),
    KnownFailure::unsettled(
        Property::Order,
        "apart alpha-near-one deep emissive far grazing high-alpha intersecting lines moving-camera near-overflow \
         opaque-mix passing two-layers",
    ),
    magnified("lines passing").when(half_statistics).elsewhere(),
    KnownFailure::unsettled(Property::Image, "emissive far").elsewhere(),
]);

pub(super) const TRIGONOMETRIC: Expectations = ESTIMATED.failing(&[
    magnified("high-alpha intersecting moving-camera").when(|s| s.number() == 3),
    magnified("apart lines passing").when(|s| s.number() == 3 && half_statistics(s)),
    KnownFailure::swallowed("deep near-overflow"),
    KnownFailure::swallowed("alpha-tiny").when(|s| s.number() == 2 && half_statistics(s)),
    BLURRED.when(|s| !own_out(s) && (s.number() != 3 || half_statistics(s))),
    BLURRED_LINES,
    KnownFailure::new(
        Property::Transmittance,
        "two-layers",
        "sines and cosines of close layers in 32 bits: roundings of the sums move the points; a bias of 1e-3 hides it",
    )
    .when(|s| !own_out(s) && !half_statistics(s)),
    KnownFailure::unsettled(
        Property::Order,
        "deep high-alpha intersecting lines moving-camera passing",
    ),
    KnownFailure::unsettled(Property::Order, "apart")
        .when(|s| s.number() == 3 && half_statistics(s)),
    KnownFailure::reordered("near-overflow").when(|s| half_sums(s) && !half_statistics(s)),
    KnownFailure::reordered("deep")
        .when(|s| half_sums(s) && !half_statistics(s))
        .elsewhere(),
    KnownFailure::unsettled(Property::Order, "alpha-near-one emissive").elsewhere(),
    magnified("grazing").when(half_statistics).elsewhere(),
    magnified("two-layers")
        .when(|s| !half_statistics(s))
        .elsewhere(),
]);
