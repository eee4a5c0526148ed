//! What tests and `peelnet stress` expect of the methods in this folder.

use super::reference;
use crate::methods::expected::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        order_independent: false,
        sums: Precision::Full,
        statistics: Precision::Full,
        ..Guarantees::NORMALISED
    },
    reference: Some(|s, p| {
        let nodes = s.number() as usize;
        Some(reference::composite(p.fragments, p.background, nodes))
    }),
    ..Expectations::DEFAULT
};
