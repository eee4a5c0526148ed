use super::reference;
use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        noisy: true,
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        Some(reference::composite(fragments, c0, s.number(), p.position))
    }),
    known_failures: &[
        KnownFailure::swallowed("deep near-overflow"),
        KnownFailure::reordered("deep"),
        KnownFailure::swallowed("alpha-tiny").when(|s| s.number() >= 64 && half_sums(s)),
        KnownFailure::translucent(
            "noise: one sample of sixteen weighs 0.06 (Enderton et al. 2010)",
        ),
    ],
    ..Expectations::DEFAULT
};
