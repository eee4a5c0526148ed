//! `deep-anchored-small`, `deep-anchored-medium`: a learned share of the others' absorbance, anchored at both ends, drawn with
//! the exported text itself. The CPU twin is `peelnet_core::methods::anchored`.

use super::{
    commutative::{self, Blend, ENDS, Gather, Plan, Target},
    compositor::{Build, Compositor},
    learned::learned_transmittances,
    method::{Method, Pixel, Promises},
    parameter::{Precision, TARGETS},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::{methods::anchored, statistics::SumPrecision};
use peelnet_model::{Inputs, Output};

const fn promises(statistics: Precision) -> Promises {
    Promises {
        tinted: true,
        statistics,
        root: Some(2),
        close_estimate: true,
        ..Promises::NORMALISED
    }
}

fn twin(_: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let model = p.model?;
    let separate_ends = model.meta.output == Output::AnchoredShareSeparateEnds;
    let Inputs::Rest(features) = model.meta.recipe.inputs else {
        return None;
    };
    Some(anchored::composite(
        p.fragments,
        p.background,
        &p.warp,
        separate_ends,
        |rest| model.answer(features, rest),
    ))
}

/// What the three sizes have in common.
macro_rules! anchored {
    ($name:literal, $about:literal) => {
        Method {
            learned: true,
            twin: Some(twin),
            transmittances: Some(learned_transmittances),
            ..Method::new($name, $about, build)
        }
    };
}

/// Crossing and many layers, where what is left of a sum without the fragment's own share and the ends is a small part of it.
const UNSETTLED: Flaw = Flaw::unsettled(
    Property::Order,
    &["high-alpha", "intersecting", "moving-camera"],
);

const BEHIND_COINCIDENT: Flaw = Flaw::new(
    Property::Transmittance,
    &["coplanar"],
    "the network's own error at a layer between sixteen coincident ones and the end, up to 0.010; where the sixteen stand before one, it is exact",
);

/// Of no matter to what is drawn: exported texts have 32 bits.
const MAGNIFIED: Flaw = Flaw::new(
    Property::Half,
    &["half-float"],
    "weights of the hidden layers up to 10 magnify the roundings of half floats, which the limit counts in the last layer alone",
);

const ROUNDED_OTHERWISE: Flaw = Flaw::new(
    Property::Scale,
    &["high-alpha"],
    "depths are rounded otherwise, and a sum in half floats falls on the other side of a rounding (docs/learned-weights.md)",
)
.when(half_sums)
.seen_on_llvmpipe();

pub(super) const SMALL: Method = Method {
    parameters: &[TARGETS],
    promises: |_| promises(Precision::Half),
    curve: &["", ":targets=f32"],
    flaws: &[
        Flaw::swallowed(&["deep"]),
        ROUNDED_OTHERWISE,
        UNSETTLED,
        Flaw::unsettled(Property::Order, &["near-overflow", "deep"]),
        Flaw::reordered(&["emissive"]),
        BEHIND_COINCIDENT,
        MAGNIFIED,
    ],
    ..anchored!(
        "deep-anchored-small",
        "a learned share of what lies between the pixel's ends, 5-8-1"
    )
};

pub(super) const MEDIUM: Method = Method {
    parameters: &[TARGETS],
    promises: |_| promises(Precision::Half),
    curve: &["", ":targets=f32", ":scale=0.5"],
    flaws: &[ROUNDED_OTHERWISE, UNSETTLED, BEHIND_COINCIDENT],
    ..anchored!("deep-anchored-medium", "the same with exact ends, 5-12-1")
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let separate_ends = learned.recipe.output == Output::AnchoredShareSeparateEnds;
    let full = learned.recipe.sums == SumPrecision::Exact;
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
            label: ENDS,
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
            resolve_extra: &extra,
            resolve_reads: &resolve_reads,
            tinted_by: Some(1),
            ..Plan::NONE
        },
    )
}
