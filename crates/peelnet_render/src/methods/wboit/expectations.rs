use super::{is_printed, weight};
use crate::methods::{Pixel, prelude::*};
use peelnet_core::{fragment::Fragment, methods::wboit};

/// The colour by eq 6, or as the thesis prints it.
pub(in crate::methods) fn composite(
    spec: &MethodSpec,
    p: &Pixel<'_>,
    weight: impl FnMut(&Fragment) -> f32,
) -> Option<[f32; 3]> {
    let sums = if is_printed(spec) {
        wboit::printed(p.fragments, weight)
    } else {
        wboit::Sums::of(p.fragments, weight)
    };
    Some(wboit::normalised(&sums, p.background))
}

pub(super) const WEIGHTED: Expectations = Expectations {
    guarantees: |s| Guarantees {
        tinted: !is_printed(s),
        normalised: !is_printed(s),
        own_weight: true,
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let (weight, _) = weight(s);
        composite(s, p, |f| weight.eval(f.depth, f.alpha, f.window_depth))
    }),
    ..Expectations::DEFAULT
};

/// Of a lamp of the least opacity, 1/1024: with the least weight, 1e-2 α, it has a share of 1e-8 in the sum of weights.
const fn unweighed_lamp(property: Property) -> KnownFailure {
    let reason = "half floats end at 6e-8: opacity times weight of a faint lamp far from the near plane is less, and the lamp is gone";
    KnownFailure::new(property, "emissive", reason).when(half_sums)
}

/// Where weights of equations 7 and 8, and the two steepest of other authors, differ between scales by more than a step of a display.
const STEEP: KnownFailure = KnownFailure::in_scene_units(
    "alpha-near-one alpha-one alpha-zero apart coplanar deep emissive far grazing high-alpha intersecting lines moving-camera \
     opaque-mix passing thin-slab two-layers wide-range",
);

/// Where half floats lose digits of weights that are otherwise at another scale.
const fn lost_at_scale(cases: &'static str) -> KnownFailure {
    KnownFailure::in_scene_units(cases).when(half_sums)
}

pub(super) const EQ7: Expectations = WEIGHTED.failing(&[
    STEEP,
    lost_at_scale("alpha-tiny near-overflow"),
    KnownFailure::swallowed("alpha-tiny deep"),
    KnownFailure::new(
        Property::Image,
        "alpha-tiny",
        "half floats: a sum of hundreds of small terms is rounded otherwise",
    )
    .when(half_sums)
    .elsewhere(),
    KnownFailure::overflowing("near-overflow"),
    KnownFailure::BLIND,
]);

pub(super) const EQ8: Expectations = WEIGHTED.failing(&[
    STEEP,
    lost_at_scale("alpha-tiny near-overflow"),
    KnownFailure::swallowed("deep"),
    KnownFailure::overflowing("near-overflow"),
    KnownFailure::BLIND,
]);

pub(super) const EQ9: Expectations = WEIGHTED.failing(&[
    KnownFailure::in_scene_units(
        "alpha-one apart coplanar far high-alpha intersecting moving-camera opaque-mix thin-slab two-layers wide-range",
    ),
    lost_at_scale("alpha-tiny deep emissive near-overflow"),
    KnownFailure::overflowing("deep near-overflow"),
    KnownFailure::reordered("deep"),
    KnownFailure::BLIND,
]);

pub(super) const EQ10: Expectations = WEIGHTED.failing(&[
    KnownFailure::swallowed("alpha-tiny deep"),
    KnownFailure::overflowing("near-overflow"),
    unweighed_lamp(Property::Hull),
    unweighed_lamp(Property::Single),
    KnownFailure::reordered("deep").elsewhere(),
    KnownFailure::BLIND,
]);

pub(super) const PAPAKOSTAS: Expectations = WEIGHTED.failing(&[
    KnownFailure::in_scene_units("apart far thin-slab wide-range"),
    lost_at_scale("alpha-tiny deep emissive"),
    KnownFailure::swallowed("deep near-overflow"),
    KnownFailure::swallowed("alpha-tiny").elsewhere(),
    KnownFailure::BLIND,
]);

const fn vanishing(property: Property) -> KnownFailure {
    let reason = "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on";
    KnownFailure::new(property, "far", reason).when(half_sums)
}

pub(super) const INVERSE_POWER: Expectations = WEIGHTED.failing(&[
    STEEP,
    lost_at_scale("alpha-tiny isolated"),
    KnownFailure::swallowed("deep near-overflow"),
    vanishing(Property::Hull),
    vanishing(Property::Dark),
    vanishing(Property::Single),
    KnownFailure::reordered("deep"),
    KnownFailure::BLIND,
]);

const fn faint(property: Property, cases: &'static str) -> KnownFailure {
    let reason = "half floats lose digits below 6e-5 and end at 6e-8, where 10 / (1 + 10 (z k)^5) comes at depths of 70 and 280";
    KnownFailure::new(property, cases, reason).when(half_sums)
}

pub(super) const SMOKE: Expectations = WEIGHTED.failing(&[
    STEEP,
    KnownFailure::in_scene_units("alpha-tiny"),
    lost_at_scale("isolated near-overflow"),
    KnownFailure::swallowed("deep near-overflow"),
    KnownFailure::reordered("deep"),
    faint(Property::Hull, "far isolated"),
    faint(Property::Dark, "far"),
    faint(Property::Single, "far isolated"),
    KnownFailure::BLIND,
]);
