//! `nmt`: eq 6 with the transmittance that a network reads off four moments (Tsopouridis et al. 2024), drawn with the
//! exported text itself.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    learned::learned_transmittances,
    method::{Method, Promises},
    parameter::{MOMENT_TARGETS, Precision},
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_statistics, half_sums},
};
use peelnet_core::methods::deep;

pub(super) const METHOD: Method = Method {
    parameters: &[MOMENT_TARGETS],
    learned: true,
    promises: |_| Promises {
        statistics: Precision::Full,
        root: Some(2),
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
        Flaw::swallowed(&["alpha-tiny", "deep"]),
        // 0.0044 for a limit of 0.0039; with statistics in half floats it stays within.
        Flaw::swallowed(&["near-overflow"]).when(|s| half_sums(s) && !half_statistics(s)),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "the network's own error; it reads the same moments (Tsopouridis et al. 2024)",
        ),
        Flaw::new(
            Property::Transmittance,
            &["isolated", "two-layers", "coplanar"],
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
    let target = |label, channels| Target {
        label,
        channels,
        full: true,
        blend: Blend::Add,
    };
    let extra = [("learned::weight", learned.wgsl.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, target("absorbance", 2), target("moments", 4)],
            passes: &[
                Gather {
                    label: "statistics",
                    shader: "methods::nmt::statistics",
                    extra: &extra,
                    writes: &[1, 2],
                    ..Gather::NONE
                },
                Gather {
                    label: "gather",
                    shader: "methods::nmt::gather",
                    extra: &extra,
                    writes: &[0],
                    reads: &[1, 2],
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
