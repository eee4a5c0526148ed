//! `weighted-average`: the mean colour, covering as so many layers of the mean opacity (Bavoil & Myers 2008).

use super::prelude::*;
use peelnet_core::methods::weighted_average;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    twin: Some(|_, p| Some(weighted_average::composite(p.fragments, p.background))),
    flaws: &[
        Flaw::new(
            Property::Background,
            "alpha-zero alpha-one coplanar emissive far grazing intersecting moving-camera passing",
            "covers as layers of the mean opacity would, not as those that are there (Bavoil & Myers 2008)",
        ),
        Flaw::swallowed("alpha-tiny deep near-overflow"),
        Flaw::BLIND,
    ],
    ..Method::new("weighted-average", "Bavoil & Myers 2008", plan)
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let sums = p.target(SUMS)?;
    let count = p.target(Target::half("fragment count", 1, Blend::Add))?;
    p.geometry("methods::weighted_average::gather")
        .writes([sums, count]);
    p.resolve("methods::weighted_average::resolve", [sums, count]);
    Ok(())
}
