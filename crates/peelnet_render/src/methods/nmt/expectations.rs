use crate::methods::{learned::learned_transmittances, prelude::*};
use peelnet_core::methods::deep;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        sums: Precision::Full,
        statistics: Precision::Full,
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let points: Vec<(f32, f32)> = p.fragments.iter().map(|f| (f.depth, f.alpha)).collect();
        let mut weights = s.transmittances(&points, &p.warp, p.model)?.into_iter();
        // One weight a fragment.
        let next = |_: &_| weights.next().unwrap_or_default() as f32;
        Some(deep::composite(p.fragments, p.background, next))
    }),
    estimate: Some(learned_transmittances),
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::unsettled(Property::Order, "deep near-overflow"),
        KnownFailure::unsettled(Property::Transmittance, "isolated"),
        KnownFailure::translucent(
            "the network's own error; it reads the same moments (Tsopouridis et al. 2024)",
        ),
        KnownFailure::MAGNIFIED,
        KnownFailure::new(
            Property::Transmittance,
            "two-layers coplanar",
            "the network's own error (Tsopouridis et al. 2024)",
        ),
    ],
};
