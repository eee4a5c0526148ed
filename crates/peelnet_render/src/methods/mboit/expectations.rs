//! What tests and `peelnet stress` expect of the methods in this folder.

use super::{OVERESTIMATION, own_out, settings};
use crate::methods::expected::*;
use peelnet_core::methods::moments;

fn guarantees(spec: &MethodSpec, root: u32) -> Guarantees {
    Guarantees {
        own_share: if own_out(spec) {
            0.0
        } else {
            OVERESTIMATION.number(spec)
        },
        statistics: Precision::Full,
        root: Some(root),
        ..Guarantees::TINTED
    }
}

const BLURRED: KnownFailure = KnownFailure::new(
    Property::Opaque,
    "alpha-near-one",
    "moments blur what lies close together (Münstermann et al. 2018)",
);

const BLURRED_BEHIND_COINCIDENT: KnownFailure = KnownFailure::new(
    Property::Transmittance,
    "coplanar",
    "moments blur a layer close to sixteen coincident ones: its transmittance is off by 0.13",
);

const fn jumping(cases: &'static str) -> KnownFailure {
    let reason =
        "16-bit moments without the paper's quantisation: roots jump where they come close";
    KnownFailure::new(Property::Steady, cases, reason)
        .when(half_statistics)
        .seen_on_llvmpipe()
}

pub(super) const ESTIMATED: Expectations = Expectations {
    reference: Some(weighted_reference),
    estimate: Some(|s, fragments, warp, _| {
        Some(moments::transmittances(fragments, warp, &settings(s)))
    }),
    ..Expectations::DEFAULT
};

pub(super) const FOUR: Expectations = Expectations {
    guarantees: |s| guarantees(s, 2),
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        BLURRED,
        BLURRED_BEHIND_COINCIDENT,
        jumping("passing"),
        KnownFailure::unsettled(Property::Transmittance, "isolated"),
        KnownFailure::unsettled(
            Property::Order,
            "alpha-near-one grazing high-alpha intersecting moving-camera passing",
        ),
        KnownFailure::reordered("deep near-overflow"),
    ],
    ..ESTIMATED
};

pub(super) const SIX: Expectations = Expectations {
    guarantees: |s| guarantees(s, 3),
    known_failures: &[
        KnownFailure::swallowed("deep"),
        BLURRED.when(half_statistics).seen_on_llvmpipe(),
        jumping("passing moving-camera"),
        KnownFailure::unsettled(Property::Transmittance, "isolated two-layers"),
        KnownFailure::unsettled(
            Property::Order,
            "deep emissive grazing high-alpha intersecting moving-camera opaque-mix two-layers passing",
        ),
        KnownFailure::new(
            Property::Order,
            "passing wide-range",
            "six moments in 32 bits: where points come close, roundings of the sums move the others",
        )
        .when(|s| !half_statistics(s))
        .seen_on_llvmpipe(),
    ],
    ..ESTIMATED
};

pub(super) const EIGHT: Expectations = Expectations {
    guarantees: |s| guarantees(s, 4),
    known_failures: &[
        KnownFailure::swallowed("deep"),
        KnownFailure::swallowed("near-overflow").when(|s| own_out(s) && half_sums(s)),
        BLURRED.when(half_statistics).seen_on_llvmpipe(),
        jumping("passing moving-camera"),
        KnownFailure::unsettled(Property::Transmittance, "isolated two-layers"),
        KnownFailure::unsettled(
            Property::Order,
            "alpha-near-one deep emissive far grazing high-alpha intersecting moving-camera near-overflow \
             opaque-mix passing two-layers",
        ),
    ],
    ..ESTIMATED
};

pub(super) const TRIGONOMETRIC: Expectations = Expectations {
    guarantees: |s| guarantees(s, s.number()),
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        KnownFailure::swallowed("alpha-tiny").when(|s| s.number() == 2 && half_statistics(s)),
        BLURRED.when(|s| !own_out(s) && (s.number() != 3 || half_statistics(s))),
        KnownFailure::new(
            Property::Transmittance,
            "two-layers",
            "sines and cosines of close layers in 32 bits: roundings of the sums move the points; a bias of 1e-3 hides it",
        )
        .when(|s| !own_out(s) && !half_statistics(s))
        .seen_on_llvmpipe(),
        KnownFailure::new(
            Property::Order,
            "coplanar",
            "sines and cosines of coincident pairs in 32 bits: roundings of the sums move the points",
        )
        .when(|s| !half_statistics(s))
        .seen_on_llvmpipe(),
        KnownFailure::new(
            Property::Order,
            "intersecting moving-camera",
            "roundings of the sums move the points where surfaces cross, in 32 bits as well",
        )
        .seen_on_llvmpipe(),
        KnownFailure::unsettled(Property::Order, "deep emissive high-alpha passing"),
        KnownFailure::reordered("near-overflow").when(|s| half_sums(s) && !half_statistics(s)),
    ],
    ..ESTIMATED
};
