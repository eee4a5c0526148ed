//! `mboit4`, `mboit6` and `mboit8`: moment-based transparency with four, six and eight power moments (Münstermann et al. 2018).

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    method::{Method, Promises, Role},
    parameter::{MOMENT_TARGETS, Number, Parameter, Precision, Word},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_statistics, half_sums},
};
use peelnet_core::methods::{
    mboit4, mboit6, mboit8,
    moments::{self, Settings},
};
use std::ops::Bound;

pub(super) const OVERESTIMATION: Number = Number {
    name: "overestimation",
    about: "0.25 by default",
    default: Settings::PAPER.overestimation,
    least: Bound::Included(0.0),
    most: 1.0,
};

/// The default is that of 32-bit moments.
const BIAS_4: Number = Number {
    name: "bias",
    about: "5e-7 by default, 6e-5 with 16-bit moments",
    default: Settings::PAPER.bias,
    least: Bound::Included(0.0),
    most: 1.0,
};

const BIAS_6: Number = Number {
    name: "bias",
    about: "5e-6 by default, 6e-4 with 16-bit moments",
    default: mboit6::PAPER.bias,
    least: Bound::Included(0.0),
    most: 1.0,
};

const BIAS_8: Number = Number {
    name: "bias",
    about: "5e-5 by default, 2.5e-3 with 16-bit moments",
    default: mboit8::PAPER.bias,
    least: Bound::Included(0.0),
    most: 1.0,
};

pub(super) const OWN: Word = Word {
    name: "own",
    about: "in (default, as published) or out: a fragment's own absorbance",
    words: &["in", "out"],
};

pub(super) fn own_out(spec: &MethodSpec) -> bool {
    OWN.of(spec) == "out"
}

/// The bias that was given, or the paper's for the moments' precision.
pub(super) fn bias(spec: &MethodSpec, bias: Number, half: f64) -> f64 {
    let paper = if half_statistics(spec) {
        half
    } else {
        bias.default
    };
    bias.given(spec).unwrap_or(paper)
}

pub(super) fn settings(spec: &MethodSpec, bias: f64) -> Settings {
    Settings {
        overestimation: OVERESTIMATION.of(spec),
        bias,
        own_share_out: own_out(spec),
    }
}

fn settings_4(spec: &MethodSpec) -> Settings {
    settings(spec, bias(spec, BIAS_4, 6e-5))
}

fn settings_6(spec: &MethodSpec) -> Settings {
    settings(spec, bias(spec, BIAS_6, 6e-4))
}

fn settings_8(spec: &MethodSpec) -> Settings {
    settings(spec, bias(spec, BIAS_8, mboit8::BIAS_HALF))
}

pub(super) fn promises(spec: &MethodSpec, root: u32) -> Promises {
    Promises {
        own_share: if own_out(spec) {
            0.0
        } else {
            OVERESTIMATION.of(spec)
        },
        tinted: true,
        statistics: Precision::Full,
        root: Some(root),
        ..Promises::NORMALISED
    }
}

pub(super) const BLURRED: Flaw = Flaw::new(
    Property::Opaque,
    &["alpha-near-one"],
    "moments blur what lies close together (Münstermann et al. 2018)",
);

const BLURRED_BEHIND_COINCIDENT: Flaw = Flaw::new(
    Property::Transmittance,
    &["coplanar"],
    "moments blur a layer close to sixteen coincident ones: its transmittance is off by 0.13",
);

const fn jumping(cases: &'static [&'static str]) -> Flaw {
    let reason =
        "16-bit moments without the paper's quantisation: roots jump where they come close";
    Flaw::new(Property::Steady, cases, reason)
        .when(half_statistics)
        .seen_on_llvmpipe()
}

pub(super) const FOUR: Method = Method {
    parameters: &[
        MOMENT_TARGETS,
        Parameter::Number(OVERESTIMATION),
        Parameter::Number(BIAS_4),
        Parameter::Word(OWN),
    ],
    promises: |s| promises(s, 2),
    curve: &[
        "",
        ":targets=f16",
        ":overestimation=0.5",
        ":own=out",
        ":scale=0.5",
    ],
    roles: &[(Role::MomentBlending, "mboit4")],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        let empty = mboit4::Moments::default();
        Some(moments::composite(
            fragments,
            c0,
            &p.warp,
            empty,
            &settings_4(s),
        ))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let empty = mboit4::Moments::default();
        Some(moments::transmittances(
            fragments,
            warp,
            empty,
            &settings_4(s),
        ))
    }),
    flaws: &[
        Flaw::swallowed(&["deep", "near-overflow"]),
        BLURRED,
        BLURRED_BEHIND_COINCIDENT,
        jumping(&["passing"]),
        Flaw::unsettled(Property::Transmittance, &["isolated"]),
        Flaw::unsettled(
            Property::Order,
            &[
                "alpha-near-one",
                "grazing",
                "high-alpha",
                "intersecting",
                "moving-camera",
                "passing",
            ],
        ),
        Flaw::reordered(&["deep", "near-overflow"]),
    ],
    ..Method::new(
        "mboit4",
        "Münstermann et al. 2018, four power moments",
        four,
    )
};

pub(super) const SIX: Method = Method {
    parameters: &[
        MOMENT_TARGETS,
        Parameter::Number(OVERESTIMATION),
        Parameter::Number(BIAS_6),
        Parameter::Word(OWN),
    ],
    promises: |s| promises(s, 3),
    curve: &["", ":own=out"],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        let empty = mboit6::Moments::default();
        Some(moments::composite(fragments, c0, &p.warp, empty, &settings_6(s)))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let empty = mboit6::Moments::default();
        Some(moments::transmittances(fragments, warp, empty, &settings_6(s)))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        BLURRED.when(half_statistics).seen_on_llvmpipe(),
        jumping(&["passing", "moving-camera"]),
        Flaw::unsettled(Property::Transmittance, &["isolated", "two-layers"]),
        Flaw::unsettled(
            Property::Order,
            &[
                "deep",
                "emissive",
                "grazing",
                "high-alpha",
                "intersecting",
                "moving-camera",
                "opaque-mix",
                "two-layers",
            ],
        ),
        Flaw::unsettled(Property::Order, &["passing"]),
        Flaw::new(
            Property::Order,
            &["passing", "wide-range"],
            "six moments in 32 bits: where points come close, roundings of the sums move the others",
        )
        .when(|s| !half_statistics(s))
        .seen_on_llvmpipe(),
    ],
    ..Method::new("mboit6", "Münstermann et al. 2018, six power moments", six)
};

pub(super) const EIGHT: Method = Method {
    parameters: &[
        MOMENT_TARGETS,
        Parameter::Number(OVERESTIMATION),
        Parameter::Number(BIAS_8),
        Parameter::Word(OWN),
    ],
    promises: |s| promises(s, 4),
    curve: &["", ":own=out"],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        let empty = mboit8::Moments::default();
        Some(moments::composite(
            fragments,
            c0,
            &p.warp,
            empty,
            &settings_8(s),
        ))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let empty = mboit8::Moments::default();
        Some(moments::transmittances(
            fragments,
            warp,
            empty,
            &settings_8(s),
        ))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::swallowed(&["near-overflow"]).when(|s| own_out(s) && half_sums(s)),
        BLURRED.when(half_statistics).seen_on_llvmpipe(),
        jumping(&["passing", "moving-camera"]),
        Flaw::unsettled(Property::Transmittance, &["isolated", "two-layers"]),
        Flaw::unsettled(
            Property::Order,
            &[
                "alpha-near-one",
                "deep",
                "emissive",
                "far",
                "grazing",
                "high-alpha",
                "intersecting",
                "moving-camera",
                "near-overflow",
                "opaque-mix",
                "passing",
                "two-layers",
            ],
        ),
    ],
    ..Method::new(
        "mboit8",
        "Münstermann et al. 2018, eight power moments, in two passes",
        eight,
    )
};

pub(super) const fn moments(label: &'static str, channels: u32) -> Target {
    Target {
        label,
        channels,
        full: true,
        blend: Blend::Add,
    }
}

/// What numbers of moments differ in.
struct Order {
    targets: &'static [Target],
    moments: &'static str,
    /// Passes that sum moments: the shader's features, and the targets that it writes.
    parts: &'static [(&'static [&'static str], &'static [usize])],
    gather: &'static str,
    /// The targets that hold moments.
    reads: &'static [usize],
}

const FOUR_MOMENTS: Order = Order {
    targets: &[SUMS, moments("absorbance", 1), moments("moments", 4)],
    moments: "methods::mboit4::moments",
    parts: &[(&[], &[1, 2])],
    gather: "methods::mboit4::gather",
    reads: &[1, 2],
};

const SIX_MOMENTS: Order = Order {
    targets: &[
        SUMS,
        moments("absorbance", 1),
        moments("moments 1 to 4", 4),
        moments("moments 5 and 6", 2),
    ],
    moments: "methods::mboit6::moments",
    parts: &[(&[], &[1, 2, 3])],
    gather: "methods::mboit6::gather",
    reads: &[1, 2, 3],
};

const EIGHT_MOMENTS: Order = Order {
    targets: &[
        SUMS,
        moments("absorbance", 1),
        moments("moments 1 to 4", 4),
        moments("moments 5 to 8", 4),
    ],
    moments: "methods::mboit8::moments",
    parts: &[(&["lower"], &[1, 2]), (&["upper"], &[3])],
    gather: "methods::mboit8::gather",
    reads: &[1, 2, 3],
};

fn four(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, &FOUR_MOMENTS, &settings_4(b.spec))
}

fn six(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, &SIX_MOMENTS, &settings_6(b.spec))
}

fn eight(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, &EIGHT_MOMENTS, &settings_8(b.spec))
}

fn build(
    b: &Build<'_>,
    order: &Order,
    settings: &Settings,
) -> Result<Box<dyn Compositor>, RenderError> {
    let (bias, overestimation) = (settings.bias as f32, settings.overestimation as f32);
    let features = own_share(settings.own_share_out);
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    let parameters =
        format!("const BIAS: f32 = {bias:?};\nconst OVERESTIMATION: f32 = {overestimation:?};\n");
    let sums = order.parts.iter().map(|&(features, writes)| Gather {
        label: "moments",
        shader: order.moments,
        features,
        writes,
        ..Gather::NONE
    });
    let mut passes: Vec<Gather<'_>> = sums.collect();
    let extra = [("parameters", parameters.as_str())];
    passes.push(Gather {
        shader: order.gather,
        features,
        extra: &extra,
        writes: &[0],
        reads: order.reads,
        ..Gather::NONE
    });
    commutative::build(
        b,
        &Plan {
            targets: order.targets,
            tinted_by: Some(passes.len() - 1),
            passes: &passes,
            resolve: "methods::mboit4::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}

/// The shader feature that leaves a fragment's own absorbance out of the absorbance in front of it.
pub(super) const fn own_share(out: bool) -> &'static [&'static str] {
    if out { &["own_share_out"] } else { &[] }
}
