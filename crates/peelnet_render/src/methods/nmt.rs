//! `nmt`: eq 6 with the transmittance that a network reads off four raw moments (Tsopouridis et al. 2024), drawn with the exported
//! text itself. Targets are the published ones, 56 bytes a pixel.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    learned::learned_transmittances,
    method::{Method, Promises},
    parameter::{Parameter, Precision, Targets},
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::methods::deep;

const TARGETS: Parameter = Parameter::Targets(Targets {
    about: "f32 (default, as published) or f16",
});

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
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
        Flaw::swallowed(&["deep", "near-overflow"]),
        Flaw::unsettled(Property::Order, &["deep", "near-overflow"]),
        Flaw::unsettled(Property::Transmittance, &["isolated"]),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "the network's own error; it reads the same moments (Tsopouridis et al. 2024)",
        ),
        Flaw::new(
            Property::Scale,
            &["thin-slab"],
            "it divides depths by a pixel's own range of them, here a few roundings (Tsopouridis et al. 2024)",
        )
        .when(|spec| !half_sums(spec))
        .seen_on_llvmpipe(),
        Flaw::new(
            Property::Transmittance,
            &["two-layers", "coplanar"],
            "the network's own error (Tsopouridis et al. 2024)",
        ),
    ],
    ..Method::new(
        "nmt",
        "Tsopouridis et al. 2024: a network reads four moments",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let target = |label, channels, blend| Target {
        label,
        channels,
        full: true,
        blend,
    };
    let extra = [("learned::weight", learned.wgsl.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &[
                Target { full: true, ..SUMS },
                // b_0 and the number of fragments: published with four channels.
                target("totals", 4, Blend::Add),
                target("moments", 4, Blend::Add),
                target("extent", 2, Blend::MaxAdd),
            ],
            passes: &[
                Gather {
                    label: "statistics",
                    shader: "methods::nmt::statistics",
                    extra: &extra,
                    writes: &[1, 2, 3],
                    ..Gather::NONE
                },
                Gather {
                    label: "gather",
                    shader: "methods::nmt::gather",
                    extra: &extra,
                    writes: &[0],
                    reads: &[1, 2, 3],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::nmt::resolve",
            resolve_extra: &extra,
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
