use super::reference;
use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    reference: Some(|_, p| Some(reference::composite(p.fragments, p.background))),
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::BLIND,
    ],
    ..Expectations::DEFAULT
};
