//! `weighted-sum`: colours summed as they are (Meshkin 2007).

use super::prelude::*;
use peelnet_core::methods::weighted_sum;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    promises: |_| Promises {
        normalised: false,
        ..Promises::NORMALISED
    },
    twin: Some(|_, p| Some(weighted_sum::composite(p.fragments, p.background))),
    flaws: &[
        Flaw::reordered("deep near-overflow"),
        Flaw::new(
            Property::Background,
            "alpha-zero alpha-tiny alpha-one alpha-near-one high-alpha deep near-overflow far wide-range \
             coplanar thin-slab two-layers intersecting grazing emissive opaque-mix moving-camera passing",
            "covers by the sum of opacities, which may exceed 1 (Meshkin 2007)",
        ),
        Flaw::new(
            Property::Dark,
            "alpha-one alpha-near-one high-alpha coplanar intersecting",
            "takes more of C_0 than there is where opacities add up to more than 1 (Meshkin 2007)",
        ),
        Flaw::BLIND,
    ],
    ..Method::new("weighted-sum", "Meshkin 2007", plan)
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let sums = p.target(SUMS)?;
    p.geometry("methods::weighted_sum::gather").writes([sums]);
    p.resolve("methods::weighted_sum::resolve", [sums]);
    Ok(())
}
