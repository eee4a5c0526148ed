//! `slabs`: known layers without ordered access, in four slabs of the pixel's own range. The CPU twin is `peelnet_core::methods::slabs`.

use super::{
    commutative::{self, Blend, ENDS, Gather, Plan, Target},
    compositor::{Build, Compositor},
    method::{Method, Promises},
    parameter::{Parameter, Word},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::{
    methods::slabs::{self, Design},
    statistics::SumPrecision,
};

const KEEP: Word = Word {
    name: "keep",
    about: "large (default, 48 bytes a pixel): every slab's mean depth, three slabs' farthest fragment, known fragments in a sum of their own; medium (40 bytes): one sum; small (32 bytes): two mean depths, one farthest fragment",
    words: &["large", "medium", "small"],
};

fn design(spec: &MethodSpec) -> Design {
    match KEEP.of(spec) {
        "small" => Design::SMALL,
        "medium" => Design::MEDIUM,
        _ => Design::LARGE,
    }
}

fn is_small(spec: &MethodSpec) -> bool {
    design(spec) == Design::SMALL
}

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Word(KEEP)],
    promises: |_| Promises {
        tinted: true,
        ..Promises::NORMALISED
    },
    curve: &["", ":keep=medium", ":keep=small"],
    twin: Some(|s, p| {
        let (fragments, c0, warp) = (p.fragments, p.background, &p.warp);
        Some(slabs::composite(
            fragments,
            c0,
            warp,
            design(s),
            slabs::middle,
        ))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let seen = slabs::seen(fragments, warp, design(s), SumPrecision::Half);
        Some(seen.iter().map(|seen| seen.weight(slabs::middle)).collect())
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::swallowed(&["alpha-tiny"]).when(|s| !is_small(s)),
        Flaw::reordered(&["deep"]).when(is_small),
        Flaw::unsettled(Property::Order, &["thin-slab"]),
        Flaw::new(
            Property::Steady,
            &["moving-camera"],
            "between a slab's known ends the middle of the bounds is taken, which changes where a layer passes another slab's border",
        ),
        Flaw::new(
            Property::Transmittance,
            &["coplanar"],
            "without a mean depth half of what lies between a slab's ends counts as in front: sixteen coincident layers, or none of them",
        )
        .when(is_small),
    ],
    ..Method::new(
        "slabs",
        "four slabs of depth in the pixel's range, each with its own sums and known ends; no network",
        build,
    )
};

const fn half(label: &'static str, channels: u32, blend: Blend) -> Target {
    Target {
        label,
        channels,
        full: false,
        blend,
    }
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let design = design(b.spec);
    let few = design.farthest == 1;
    let mut targets = vec![
        SUMS,
        half("range of depths", 2, Blend::MaxBytes),
        half("absorbances of slabs", 4, Blend::Add),
        half("first moments of slabs", design.means as u32, Blend::Add),
        half("nearest of slabs", 4, Blend::Max),
    ];
    if few {
        targets.push(half("farthest of the nearest slab", 1, Blend::Max));
    } else {
        targets.push(half("farthest of two slabs", 2, Blend::Max));
        targets.push(half("farthest of the third slab", 1, Blend::Max));
    }
    let kept: Vec<usize> = (2..targets.len()).collect();
    let reads: Vec<usize> = (1..targets.len()).collect();
    let (mut sums, mut resolve_reads) = (vec![0], vec![0, 2]);
    let mut features: Vec<&str> = Vec::new();
    if design.apart {
        sums.push(targets.len());
        resolve_reads.push(targets.len());
        targets.push(Target {
            label: ENDS,
            ..SUMS
        });
        features.push("apart");
    }
    let resolve_features = features.clone();
    features.extend(few.then_some("few"));
    let statistics: &[&str] = if few { &["few"] } else { &[] };
    let passes = [
        Gather {
            label: "range",
            shader: "methods::slabs::range",
            writes: &[1],
            ..Gather::NONE
        },
        Gather {
            label: "statistics",
            shader: "methods::slabs::statistics",
            features: statistics,
            writes: &kept,
            reads: &[1],
            ..Gather::NONE
        },
        Gather {
            label: "gather",
            shader: "methods::slabs::gather",
            features: &features,
            writes: &sums,
            reads: &reads,
            ..Gather::NONE
        },
    ];
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes: &passes,
            resolve: "methods::slabs::resolve",
            resolve_features: &resolve_features,
            resolve_reads: &resolve_reads,
            tinted_by: Some(2),
            ..Plan::NONE
        },
    )
}
