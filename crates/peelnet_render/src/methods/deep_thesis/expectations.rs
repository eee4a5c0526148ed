//! What tests and `peelnet stress` expect of the methods in this folder.

use crate::methods::{expected::*, learned::learned_transmittances, wboit::is_printed};
use peelnet_core::{
    fragment::Fragment,
    methods::{deep, wboit},
};

const IN_SCENE_UNITS: &str = "reads depth in scene units (Papakostas 2022)";

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| Guarantees {
        close_estimate: true,
        normalised: !is_printed(s),
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let model = p.model?;
        let weight = |f: &Fragment| {
            let row = deep::Row::new(f, p.fragments);
            model.forward_raw(&[row.linear_depth, row.alpha_sum, row.fragment_count])[0]
        };
        Some(if is_printed(s) {
            wboit::normalised(&wboit::printed(p.fragments, weight), p.background)
        } else {
            deep::composite(p.fragments, p.background, weight)
        })
    }),
    estimate: Some(learned_transmittances),
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::reordered("deep"),
        KnownFailure::BLIND,
        KnownFailure::new(
            Property::Scale,
            "alpha-near-one alpha-one alpha-zero coplanar deep emissive far grazing high-alpha intersecting \
             moving-camera opaque-mix passing thin-slab two-layers wide-range",
            IN_SCENE_UNITS,
        ),
        KnownFailure::new(Property::Scale, "alpha-tiny near-overflow", IN_SCENE_UNITS)
            .when(half_sums)
            .seen_on_llvmpipe(),
        KnownFailure::new(
            Property::Transmittance,
            "isolated two-layers coplanar",
            "its output is a weight among others, not a transmittance that stands alone",
        ),
        KnownFailure::new(
            Property::Half,
            "half-float",
            "inputs of scene units: roundings of the first layers add up to more than the last layer's own",
        ),
    ],
};
