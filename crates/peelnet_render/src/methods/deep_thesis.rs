//! `deep-thesis`: eq 6 with the weight of the thesis's network (Papakostas 2022), drawn with the exported text itself.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::RenderError;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let statistics = Target {
        label: "statistics",
        channels: 2,
        full: false,
        blend: Blend::Add,
    };
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE, statistics],
            passes: &[
                Gather {
                    label: "statistics",
                    shader: "methods::deep_thesis::statistics",
                    writes: &[2],
                    ..Gather::NONE
                },
                Gather {
                    label: "gather",
                    shader: "methods::deep_thesis::gather",
                    extra: &[("learned::weight", &learned.wgsl)],
                    writes: &[0, 1],
                    reads: &[2],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
