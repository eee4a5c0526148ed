use super::reference;
use crate::methods::prelude::*;

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
