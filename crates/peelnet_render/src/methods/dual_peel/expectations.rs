use super::colors;
use crate::{methods::prelude::*, passes::peeling::PASSES};
use peelnet_core::methods::over;

const COINCIDENT: KnownFailure = KnownFailure::coincident(
    "coincident fragments are blended into one layer, so that they must be drawn in the order of their numbers",
);

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| Guarantees {
        exact: PASSES.count(s).is_none() && colors(s) == Precision::Full,
        sums: colors(s),
        sorted: PASSES.count(s).is_none(),
        peels: true,
        ..Guarantees::EXACT
    },
    reference: Some(|s, p| {
        let mut reached = over::sorted(p.fragments);
        // One layer a pass from either end.
        let n = reached.len();
        let front = n.min(PASSES.count(s).unwrap_or(u64::MAX) as usize);
        let back = front.min(n - front);
        reached.drain(front..n - back);
        Some(over::composite(&reached, p.background))
    }),
    known_failures: &[COINCIDENT.when(|s| PASSES.count(s).is_none())],
    ..Expectations::DEFAULT
};
