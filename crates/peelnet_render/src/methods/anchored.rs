//! `deep-small`, `deep-medium`, `deep-large`: a learned share of the others' absorbance, anchored at both ends, drawn with
//! the exported text itself. The CPU twin is `peelnet_core::methods::anchored`.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::SUMS,
};
use crate::RenderError;
use peelnet_model::Recipe;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let separate_ends = learned.recipe != Recipe::Small;
    let fourth = learned.recipe == Recipe::Large;
    let target = |label, channels, blend| Target {
        label,
        channels,
        full: fourth,
        blend,
    };
    // What a network does not read is not accumulated.
    let mut targets = vec![
        SUMS,
        target("moments", 4, Blend::Add),
        Target {
            full: false,
            ..target("extent", 4, Blend::Max)
        },
    ];
    let (mut statistics, mut sums, mut resolve_reads) = (vec![1, 2], vec![0], vec![0, 1]);
    let mut features = Vec::new();
    if separate_ends {
        features.push("separate_ends");
        sums.push(targets.len());
        resolve_reads.push(targets.len());
        targets.push(Target {
            label: "ends",
            ..SUMS
        });
    }
    if fourth {
        features.push("fourth_moment");
        statistics.push(targets.len());
        targets.push(target("fourth moment", 1, Blend::Add));
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
                    features: &features,
                    extra: &extra,
                    writes: &statistics,
                    reads: &[],
                },
                Gather {
                    label: "gather",
                    shader: "methods::anchored::gather",
                    features: &features,
                    extra: &extra,
                    writes: &sums,
                    reads: &statistics,
                },
            ],
            resolve: "methods::anchored::resolve",
            resolve_features: &features,
            resolve_reads: &resolve_reads,
        },
    )
}
