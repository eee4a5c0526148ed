//! `deep-thesis`: eq 6 with the weight of the thesis's network (Papakostas 2022), drawn with the exported text itself.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    learned::learned_transmittances,
    method::{Method, Promises, Role},
    parameter::{Parameter, TARGETS},
    weighted::{COMPOSITE, SUMS, TRANSMITTANCE, is_printed},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::{
    fragment::Fragment,
    methods::{deep, wboit},
};

const IN_SCENE_UNITS: &str = "reads depth in scene units (Papakostas 2022)";

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, Parameter::Word(COMPOSITE)],
    curve: &["", ":composite=printed"],
    learned: true,
    promises: |s| Promises {
        close_estimate: true,
        normalised: !is_printed(s),
        ..Promises::NORMALISED
    },
    roles: &[(Role::ThesisNetwork, "deep-thesis")],
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
        Flaw::swallowed(&["alpha-tiny", "deep", "near-overflow"]),
        Flaw::reordered(&["deep"]),
        Flaw::BLIND,
        Flaw::new(
            Property::Scale,
            &[
                "alpha-near-one",
                "alpha-one",
                "alpha-zero",
                "coplanar",
                "deep",
                "emissive",
                "far",
                "grazing",
                "high-alpha",
                "intersecting",
                "moving-camera",
                "opaque-mix",
                "passing",
                "thin-slab",
                "two-layers",
                "wide-range",
            ],
            IN_SCENE_UNITS,
        ),
        Flaw::new(
            Property::Scale,
            &["alpha-tiny", "near-overflow"],
            IN_SCENE_UNITS,
        )
        .when(half_sums)
        .seen_on_llvmpipe(),
        Flaw::new(
            Property::Transmittance,
            &["isolated", "two-layers", "coplanar"],
            "its output is a weight among others, not a transmittance that stands alone",
        ),
        Flaw::new(
            Property::Half,
            &["half-float"],
            "inputs of scene units: roundings of the first layers add up to more than the last layer's own",
        ),
    ],
    ..Method::new(
        "deep-thesis",
        "Papakostas 2022: eq 6 with a network's weight",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let statistics = Target {
        label: "statistics",
        channels: 2,
        full: false,
        blend: Blend::Add,
    };
    let extra = [("learned::weight", learned.wgsl.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE, statistics],
            passes: &[
                Gather {
                    label: "statistics",
                    shader: "methods::deep_thesis::statistics",
                    extra: &extra,
                    writes: &[2],
                    ..Gather::NONE
                },
                Gather {
                    label: "gather",
                    shader: "methods::deep_thesis::gather",
                    features: if is_printed(b.spec) {
                        &["printed"]
                    } else {
                        &[]
                    },
                    extra: &extra,
                    writes: &[0, 1],
                    reads: &[2],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::deep_thesis::resolve",
            resolve_extra: &extra,
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
