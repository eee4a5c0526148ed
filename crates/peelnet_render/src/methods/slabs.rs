//! `deep-small`, `deep-medium`, `deep-large`: known layers without ordered access, in three or four slabs of the pixel's own range, and a learned
//! guess of what lies between them, drawn with the exported text itself. `slabs` is the same without a network. The CPU twin is
//! `peelnet_core::methods::slabs`.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
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
    methods::slabs::{self, Design, Extent, Layout},
    statistics::SumPrecision,
};
use peelnet_model::{Inputs, Model};

const KEEP: Word = Word {
    name: "keep",
    about: "large (default, 42 bytes a pixel): four slabs; medium (34 bytes): three; small (30 bytes): three, and the farthest fragment of the nearest alone",
    words: &["large", "medium", "small"],
};

const RANGE: Word = Word {
    name: "range",
    about: "what is cut into slabs: the pixel's own range of depth (pixel, by default), found by a geometry pass of its own; from where the pixel's ray enters the first box around a transparent part to where it leaves the last (boxes), found by a pass over boxes; or the frame's (frame), with a pass less and several times the error",
    words: &["pixel", "boxes", "frame"],
};

fn asked(spec: &MethodSpec) -> Layout {
    let name = KEEP.of(spec);
    let found = Layout::ALL.into_iter().find(|l| l.name() == name);
    found.unwrap_or(Layout::Large)
}

/// A design over the range that is asked for, for the CPU twin. Lists of fragments have no boxes: what is drawn with them has none.
fn ranged(spec: &MethodSpec, design: Design) -> Option<Design> {
    let extent = match RANGE.of(spec) {
        "boxes" => return None,
        "frame" => Extent::Frame,
        _ => Extent::Pixel,
    };
    Some(Design { extent, ..design })
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

fn is_of_pixel(spec: &MethodSpec) -> bool {
    RANGE.of(spec) == "pixel"
}

const BORDERS: Flaw = Flaw::new(
    Property::Steady,
    &["moving-camera"],
    "what lies between a slab's known ends is guessed, and where a layer passes a slab's border it is another guess, or none",
);

const COINCIDENT: Flaw = Flaw::new(
    Property::Transmittance,
    &["coplanar"],
    "sixteen coincident layers are a slab's nearest all at once, and without its farthest what lies behind them is guessed",
);

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Word(KEEP), Parameter::Word(RANGE)],
    promises,
    curve: &["", ":keep=medium", ":keep=small"],
    twin: Some(|s, p| {
        let design = ranged(s, asked(s).design())?;
        let (fragments, c0, warp) = (p.fragments, p.background, &p.warp);
        let guess = slabs::middle;
        Some(slabs::composite(fragments, c0, warp, design, guess))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let design = ranged(s, asked(s).design())?;
        let half = SumPrecision::Half;
        Some(slabs::weights(fragments, warp, design, half, slabs::middle))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::reordered(&["deep"]),
        BORDERS.when(is_of_pixel),
        COINCIDENT.when(is_small),
    ],
    ..Method::new(
        "slabs",
        "slabs of depth in the pixel's range, each with its own sums and known ends; no network",
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
    let (design, half) = (ranged(spec, design)?, SumPrecision::Half);
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
        ranged(spec, design)?,
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
        BORDERS.when(is_of_pixel),
        COINCIDENT,
    ],
    ..learned!(
        "deep-small",
        "known layers of three slabs and a learned guess between them, 30 bytes a pixel"
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":range=boxes", ":range=frame", ":scale=0.5"],
    flaws: &[Flaw::swallowed(&["deep"])],
    ..learned!(
        "deep-medium",
        "the same in 34 bytes a pixel: the one to ship"
    )
};

pub(super) const LARGE: Method = Method {
    curve: &["", ":range=boxes", ":range=frame"],
    flaws: &[Flaw::swallowed(&["deep"])],
    ..learned!(
        "deep-large",
        "the same of four slabs, 42 bytes a pixel: the most accurate"
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

/// What the statistics pass writes.
fn kept(layout: Layout) -> Vec<Target> {
    match layout {
        Layout::Small => vec![
            half("absorbances of slabs and mean of one", 4, Blend::Add),
            half("nearest of slabs and farthest of one", 4, Blend::Max),
            half("means of two slabs", 2, Blend::Add),
        ],
        Layout::Medium => vec![
            half("absorbances of slabs and mean of one", 4, Blend::Add),
            half("nearest of slabs and mean of one", 4, Blend::MaxAdd),
            half("farthest of slabs and mean of one", 4, Blend::MaxAdd),
        ],
        Layout::Large => vec![
            half("absorbances of slabs", 4, Blend::Add),
            half("nearest of slabs", 4, Blend::Max),
            half("farthest of slabs", 4, Blend::Max),
            half("means of slabs", 4, Blend::Add),
        ],
    }
}

fn build_learned(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let learned = b.learned_weight()?;
    let Inputs::Slabs(design, _) = learned.recipe.inputs else {
        unreachable!("the recipe of a method of slabs reads slabs");
    };
    let layout = design.layout();
    let layout = layout.expect("recipes that are drawn keep what a layout holds");
    build(b, layout, &learned.wgsl)
}

fn build_plain(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let layout = asked(b.spec);
    let mut text = String::from(
        "// The guess without a network: the middle between the bounds.\n\
         fn peelnet_network(between: PeelnetBetween) -> f32 {\n    return 0.5;\n}\n",
    );
    for module in peelnet_shaders::slab_modules(layout.name()) {
        text.push_str(peelnet_shaders::source(module)?);
    }
    build(b, layout, &text)
}

fn build(b: &Build<'_>, layout: Layout, text: &str) -> Result<Box<dyn Compositor>, RenderError> {
    let [framed, boxes] = ["frame", "boxes"].map(|word| RANGE.of(b.spec) == word);
    let mut targets = vec![SUMS];
    targets.extend(kept(layout));
    let kept: Vec<usize> = (1..targets.len()).collect();
    let mut reads = kept.clone();
    let mut statistics_reads = Vec::new();
    if !framed {
        reads.push(targets.len());
        statistics_reads.push(targets.len());
        targets.push(half("range of depths", 2, Blend::MaxBytes));
    }
    let mut features = Vec::new();
    // The shaders' own case is the largest.
    features.extend((layout != Layout::Large).then_some(layout.name()));
    features.extend(framed.then_some("frame"));
    let resolve_features: &[&str] = match layout {
        Layout::Small | Layout::Medium => &["three"],
        Layout::Large => &[],
    };
    let extra = [("learned::weight", text)];
    let range = Gather {
        label: "range",
        shader: if boxes {
            "methods::slabs::boxes"
        } else {
            "methods::slabs::range"
        },
        extra: &extra,
        writes: &statistics_reads,
        boxes,
        ..Gather::NONE
    };
    let statistics = Gather {
        label: "statistics",
        shader: "methods::slabs::statistics",
        features: &features,
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
        writes: &[0],
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
            resolve_features,
            resolve_extra: &extra,
            resolve_reads: &[0, 1],
            tinted_by: Some(passes.len() - 1),
            ..Plan::NONE
        },
    )
}
