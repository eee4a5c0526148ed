//! `nmt`: eq 6 with the transmittance that a network reads off four moments (Tsopouridis et al. 2024), drawn with the
//! exported text itself.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::SUMS,
};
use crate::RenderError;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
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
            resolve: "methods::mboit4::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
