//! `mboit-trig-M`: moment-based transparency with M trigonometric moments (Münstermann et al. 2018, supplement). The CPU twin is
//! `peelnet_core::methods::mboit_trig`.

use super::{
    commutative::{self, Gather, Plan},
    compositor::{Build, Compositor},
    mboit::{BLURRED, OVERESTIMATION, OWN, bias, moments, own_out, own_share, promises, settings},
    method::{Method, Numbered},
    parameter::{MOMENT_TARGETS, Number, Parameter},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_statistics, half_sums},
};
use peelnet_core::methods::{
    mboit_trig::{self, Moments},
    moments::{self, Settings},
};
use std::ops::Bound;

const BIAS: Number = Number {
    name: "bias",
    about: "1e-4 by default, 1e-3 with 16-bit moments",
    default: mboit_trig::BIAS,
    least: Bound::Included(0.0),
    most: 1.0,
};

fn settings_of(spec: &MethodSpec) -> Settings {
    settings(spec, bias(spec, BIAS, mboit_trig::BIAS_HALF))
}

pub(super) const METHOD: Method = Method {
    numbered: Some(Numbered {
        least: 2,
        most: 3,
        power_of_two: false,
    }),
    parameters: &[
        MOMENT_TARGETS,
        Parameter::Number(OVERESTIMATION),
        Parameter::Number(BIAS),
        Parameter::Word(OWN),
    ],
    promises: |s| promises(s, s.number()),
    curve: &["-2", "-3", "-3:own=out", "-2:targets=f16"],
    twin: Some(|s, p| {
        let empty = Moments::new(s.number() as usize);
        Some(moments::composite(
            p.fragments,
            p.background,
            &p.warp,
            empty,
            &settings_of(s),
        ))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let empty = Moments::new(s.number() as usize);
        Some(moments::transmittances(
            fragments,
            warp,
            empty,
            &settings_of(s),
        ))
    }),
    flaws: &[
        Flaw::swallowed(&["deep", "near-overflow"]),
        Flaw::swallowed(&["alpha-tiny"]).when(|s| s.number() == 2 && half_statistics(s)),
        BLURRED.when(|s| !own_out(s) && (s.number() != 3 || half_statistics(s))),
        Flaw::new(
            Property::Transmittance,
            &["two-layers"],
            "sines and cosines of close layers in 32 bits: roundings of the sums move the points; a bias of 1e-3 hides it",
        )
        .when(|s| !own_out(s) && !half_statistics(s))
        .seen_on_llvmpipe(),
        Flaw::new(
            Property::Order,
            &["coplanar"],
            "sines and cosines of coincident pairs in 32 bits: roundings of the sums move the points",
        )
        .when(|s| !half_statistics(s))
        .seen_on_llvmpipe(),
        Flaw::new(
            Property::Order,
            &["intersecting", "moving-camera"],
            "roundings of the sums move the points where surfaces cross, in 32 bits as well",
        )
        .seen_on_llvmpipe(),
        Flaw::unsettled(Property::Order, &["deep", "emissive", "high-alpha", "passing"]),
        Flaw::reordered(&["near-overflow"]).when(|s| half_sums(s) && !half_statistics(s)),
    ],
    ..Method::new(
        "mboit-trig",
        "Münstermann et al. 2018, M trigonometric moments, two values each",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let count = b.spec.number();
    let Settings {
        overestimation,
        bias,
        own_share_out,
    } = settings_of(b.spec);
    let mut targets = vec![
        SUMS,
        moments("absorbance", 1),
        moments("moments 1 and 2", 4),
    ];
    let mut written = vec![1, 2];
    let mut statistics = vec![];
    let mut features = own_share(own_share_out).to_vec();
    if count == 3 {
        written.push(targets.len());
        targets.push(moments("moment 3", 2));
        statistics.push("upper");
        features.push("upper");
    }
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    let parameters = format!(
        "const BIAS: f32 = {:?};\nconst OVERESTIMATION: f32 = {:?};\nconst MOMENTS: i32 = {count};\n",
        bias as f32, overestimation as f32
    );
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes: &[
                Gather {
                    label: "moments",
                    shader: "methods::mboit_trig::moments",
                    features: &statistics,
                    writes: &written,
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::mboit_trig::gather",
                    features: &features,
                    extra: &[("parameters", &parameters)],
                    writes: &[0],
                    reads: &written,
                    ..Gather::NONE
                },
            ],
            tinted_by: Some(1),
            resolve: "methods::mboit4::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
