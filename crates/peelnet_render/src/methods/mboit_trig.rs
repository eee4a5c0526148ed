//! `mboit-trig-M`: moment-based transparency with M trigonometric moments (Münstermann et al. 2018, supplement). The CPU twin is
//! `peelnet_core::methods::mboit_trig`.

use super::{
    commutative::{self, Gather, Plan},
    compositor::{Build, Compositor},
    mboit::{
        BLURRED, OVERESTIMATION, OWN, OWN_SHARE, bias, jumping, moments, own_out, own_share,
        promises, settings,
    },
    method::{Method, Numbered},
    parameter::{MOMENT_TARGETS, Number, Parameter, Precision},
    spec::MethodSpec,
    weighted::SUMS,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, half_statistics},
};
use peelnet_core::methods::{mboit_trig, mboit4::Settings};
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
        most: 4,
        power_of_two: false,
    }),
    parameters: &[
        MOMENT_TARGETS,
        Parameter::Number(OVERESTIMATION),
        Parameter::Number(BIAS),
        Parameter::Word(OWN),
    ],
    promises: |s| promises(s.number()),
    curve: &["-2", "-3", "-4", "-3:own=out", "-2:targets=f16"],
    twin: Some(|s, p| {
        let (fragments, c0, count) = (p.fragments, p.background, s.number() as usize);
        let settings = settings_of(s);
        Some(mboit_trig::composite(
            fragments, c0, &p.warp, count, &settings,
        ))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let (count, settings) = (s.number() as usize, settings_of(s));
        Some(mboit_trig::transmittances(
            fragments, warp, count, &settings,
        ))
    }),
    flaws: &[
        Flaw::swallowed(&["deep", "near-overflow"]),
        Flaw::swallowed(&["alpha-tiny"]).when(|s| s.number() == 2 && half_statistics(s)),
        BLURRED.when(|s| !own_out(s) && (s.number() != 3 || half_statistics(s))),
        jumping(&["passing"]).when(|s| s.number() == 4 && half_statistics(s)),
        OWN_SHARE,
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
    match count {
        3 => targets.push(moments("moment 3", 2)),
        4 => targets.push(moments("moments 3 and 4", 4)),
        _ => {}
    }
    // Absorbance and four moments in 32 bits are more than the 32 bytes a pixel that one pass of portable WebGPU writes.
    let parts: &[(&[&str], &[usize])] = match (count, b.spec.targets()) {
        (2, _) => &[(&["lower"], &[1, 2])],
        (4, None | Some(Precision::Full)) => &[(&["lower"], &[1, 2]), (&["upper"], &[3])],
        _ => &[(&["lower", "upper"], &[1, 2, 3])],
    };
    let mut features = own_share(own_share_out).to_vec();
    features.extend((count > 2).then_some("upper"));
    let reads: Vec<usize> = (1..targets.len()).collect();
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    let parameters = format!(
        "const BIAS: f32 = {:?};\nconst OVERESTIMATION: f32 = {:?};\nconst MOMENTS: i32 = {count};\n",
        bias as f32, overestimation as f32
    );
    let extra = [("parameters", parameters.as_str())];
    let mut passes: Vec<Gather<'_>> = parts
        .iter()
        .map(|&(features, writes)| Gather {
            label: "moments",
            shader: "methods::mboit_trig::moments",
            features,
            writes,
            ..Gather::NONE
        })
        .collect();
    passes.push(Gather {
        shader: "methods::mboit_trig::gather",
        features: &features,
        extra: &extra,
        writes: &[0],
        reads: &reads,
        ..Gather::NONE
    });
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            tinted_by: Some(passes.len() - 1),
            passes: &passes,
            resolve: "methods::mboit4::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
