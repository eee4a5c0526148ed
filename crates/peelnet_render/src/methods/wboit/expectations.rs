//! What tests and `peelnet stress` expect of the methods in this folder.

use super::{is_printed, weight};
use crate::methods::expected::*;
use peelnet_core::{fragment::Fragment, methods::wboit, weights::Weight};

pub(super) const WEIGHTED: Expectations = Expectations {
    guarantees: |_| Guarantees {
        own_weight: true,
        ..Guarantees::TINTED
    },
    reference: Some(|s, p| Some(wboit::composite(p.fragments, p.background, weight(s).0))),
    ..Expectations::DEFAULT
};

/// Of a lamp of the least opacity, 1/1024: with the least weight, 1e-2 α, it has a share of 1e-8 in the sum of weights.
const fn unweighed_lamp(property: Property) -> KnownFailure {
    let reason = "half floats end at 6e-8: opacity times weight of a faint lamp far from the near plane is less, and the lamp is gone";
    KnownFailure::new(property, "emissive", reason).when(half_sums)
}

pub(super) const EQ7: Expectations = Expectations {
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep"),
        KnownFailure::overflowing("near-overflow"),
        KnownFailure::reordered("deep"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

pub(super) const EQ8: Expectations = Expectations {
    known_failures: &[
        KnownFailure::swallowed("deep"),
        KnownFailure::overflowing("near-overflow"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

pub(super) const EQ9: Expectations = Expectations {
    known_failures: &[
        KnownFailure::overflowing("deep near-overflow"),
        KnownFailure::reordered("deep"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

pub(super) const EQ10: Expectations = Expectations {
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep"),
        KnownFailure::overflowing("near-overflow"),
        unweighed_lamp(Property::Hull),
        unweighed_lamp(Property::Single),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

pub(super) const PAPAKOSTAS: Expectations = Expectations {
    guarantees: |s| Guarantees {
        tinted: !is_printed(s),
        normalised: !is_printed(s),
        own_weight: true,
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let weight = |f: &Fragment| Weight::Papakostas.eval(f.depth, f.alpha, f.window_depth);
        Some(if is_printed(s) {
            wboit::normalised(&wboit::printed(p.fragments, weight), p.background)
        } else {
            wboit::composite(p.fragments, p.background, Weight::Papakostas)
        })
    }),
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

const fn vanishing(property: Property) -> KnownFailure {
    let reason = "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on";
    KnownFailure::new(property, "far", reason).when(half_sums)
}

pub(super) const INVERSE_POWER: Expectations = Expectations {
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        vanishing(Property::Hull),
        vanishing(Property::Dark),
        vanishing(Property::Single),
        KnownFailure::reordered("deep"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};

const fn faint(property: Property, cases: &'static str) -> KnownFailure {
    let reason = "half floats lose digits below 6e-5 and end at 6e-8, where 10 / (1 + 10 (z k)^5) comes at depths of 70 and 280";
    KnownFailure::new(property, cases, reason).when(half_sums)
}

pub(super) const SMOKE: Expectations = Expectations {
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        KnownFailure::reordered("deep"),
        faint(Property::Hull, "far isolated"),
        faint(Property::Dark, "far"),
        faint(Property::Single, "far isolated"),
        KnownFailure::BLIND,
    ],
    ..WEIGHTED
};
