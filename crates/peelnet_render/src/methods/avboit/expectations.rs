use super::{reference, slices};
use crate::methods::prelude::*;
use peelnet_core::{fragment::points, methods::composite};

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        per_pixel: false,
        ..Guarantees::NORMALISED
    },
    // Of a pixel whose neighbours are like it: `per_pixel` is not guaranteed.
    reference: Some(|s, p| {
        let slices = slices(s) as usize;
        let t = reference::transmittances(&points(p.fragments), &p.warp, slices);
        Some(composite(p.fragments, p.background, &t))
    }),
    ..Expectations::DEFAULT
};
