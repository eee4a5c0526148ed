//! `deep-anchored-small`, `deep-anchored-medium`: a learned share of the others' absorbance, anchored at both ends, drawn with
//! the exported text itself. The CPU twin is `peelnet_core::methods::anchored`.

use super::{learned::learned_transmittances, prelude::*};
use peelnet_core::{methods::anchored, statistics::SumPrecision};
use peelnet_model::{Inputs, Output};

const fn anchored(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[TARGETS],
        learned: true,
        promises: |_| Promises {
            root: Some(2),
            close_estimate: true,
            ..Promises::TINTED
        },
        twin: Some(|_, p| {
            let model = p.model?;
            let separate_ends = model.meta.output == Output::AnchoredShareSeparateEnds;
            let Inputs::Rest(features) = model.meta.recipe.inputs else {
                return None;
            };
            let (fragments, c0) = (p.fragments, p.background);
            let share = |rest: &_| model.answer(features, rest);
            Some(anchored::composite(
                fragments,
                c0,
                &p.warp,
                separate_ends,
                share,
            ))
        }),
        transmittances: Some(learned_transmittances),
        ..Method::new(name, about, plan)
    }
}

/// Crossing and many layers, where what is left of a sum without the fragment's own share and the ends is a small part of it.
const UNSETTLED: Flaw = Flaw::unsettled(Property::Order, "high-alpha intersecting moving-camera");

const BEHIND_COINCIDENT: Flaw = Flaw::new(
    Property::Transmittance,
    "coplanar",
    "the network's own error at a layer between sixteen coincident ones and the end, up to 0.010; where the sixteen stand before one, it is exact",
);

/// Of no matter to what is drawn: exported texts have 32 bits.
const MAGNIFIED: Flaw = Flaw::new(
    Property::Half,
    "half-float",
    "weights of the hidden layers up to 10 magnify the roundings of half floats, which the limit counts in the last layer alone",
);

const ROUNDED_OTHERWISE: Flaw = Flaw::new(
    Property::Scale,
    "high-alpha",
    "depths are rounded otherwise, and a sum in half floats falls on the other side of a rounding (docs/learned-weights.md)",
)
.when(half_sums)
.seen_on_llvmpipe();

pub(super) const SMALL: Method = Method {
    curve: &["", ":targets=f32"],
    flaws: &[
        Flaw::swallowed("deep"),
        ROUNDED_OTHERWISE,
        UNSETTLED,
        Flaw::unsettled(Property::Order, "near-overflow deep"),
        Flaw::reordered("emissive"),
        BEHIND_COINCIDENT,
        MAGNIFIED,
    ],
    ..anchored(
        "deep-anchored-small",
        "a learned share of what lies between the pixel's ends, 5-8-1",
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":targets=f32", ":scale=0.5"],
    flaws: &[ROUNDED_OTHERWISE, UNSETTLED, BEHIND_COINCIDENT],
    ..anchored("deep-anchored-medium", "the same with exact ends, 5-12-1")
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let recipe = p.b.learned_weight()?.recipe;
    let ends = (recipe.output == Output::AnchoredShareSeparateEnds).then_some(ENDS);
    let feature = ends.map(|_| "separate_ends");
    let statistic = |label, blend| Target {
        full: recipe.sums == SumPrecision::Exact,
        ..Target::half(label, 4, blend)
    };
    let sums = p.target(SUMS)?;
    let moments = p.target(statistic("moments", Blend::Add))?;
    let extent = p.target(statistic("extent", Blend::MaxAdd))?;
    let ends = p.targets(ends)?;
    p.geometry("methods::anchored::statistics")
        .features(feature)
        .writes([moments, extent]);
    p.geometry("methods::anchored::gather")
        .features(feature)
        .reads([moments, extent])
        .writes([sums])
        .writes(ends.iter().copied());
    p.resolve("methods::anchored::resolve", [sums, moments])
        .features(feature)
        .reads(ends);
    p.tint()
}
