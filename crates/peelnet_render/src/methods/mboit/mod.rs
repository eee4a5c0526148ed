//! `mboit4`, `mboit6` and `mboit8`: moment-based transparency with four, six and eight power moments (Münstermann et al. 2018), and
//! `mboit-trig-M`, with M trigonometric moments (its supplement).

mod expectations;

use crate::methods::prelude::*;
use peelnet_core::methods::moments::{Settings, trigonometric};

const OVERESTIMATION: Parameter = Parameter::share(
    "overestimation",
    "0.25 by default",
    Settings::FOUR.overestimation,
);

/// The default is that of 32-bit moments.
const fn bias(about: &'static str, default: f64) -> Parameter {
    Parameter::share("bias", about, default)
}

const BIAS_4: Parameter = bias(
    "5e-7 by default, 6e-5 with 16-bit moments",
    Settings::FOUR.bias,
);

const BIAS_6: Parameter = bias(
    "5e-6 by default, 6e-4 with 16-bit moments",
    Settings::SIX.bias,
);

const BIAS_8: Parameter = bias(
    "5e-5 by default, 2.5e-3 with 16-bit moments",
    Settings::EIGHT.bias,
);

const BIAS_TRIG: Parameter = bias(
    "1e-4 by default, 1e-3 with 16-bit moments",
    trigonometric::BIAS,
);

const OWN: Parameter = Parameter::words(
    "own",
    "in (default, as published) or out: a fragment's own absorbance",
    &["in", "out"],
);

fn own_out(spec: &MethodSpec) -> bool {
    OWN.word(spec) == "out"
}

/// The paper's settings for the moments' number, the parameter of the bias, and its default for 16-bit moments.
fn published(spec: &MethodSpec) -> (Settings, Parameter, f64) {
    match spec.name() {
        "mboit4" => (Settings::FOUR, BIAS_4, 6e-5),
        "mboit6" => (Settings::SIX, BIAS_6, 6e-4),
        "mboit8" => (Settings::EIGHT, BIAS_8, 2.5e-3),
        _ => {
            let paper = Settings::trigonometric(spec.number() as usize);
            (paper, BIAS_TRIG, trigonometric::BIAS_HALF)
        }
    }
}

/// The settings that were asked for; by default the published ones for the moments' precision.
fn settings(spec: &MethodSpec) -> Settings {
    let (paper, bias, of_half) = published(spec);
    Settings {
        overestimation: OVERESTIMATION.number(spec),
        bias: match bias.given::<f64>(spec) {
            None if half_statistics(spec) => of_half,
            _ => bias.number(spec),
        },
        own_absorbance_out: own_out(spec),
        ..paper
    }
}

const fn estimated(name: &'static str, about: &'static str) -> Method {
    Method {
        expectations: expectations::ESTIMATED,
        ..Method::new(name, about, passes)
    }
}

pub(super) const FOUR: Method = Method {
    parameters: &[MOMENT_TARGETS, OVERESTIMATION, BIAS_4, OWN],
    curve: &[
        "",
        ":targets=f16",
        ":overestimation=0.5",
        ":own=out",
        ":scale=0.5",
    ],
    expectations: expectations::FOUR,
    ..estimated("mboit4", "Münstermann et al. 2018, four power moments")
};

pub(super) const SIX: Method = Method {
    parameters: &[MOMENT_TARGETS, OVERESTIMATION, BIAS_6, OWN],
    curve: &["", ":own=out"],
    expectations: expectations::SIX,
    ..estimated("mboit6", "Münstermann et al. 2018, six power moments")
};

pub(super) const EIGHT: Method = Method {
    parameters: &[MOMENT_TARGETS, OVERESTIMATION, BIAS_8, OWN],
    curve: &["", ":own=out"],
    expectations: expectations::EIGHT,
    ..estimated(
        "mboit8",
        "Münstermann et al. 2018, eight power moments, in two passes",
    )
};

pub(super) const TRIGONOMETRIC: Method = Method {
    numbered: Numbered::range(2, 3),
    parameters: &[MOMENT_TARGETS, OVERESTIMATION, BIAS_TRIG, OWN],
    curve: &["-2", "-3", "-3:own=out", "-2:targets=f16"],
    expectations: expectations::TRIGONOMETRIC,
    ..estimated(
        "mboit-trig",
        "Münstermann et al. 2018, M trigonometric moments, two values each",
    )
};

/// What a pass that sums moments has as its feature, and its targets with their channels.
type Part = (Option<&'static str>, &'static [(&'static str, u32)]);

fn passes(p: &mut Passes<'_>) {
    let (name, number) = (p.on.spec.name(), p.on.spec.number());
    let (folder, parts): (_, &[Part]) = match (name, number) {
        ("mboit4", _) => ("four", &[(None, &[("higher", 4)])]),
        ("mboit6", _) => ("six", &[(None, &[("lower", 4), ("higher", 2)])]),
        ("mboit8", _) => (
            "eight",
            &[
                (Some("lower"), &[("lower", 4)]),
                (Some("upper"), &[("upper", 4)]),
            ],
        ),
        (_, 2) => ("trigonometric", &[(None, &[("lower", 4)])]),
        _ => (
            "trigonometric",
            &[(Some("upper"), &[("lower", 4), ("upper", 2)])],
        ),
    };
    let settings = settings(p.on.spec);
    let (bias, overestimation) = (settings.bias as f32, settings.overestimation as f32);
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    p.parameters = format!(
        "const BIAS: f32 = {bias:?};\nconst OVERESTIMATION: f32 = {overestimation:?};\nconst MOMENTS: i32 = {number};\n"
    );
    let target = |&(label, channels): &(_, _)| Target::full(label, channels, Blend::Add);
    let sums = p.target(SUMS);
    let absorbance = p.target(target(&("zeroth", 1)));
    let (mut found, mut written) = (Vec::new(), vec![absorbance]);
    for (feature, targets) in parts {
        written.extend(p.targets(targets.iter().map(target)));
        found.extend(written.iter().copied());
        p.geometry(
            &format!("methods::mboit::{folder}::moments"),
            Needs::OPACITY,
        )
        .features(*feature)
        .writes(written.drain(..));
    }
    p.geometry(&format!("methods::mboit::{folder}::gather"), Needs::COLOR)
        .features(own_share(settings.own_absorbance_out))
        .features((number == 3).then_some("upper"))
        .reads(found)
        .writes([sums]);
    p.resolve("methods::mboit::four::resolve", [sums, absorbance]);
    p.tint();
}

/// The shader feature that leaves a fragment's own absorbance out of the absorbance in front of it.
pub(super) fn own_share(out: bool) -> Option<&'static str> {
    out.then_some("own_share_out")
}
