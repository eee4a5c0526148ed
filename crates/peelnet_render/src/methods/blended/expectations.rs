//! What tests and `peelnet stress` expect of the methods in this folder.

use super::reference;
use crate::methods::expected::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    reference: Some(|_, p| Some(reference::composite(p.fragments, p.background))),
    known_failures: &[
        KnownFailure::swallowed("alpha-tiny deep near-overflow"),
        KnownFailure::BLIND,
    ],
    ..Expectations::DEFAULT
};
