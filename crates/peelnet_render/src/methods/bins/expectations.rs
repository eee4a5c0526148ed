use super::{BOUNDS, bounds, range::Bounds, reference};
use crate::methods::prelude::*;

fn of_pixel(spec: &MethodSpec) -> bool {
    bounds(spec, BOUNDS) == Bounds::Pixel
}

fn four_of_pixel(spec: &MethodSpec) -> bool {
    of_pixel(spec) && spec.number() == 4
}

const FEW_BINS: &str =
    "four bins between a pixel's ends: within one, absorbance counts as spread evenly";

const BLURRED: &str = "bins over the whole frame's depth blur what lies close together";

pub(super) const METHOD: Expectations = Expectations {
    reference: Some(weighted_reference),
    estimate: Some(|s, fragments, warp, _| {
        let n = s.number() as usize;
        Some(reference::transmittances(fragments, warp, n, bounds(s, BOUNDS)))
    }),
    known_failures: &[
        KnownFailure::swallowed("deep"),
        KnownFailure::new(
            Property::Scale,
            "coplanar",
            "a depth at the border of two bins is rounded into one or the other",
        )
        .when(|s| s.number() == 8 && of_pixel(s)),
        KnownFailure::translucent(
            "absorbance ends at 4, as shipped: three layers of 0.99 let 1.8 % through each, not 1 %",
        )
        .when(of_pixel),
        KnownFailure::translucent(BLURRED).when(|s| !of_pixel(s)),
        KnownFailure::new(Property::Transmittance, "two-layers", BLURRED).when(|s| !of_pixel(s)),
        KnownFailure::new(Property::Transmittance, "coplanar", FEW_BINS).when(four_of_pixel),
        KnownFailure::new(Property::Steady, "moving-camera", FEW_BINS).when(four_of_pixel),
    ],
    ..Expectations::DEFAULT
};
