//! `nmt`: eq 6 with the transmittance that a network reads off four raw moments (Tsopouridis et al. 2024), drawn with the exported
//! text itself. Targets are the published ones, 56 bytes a pixel.

use super::{learned::learned_transmittances, prelude::*};
use peelnet_core::methods::deep;

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::targets("f32 (default, as published) or f16")],
    learned: true,
    promises: |_| Promises {
        sums: Precision::Full,
        statistics: Precision::Full,
        ..Promises::NORMALISED
    },
    curve: &["", ":targets=f16"],
    twin: Some(|s, p| {
        let points: Vec<(f32, f32)> = p.fragments.iter().map(|f| (f.depth, f.alpha)).collect();
        let mut weights = s.transmittances(&points, &p.warp, p.model)?.into_iter();
        // One weight a fragment.
        let next = |_: &_| weights.next().unwrap_or_default() as f32;
        Some(deep::composite(p.fragments, p.background, next))
    }),
    transmittances: Some(learned_transmittances),
    flaws: &[
        Flaw::swallowed("deep near-overflow"),
        Flaw::unsettled(Property::Order, "deep near-overflow"),
        Flaw::unsettled(Property::Transmittance, "isolated"),
        Flaw::new(
            Property::Opaque,
            "alpha-near-one",
            "the network's own error; it reads the same moments (Tsopouridis et al. 2024)",
        ),
        Flaw::new(
            Property::Scale,
            "thin-slab",
            "it divides depths by a pixel's own range of them, here a few roundings (Tsopouridis et al. 2024)",
        )
        .when(|spec| !half_sums(spec))
        .seen_on_llvmpipe(),
        Flaw::new(
            Property::Transmittance,
            "two-layers coplanar",
            "the network's own error (Tsopouridis et al. 2024)",
        ),
    ],
    ..Method::new(
        "nmt",
        "Tsopouridis et al. 2024: a network reads four moments",
        plan,
    )
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let sums = p.target(Target { full: true, ..SUMS })?;
    // b_0 and the number of fragments: published with four channels.
    let totals = p.target(Target::full("totals", 4, Blend::Add))?;
    let moments = p.target(Target::full("moments", 4, Blend::Add))?;
    let extent = p.target(Target::full("extent", 2, Blend::MaxAdd))?;
    p.geometry("methods::nmt::statistics")
        .writes([totals, moments, extent]);
    p.geometry("methods::nmt::gather")
        .reads([totals, moments, extent])
        .writes([sums]);
    p.resolve("methods::nmt::resolve", [sums, totals]);
    Ok(())
}
