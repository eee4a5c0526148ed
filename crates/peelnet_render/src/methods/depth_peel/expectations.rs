use crate::{methods::prelude::*, passes::peeling::PASSES};
use peelnet_core::methods::over;

/// Coincident fragments that are drawn in another order.
pub(in crate::methods) const COINCIDENT: KnownFailure = KnownFailure::coincident(
    "coincident fragments are separated by a depth test that keeps the first drawn, because portable WebGPU can compare no triangle beside the depth; they must be drawn in the order of their numbers, as the renderer does, or some are lost",
);

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| Guarantees {
        exact: PASSES.count(s).is_none(),
        sorted: PASSES.count(s).is_none(),
        peels: true,
        ..Guarantees::EXACT
    },
    reference: Some(|s, p| {
        let sorted = over::sorted(p.fragments);
        let passes = PASSES.count(s).unwrap_or(u64::MAX) as usize;
        let reached = &sorted[..passes.min(sorted.len())];
        Some(over::composite(reached, p.background))
    }),
    known_failures: &[COINCIDENT.when(|s| PASSES.count(s).is_none())],
    ..Expectations::DEFAULT
};
