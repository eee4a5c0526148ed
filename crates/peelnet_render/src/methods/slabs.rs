//! `deep-small`, `deep-medium`, `deep-large`: known layers without ordered access, in four slabs of the pixel's own range, and a learned
//! guess of what lies between them, drawn with the exported text itself. `slabs` is the same without a network. The CPU twin is
//! `peelnet_core::methods::slabs`.

use super::{
    anchored::MAGNIFIED,
    commutative::{self, Blend, ENDS, Gather, Plan, Target},
    compositor::{Build, Compositor},
    method::{Method, Pixel, Promises},
    parameter::{Parameter, Word},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::{
    absorbance::DepthWarp,
    methods::slabs::{self, Design, Extent},
    statistics::SumPrecision,
};
use peelnet_model::{Inputs, Model};

const KEEP: Word = Word {
    name: "keep",
    about: "large (default, 46 bytes a pixel): three slabs' mean depth and farthest fragment, known fragments in a sum of their own; medium (38 bytes): one sum; small (32 bytes): two mean depths, one farthest fragment",
    words: &["large", "medium", "small"],
};

const RANGE: Word = Word {
    name: "range",
    about: "what is cut into slabs: the pixel's own range of depth (pixel, by default), found by a geometry pass of its own, or the frame's (frame), with a pass less and several times the error",
    words: &["pixel", "frame"],
};

fn design(spec: &MethodSpec) -> Design {
    let design = match KEEP.of(spec) {
        "small" => Design::SMALL,
        "medium" => Design::MEDIUM,
        _ => Design::LARGE,
    };
    ranged(spec, design)
}

/// A design over the range that is asked for.
fn ranged(spec: &MethodSpec, design: Design) -> Design {
    let extent = match RANGE.of(spec) {
        "frame" => Extent::Frame,
        _ => Extent::Pixel,
    };
    Design { extent, ..design }
}

fn is_small(spec: &MethodSpec) -> bool {
    KEEP.of(spec) == "small"
}

const fn promises(_: &MethodSpec) -> Promises {
    Promises {
        tinted: true,
        ..Promises::NORMALISED
    }
}

const THIN: Flaw = Flaw::unsettled(Property::Order, &["thin-slab"]);

const BORDERS: Flaw = Flaw::new(
    Property::Steady,
    &["moving-camera"],
    "what lies between a slab's known ends is guessed, and where a layer passes a slab's border it is another guess, or none",
);

const COINCIDENT: Flaw = Flaw::new(
    Property::Transmittance,
    &["coplanar"],
    "without a mean depth sixteen coincident layers between a slab's ends count as partly in front of each, and of what lies behind them",
);

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Word(KEEP), Parameter::Word(RANGE)],
    promises,
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
        let half = SumPrecision::Half;
        Some(slabs::weights(
            fragments,
            warp,
            design(s),
            half,
            slabs::middle,
        ))
    }),
    flaws: &[
        Flaw::swallowed(&["alpha-tiny"]).when(|s| !is_small(s)),
        Flaw::swallowed(&["deep"]).when(is_small),
        Flaw::reordered(&["deep"]).when(is_small),
        THIN,
        BORDERS,
        COINCIDENT.when(is_small),
    ],
    ..Method::new(
        "slabs",
        "four slabs of depth in the pixel's range, each with its own sums and known ends; no network",
        build_plain,
    )
};

/// The weights that a network gives a pixel's fragments.
fn transmittances(
    spec: &MethodSpec,
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    model: Option<&Model>,
) -> Option<Vec<f64>> {
    let model = model?;
    let Inputs::Slabs(design, features) = model.meta.recipe.inputs else {
        return None;
    };
    let (design, half) = (ranged(spec, design), SumPrecision::Half);
    Some(slabs::weights(fragments, warp, design, half, |between| {
        model.answer(features, between)
    }))
}

fn twin(spec: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let model = p.model?;
    let Inputs::Slabs(design, features) = model.meta.recipe.inputs else {
        return None;
    };
    Some(slabs::composite(
        p.fragments,
        p.background,
        &p.warp,
        ranged(spec, design),
        |between| model.answer(features, between),
    ))
}

/// What the three sizes have in common.
macro_rules! learned {
    ($name:literal, $about:literal) => {
        Method {
            learned: true,
            parameters: &[Parameter::Word(RANGE)],
            promises,
            twin: Some(twin),
            transmittances: Some(transmittances),
            ..Method::new($name, $about, build_learned)
        }
    };
}

pub(super) const SMALL: Method = Method {
    flaws: &[
        Flaw::swallowed(&["deep"]),
        THIN,
        BORDERS,
        COINCIDENT,
        MAGNIFIED,
        Flaw::new(
            Property::Scale,
            &["coplanar"],
            "depths are rounded otherwise, which moves coincident layers into another bin, and without a mean depth the guess with them",
        )
        .seen_on_llvmpipe(),
    ],
    ..learned!(
        "deep-small",
        "known layers of four slabs and a learned guess between them, 32 bytes a pixel"
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":range=frame", ":scale=0.5"],
    flaws: &[
        THIN,
        BORDERS,
        Flaw::new(
            Property::Scale,
            &["thin-slab"],
            "depths are rounded otherwise, which moves layers of one bin into another, and other ones are known then",
        )
        .seen_on_llvmpipe(),
    ],
    ..learned!(
        "deep-medium",
        "the same in 38 bytes a pixel: the one to ship"
    )
};

pub(super) const LARGE: Method = Method {
    curve: &["", ":range=frame"],
    flaws: &[Flaw::swallowed(&["deep"]), THIN, BORDERS],
    ..learned!(
        "deep-large",
        "the same in 46 bytes a pixel: the most accurate"
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

fn build_learned(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let Inputs::Slabs(design, _) = learned.recipe.inputs else {
        unreachable!("the recipe of a method of slabs reads slabs");
    };
    build(b, ranged(b.spec, design), &learned.wgsl)
}

fn build_plain(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let design = design(b.spec);
    let mut text = String::from(
        "// The guess without a network: the middle between the bounds.\n\
         fn peelnet_network(between: PeelnetBetween) -> f32 {\n    return 0.5;\n}\n",
    );
    for module in peelnet_shaders::slab_modules(design.keeps_few(), design.apart) {
        text.push_str(peelnet_shaders::source(module)?);
    }
    build(b, design, &text)
}

fn build(b: &Build<'_>, design: Design, text: &str) -> Result<Box<dyn Compositor>, RenderError> {
    let few = design.keeps_few();
    let framed = design.extent == Extent::Frame;
    let mut targets = vec![
        SUMS,
        half("absorbances of slabs", 4, Blend::Add),
        half("nearest of slabs", 4, Blend::Max),
    ];
    targets.push(if few {
        half("farthest of the nearest slab", 1, Blend::Max)
    } else {
        half("farthest of three slabs and mean of one", 4, Blend::MaxAdd)
    });
    targets.push(half("means of two slabs", 2, Blend::Add));
    let kept: Vec<usize> = (1..targets.len()).collect();
    let mut reads = kept.clone();
    let mut statistics_reads = Vec::new();
    if !framed {
        reads.push(targets.len());
        statistics_reads.push(targets.len());
        targets.push(half("range of depths", 2, Blend::MaxBytes));
    }
    let (mut sums, mut resolve_reads) = (vec![0], vec![0, 1]);
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
    let mut statistics_features = Vec::new();
    for (feature, on) in [("few", few), ("frame", framed)] {
        features.extend(on.then_some(feature));
        statistics_features.extend(on.then_some(feature));
    }
    let extra = [("learned::weight", text)];
    let range = Gather {
        label: "range",
        shader: "methods::slabs::range",
        extra: &extra,
        writes: &statistics_reads,
        ..Gather::NONE
    };
    let statistics = Gather {
        label: "statistics",
        shader: "methods::slabs::statistics",
        features: &statistics_features,
        extra: &extra,
        writes: &kept,
        reads: &statistics_reads,
        ..Gather::NONE
    };
    let gather = Gather {
        label: "gather",
        shader: "methods::slabs::gather",
        features: &features,
        extra: &extra,
        writes: &sums,
        reads: &reads,
        ..Gather::NONE
    };
    let passes = [range, statistics, gather];
    let passes = &passes[usize::from(framed)..];
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes,
            resolve: "methods::slabs::resolve",
            resolve_features: &resolve_features,
            resolve_extra: &extra,
            resolve_reads: &resolve_reads,
            tinted_by: Some(passes.len() - 1),
            ..Plan::NONE
        },
    )
}
