//! What tests and `peelnet stress` expect of the methods in this folder.

use super::reference;
use crate::methods::expected::*;

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
        KnownFailure::reordered("deep near-overflow"),
        KnownFailure::swallowed("alpha-tiny").when(|s| s.number() >= 64 && half_sums(s)),
        KnownFailure::new(
            Property::Opaque,
            "alpha-near-one",
            "noise: one sample of sixteen weighs 0.06 (Enderton et al. 2010)",
        ),
    ],
    ..Expectations::DEFAULT
};
