//! `weighted-average`: the mean colour, covering as so many layers of the mean opacity (Bavoil & Myers 2008).

use super::{
    commutative::{self, Blend, Plan, Target},
    compositor::{Build, Compositor},
    method::Method,
    parameter::TARGETS,
    weighted::{SUMS, gather},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::weighted_average;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    twin: Some(|_, p| Some(weighted_average::composite(p.fragments, p.background))),
    flaws: &[
        Flaw::new(
            Property::Background,
            &[
                "alpha-zero",
                "alpha-one",
                "coplanar",
                "emissive",
                "far",
                "grazing",
                "intersecting",
                "moving-camera",
                "passing",
            ],
            "covers as layers of the mean opacity would, not as those that are there (Bavoil & Myers 2008)",
        ),
        Flaw::swallowed(&["alpha-tiny", "deep", "near-overflow"]),
        Flaw::BLIND,
    ],
    ..Method::new("weighted-average", "Bavoil & Myers 2008", build)
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let count = Target {
        label: "fragment count",
        channels: 1,
        full: false,
        blend: Blend::Add,
    };
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, count],
            passes: &[gather("methods::weighted_average::gather", &[0, 1])],
            resolve: "methods::weighted_average::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
