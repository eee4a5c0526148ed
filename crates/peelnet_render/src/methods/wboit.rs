//! `wboit-*`: the weighted mean colour with the exact coverage (McGuire & Bavoil 2013, eq 6), by a named weight.

use super::{
    commutative::Gather,
    compositor::{Build, Compositor},
    method::{Method, Promises, Role},
    parameter::{Number, Parameter, TARGETS, Whole},
    weighted::{COMPOSITE, build_sums, gather, is_printed},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::{fragment::Fragment, methods::wboit, weights::Weight};
use std::ops::Bound;

const FACTOR: Number = Number {
    name: "factor",
    about: "largest weight, 3e3 by default",
    default: 3e3,
    least: Bound::Excluded(0.0),
    most: 1e9,
};

const EXPONENT: Whole = Whole {
    name: "k",
    about: "a whole exponent, 2 by default",
    default: 2,
    most: 16,
};

const EPSILON: Number = Number {
    name: "epsilon",
    about: "offset in scene units, 5 by default",
    default: 5.0,
    // At 0 the weight of depth 0 is infinite.
    least: Bound::Excluded(0.0),
    most: 1e9,
};

const FALL: Number = Number {
    name: "k",
    about: "the inverse of the depth around which the weight falls, 0.1 by default (ours)",
    default: 0.1,
    least: Bound::Excluded(0.0),
    most: 1e9,
};

/// A method with a weight that may depend on parameters.
macro_rules! wboit {
    ($name:literal, $about:literal, $weight:expr) => {
        Method {
            parameters: &[TARGETS],
            promises: |_| Promises {
                tinted: true,
                own_weight: true,
                ..Promises::NORMALISED
            },
            curve: &["", ":targets=f32"],
            twin: Some(|s, p| Some(wboit::composite(p.fragments, p.background, $weight(s)))),
            ..Method::new($name, $about, |b| build(b, $weight(b.spec)))
        }
    };
}

/// A lamp of the least opacity, 1/1024, has with the least weight, 1e-2 α, a share of 1e-8 in the sum of weights.
const fn unweighed_lamp(property: Property) -> Flaw {
    let reason = "half floats end at 6e-8: opacity times weight of a faint lamp far from the near plane is less, and the lamp is gone";
    Flaw::new(property, &["emissive"], reason).when(half_sums)
}

pub(super) const EQ7: Method = Method {
    flaws: &[
        Flaw::swallowed(&["alpha-tiny", "deep"]),
        Flaw::overflowing(&["near-overflow"]),
        Flaw::reordered(&["deep"]),
        Flaw::BLIND,
    ],
    ..wboit!(
        "wboit-eq7",
        "McGuire & Bavoil 2013, eq 6 with weight 7",
        |_| Weight::Eq7
    )
};

pub(super) const EQ8: Method = Method {
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::overflowing(&["near-overflow"]),
        Flaw::BLIND,
    ],
    ..wboit!(
        "wboit-eq8",
        "McGuire & Bavoil 2013, eq 6 with weight 8",
        |_| Weight::Eq8
    )
};

pub(super) const EQ9: Method = Method {
    curve: &["", ":targets=f32", ":scale=0.5"],
    roles: &[(Role::WeightedBlending, "wboit-eq9")],
    flaws: &[
        Flaw::overflowing(&["deep", "near-overflow"]),
        Flaw::reordered(&["deep"]),
        Flaw::BLIND,
    ],
    ..wboit!(
        "wboit-eq9",
        "McGuire & Bavoil 2013, eq 6 with weight 9",
        |_| Weight::Eq9
    )
};

pub(super) const EQ10: Method = Method {
    parameters: &[TARGETS, Parameter::Number(FACTOR)],
    // One translation of the paper prints 3e4.
    curve: &["", ":targets=f32", ":factor=30000,targets=f32"],
    flaws: &[
        Flaw::swallowed(&["alpha-tiny", "deep"]),
        Flaw::overflowing(&["near-overflow"]),
        unweighed_lamp(Property::Hull),
        unweighed_lamp(Property::Single),
        Flaw::BLIND,
    ],
    ..wboit!(
        "wboit-eq10",
        "McGuire & Bavoil 2013, eq 6 with weight 10",
        |s| Weight::Eq10 {
            factor: FACTOR.of(s) as f32
        }
    )
};

pub(super) const PAPAKOSTAS: Method = Method {
    parameters: &[TARGETS, Parameter::Word(COMPOSITE)],
    curve: &["", ":targets=f32", ":composite=printed"],
    promises: |s| Promises {
        tinted: !is_printed(s),
        normalised: !is_printed(s),
        own_weight: true,
        ..Promises::NORMALISED
    },
    twin: Some(|s, p| {
        let weight = |f: &Fragment| Weight::Papakostas.eval(f.depth, f.alpha, f.window_depth);
        Some(if is_printed(s) {
            wboit::normalised(&wboit::printed(p.fragments, weight), p.background)
        } else {
            wboit::composite(p.fragments, p.background, Weight::Papakostas)
        })
    }),
    roles: &[(Role::ThesisWeight, "wboit-papakostas")],
    flaws: &[Flaw::swallowed(&["deep", "near-overflow"]), Flaw::BLIND],
    ..wboit!(
        "wboit-papakostas",
        "eq 6 with the weight of Papakostas 2022",
        |_| Weight::Papakostas
    )
};

const fn faint(property: Property, cases: &'static [&'static str]) -> Flaw {
    let reason = "half floats lose digits below 6e-5 and end at 6e-8, where 10 / (1 + 10 (z k)^5) comes at depths of 70 and 280";
    Flaw::new(property, cases, reason).when(half_sums)
}

const fn vanishing(property: Property) -> Flaw {
    let reason = "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on";
    Flaw::new(property, &["far"], reason).when(half_sums)
}

pub(super) const INVERSE_POWER: Method = Method {
    parameters: &[
        TARGETS,
        Parameter::Whole(EXPONENT),
        Parameter::Number(EPSILON),
    ],
    // The paper's figures use z^-4, too; at a depth of 0 it would be infinite.
    curve: &["", ":targets=f32", ":k=4,epsilon=0.001,targets=f32"],
    flaws: &[
        Flaw::swallowed(&["deep", "near-overflow"]),
        vanishing(Property::Hull),
        vanishing(Property::Dark),
        vanishing(Property::Single),
        Flaw::reordered(&["deep"]),
        Flaw::BLIND,
    ],
    ..wboit!("wboit-inverse-power", "eq 6 with (z + epsilon)^-k", |s| {
        Weight::InversePower {
            k: EXPONENT.of(s),
            epsilon: EPSILON.of(s) as f32,
        }
    })
};

pub(super) const SMOKE: Method = Method {
    parameters: &[TARGETS, Parameter::Number(FALL)],
    flaws: &[
        Flaw::swallowed(&["deep", "near-overflow"]),
        Flaw::reordered(&["deep"]),
        faint(Property::Hull, &["far", "isolated"]),
        faint(Property::Dark, &["far"]),
        faint(Property::Single, &["far", "isolated"]),
        Flaw::BLIND,
    ],
    ..wboit!(
        "wboit-smoke",
        "eq 6 with 10 / (1 + 10 (z k)^5), the paper's weight of smoke",
        |s| Weight::Smoke {
            k: FALL.of(s) as f32
        }
    )
};

fn build(b: &Build<'_>, weight: Weight) -> Result<Box<dyn Compositor>, RenderError> {
    let (mut factor, mut power, mut offset) = (0.0, 0, 0.0);
    match weight {
        Weight::Eq10 { factor: f } => factor = f,
        Weight::InversePower { k, epsilon } => (power, offset) = (k, epsilon),
        Weight::Smoke { k } => offset = k,
        _ => {}
    }
    // `{:?}` prints a float with a point or exponent, and as the shortest text that reads back the same.
    let parameters = format!(
        "const FACTOR: f32 = {factor:?};\nconst POWER: u32 = {power}u;\nconst EPSILON: f32 = {offset:?};\n"
    );
    let feature = weight.name().replace('-', "_");
    let features = [&*feature, "printed"];
    // Only the thesis's weight has the parameter.
    let printed = weight == Weight::Papakostas && is_printed(b.spec);
    build_sums(
        b,
        Gather {
            features: &features[..1 + usize::from(printed)],
            extra: &[("parameters", &parameters)],
            ..gather("methods::wboit::gather", &[])
        },
    )
}
