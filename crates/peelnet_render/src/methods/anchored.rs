//! `deep-small`, `deep-medium`, `deep-large`: a learned share of the others' absorbance, anchored at both ends, drawn with
//! the exported text itself. The CPU twin is `peelnet_core::methods::anchored`.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::SUMS,
};
use crate::RenderError;
use peelnet_core::statistics::SumPrecision;
use peelnet_model::Recipe;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let separate_ends = learned.recipe != Recipe::Small;
    let full = learned.recipe.sum_precision() == SumPrecision::Exact;
    let target = |label, blend| Target {
        label,
        channels: 4,
        full,
        blend,
    };
    let mut targets = vec![
        SUMS,
        target("moments", Blend::Add),
        target("extent", Blend::MaxAdd),
    ];
    let (mut sums, mut resolve_reads) = (vec![0], vec![0, 1]);
    let mut features: &[&str] = &[];
    if separate_ends {
        features = &["separate_ends"];
        sums.push(targets.len());
        resolve_reads.push(targets.len());
        targets.push(Target {
            label: "ends",
            ..SUMS
        });
    }
    let extra = [("learned::weight", learned.wgsl.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes: &[
                Gather {
                    label: "statistics",
                    shader: "methods::anchored::statistics",
                    features,
                    extra: &extra,
                    writes: &[1, 2],
                    ..Gather::NONE
                },
                Gather {
                    label: "gather",
                    shader: "methods::anchored::gather",
                    features,
                    extra: &extra,
                    writes: &sums,
                    reads: &[1, 2],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::anchored::resolve",
            resolve_features: features,
            resolve_reads: &resolve_reads,
            tinted_by: Some(1),
            ..Plan::NONE
        },
    )
}
