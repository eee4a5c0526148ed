//! `deep-thesis`: eq 6 with the weight of the thesis's network (Papakostas 2022), drawn with the exported text itself.

use super::{
    learned::learned_transmittances,
    prelude::*,
    wboit::{COMPOSITE, is_printed},
};
use peelnet_core::{
    fragment::Fragment,
    methods::{deep, wboit},
};

const IN_SCENE_UNITS: &str = "reads depth in scene units (Papakostas 2022)";

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, COMPOSITE],
    curve: &["", ":composite=printed"],
    learned: true,
    promises: |s| Promises {
        close_estimate: true,
        normalised: !is_printed(s),
        ..Promises::NORMALISED
    },
    twin: Some(|s, p| {
        let model = p.model?;
        let weight = |f: &Fragment| {
            let row = deep::Row::of(f, p.fragments);
            model.forward_raw(&[row.linear_depth, row.alpha_sum, row.fragment_count])[0]
        };
        Some(if is_printed(s) {
            wboit::normalised(&wboit::printed(p.fragments, weight), p.background)
        } else {
            deep::composite(p.fragments, p.background, weight)
        })
    }),
    transmittances: Some(learned_transmittances),
    flaws: &[
        Flaw::swallowed("alpha-tiny deep near-overflow"),
        Flaw::reordered("deep"),
        Flaw::BLIND,
        Flaw::new(
            Property::Scale,
            "alpha-near-one alpha-one alpha-zero coplanar deep emissive far grazing high-alpha intersecting \
             moving-camera opaque-mix passing thin-slab two-layers wide-range",
            IN_SCENE_UNITS,
        ),
        Flaw::new(Property::Scale, "alpha-tiny near-overflow", IN_SCENE_UNITS)
            .when(half_sums)
            .seen_on_llvmpipe(),
        Flaw::new(
            Property::Transmittance,
            "isolated two-layers coplanar",
            "its output is a weight among others, not a transmittance that stands alone",
        ),
        Flaw::new(
            Property::Half,
            "half-float",
            "inputs of scene units: roundings of the first layers add up to more than the last layer's own",
        ),
    ],
    ..Method::new(
        "deep-thesis",
        "Papakostas 2022: eq 6 with a network's weight",
        plan,
    )
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let printed = is_printed(p.b.spec).then_some("printed");
    let sums = p.target(SUMS)?;
    let transmittance = p.target(TRANSMITTANCE)?;
    let statistics = p.target(Target::half("statistics", 2, Blend::Add))?;
    p.geometry("methods::deep_thesis::statistics")
        .writes([statistics]);
    p.geometry("methods::deep_thesis::gather")
        .features(printed)
        .reads([statistics])
        .writes([sums, transmittance]);
    p.resolve("methods::deep_thesis::resolve", [sums, transmittance]);
    Ok(())
}
