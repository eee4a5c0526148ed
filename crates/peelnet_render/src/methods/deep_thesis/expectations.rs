use crate::methods::{
    learned::learned_transmittances,
    prelude::*,
    wboit::{expectations::composite, is_printed},
};
use peelnet_core::methods::deep;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| Guarantees {
        close_estimate: true,
        normalised: !is_printed(s),
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let model = p.model?;
        composite(s, p, |f| {
            let row = deep::Row::new(f, p.fragments);
            model.forward_raw(&[row.linear_depth, row.alpha_sum, row.fragment_count])[0]
        })
    }),
    estimate: Some(learned_transmittances),
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep"),
        KnownFailure::swallowed("near-overflow").elsewhere(),
        KnownFailure::BLIND,
        KnownFailure::in_scene_units(
            "apart alpha-near-one alpha-one coplanar deep far grazing high-alpha intersecting lines moving-camera thin-slab two-layers wide-range",
        ),
        KnownFailure::in_scene_units("alpha-tiny passing").when(half_sums),
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
