//! `wboit-*`: the mean of colours weighted by a named weight, with the exact coverage (McGuire & Bavoil 2013, eq 6). One geometry pass.

pub(super) mod expectations;

use crate::methods::prelude::*;
use crate::passes::{Handle, TINTED};
use peelnet_core::weights::Weight;

const FACTOR: Parameter = Parameter::positive("factor", "largest weight, 3e3 by default", 3e3, 1e9);

const EXPONENT: Parameter =
    Parameter::whole("k", "a whole exponent, 2 by default", Some(2), (0, 16));

// At 0 the weight of depth 0 is infinite.
const EPSILON: Parameter =
    Parameter::positive("epsilon", "offset in scene units, 5 by default", 5.0, 1e9);

const FALL: Parameter = Parameter::positive(
    "k",
    "the inverse of the depth around which the weight falls, 0.1 by default (ours)",
    0.1,
    1e9,
);

/// How the thesis's methods composite.
pub(super) const COMPOSITE: Parameter = Parameter::words(
    "composite",
    "eq6 (default), or printed: the sums of the thesis's shader as they stand in print",
    &["eq6", "printed"],
);

/// Whether it composites as printed: only methods of the thesis have the parameter.
pub(super) fn is_printed(spec: &MethodSpec) -> bool {
    COMPOSITE.word(spec) == "printed"
}

/// The weight that a method is named after, with its parameters, and its feature of the shader.
fn weight(spec: &MethodSpec) -> (Weight, &'static str) {
    match spec.name() {
        "wboit-eq7" => (Weight::Eq7, "eq7"),
        "wboit-eq8" => (Weight::Eq8, "eq8"),
        "wboit-eq9" => (Weight::Eq9, "eq9"),
        "wboit-eq10" => {
            let factor = FACTOR.number(spec) as f32;
            (Weight::Eq10 { factor }, "eq10")
        }
        "wboit-inverse-power" => {
            let k = EXPONENT.count(spec).unwrap_or_default() as u32;
            let epsilon = EPSILON.number(spec) as f32;
            (Weight::InversePower { k, epsilon }, "inverse_power")
        }
        "wboit-smoke" => {
            let k = FALL.number(spec) as f32;
            (Weight::Smoke { k }, "smoke")
        }
        _ => (Weight::Papakostas, "papakostas"),
    }
}

const fn weighted(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[TARGETS],
        curve: &["", ":targets=f32"],
        expectations: expectations::WEIGHTED,
        ..Method::new(name, about, passes)
    }
}

pub(super) const EQ7: Method = Method {
    expectations: expectations::EQ7,
    ..weighted("wboit-eq7", "McGuire & Bavoil 2013, eq 6 with weight 7")
};

pub(super) const EQ8: Method = Method {
    expectations: expectations::EQ8,
    ..weighted("wboit-eq8", "McGuire & Bavoil 2013, eq 6 with weight 8")
};

pub(super) const EQ9: Method = Method {
    curve: &["", ":targets=f32", ":scale=0.5"],
    expectations: expectations::EQ9,
    ..weighted("wboit-eq9", "McGuire & Bavoil 2013, eq 6 with weight 9")
};

pub(super) const EQ10: Method = Method {
    parameters: &[TARGETS, FACTOR],
    // One translation of the paper prints 3e4.
    curve: &["", ":targets=f32", ":factor=30000,targets=f32"],
    expectations: expectations::EQ10,
    ..weighted("wboit-eq10", "McGuire & Bavoil 2013, eq 6 with weight 10")
};

pub(super) const PAPAKOSTAS: Method = Method {
    parameters: &[TARGETS, COMPOSITE],
    curve: &["", ":targets=f32", ":composite=printed"],
    expectations: expectations::PAPAKOSTAS,
    ..weighted(
        "wboit-papakostas",
        "eq 6 with the weight of Papakostas 2022",
    )
};

pub(super) const INVERSE_POWER: Method = Method {
    parameters: &[TARGETS, EXPONENT, EPSILON],
    // The paper's figures use z^-4, too; at a depth of 0 it would be infinite.
    curve: &["", ":targets=f32", ":k=4,epsilon=0.001,targets=f32"],
    expectations: expectations::INVERSE_POWER,
    ..weighted("wboit-inverse-power", "eq 6 with (z + epsilon)^-k")
};

pub(super) const SMOKE: Method = Method {
    parameters: &[TARGETS, FALL],
    expectations: expectations::SMOKE,
    ..weighted(
        "wboit-smoke",
        "eq 6 with 10 / (1 + 10 (z k)^5), the paper's weight of smoke",
    )
};

fn passes(p: &mut Passes<'_>) {
    let (weight, feature) = weight(p.on.spec);
    let (mut factor, mut power, mut offset) = (0.0, 0, 0.0);
    match weight {
        Weight::Eq10 { factor: f } => factor = f,
        Weight::InversePower { k, epsilon } => (power, offset) = (k, epsilon),
        Weight::Smoke { k } => offset = k,
        _ => {}
    }
    let printed = is_printed(p.on.spec).then_some("printed");
    let features: Vec<_> = [feature].into_iter().chain(printed).collect();
    // `{:?}` prints a float with a point or exponent, and as the shortest text that reads back the same.
    p.parameters = format!(
        "const FACTOR: f32 = {factor:?};\nconst POWER: u32 = {power}u;\nconst EPSILON: f32 = {offset:?};\n"
    );
    sums(p, "methods::wboit::gather", &features, []);
}

/// Weighted sums and a transmittance in the targets that the scene's colours need: of grey colours one target less, with `T_∞` where
/// alpha is.
pub(super) fn sums(
    p: &mut Passes<'_>,
    shader: &str,
    features: &[&'static str],
    reads: impl IntoIterator<Item = Handle>,
) {
    let packed = Target {
        blend: Blend::AddTransmit,
        ..SUMS
    };
    let tinted = Target {
        name: TRANSMITTANCE.name,
        ..TINTED
    };
    let (targets, feature): (&[Target], _) = match (p.on.grey, p.on.tinted) {
        (true, _) => (&[packed], Some("packed")),
        (false, true) => (&[SUMS, tinted], Some("tinted")),
        (false, false) => (&[SUMS, TRANSMITTANCE], None),
    };
    let targets = p.targets(targets.iter().copied());
    let features = features.iter().copied().chain(feature);
    let gather = p.geometry(shader, Needs::COLOR).features(features);
    gather.reads(reads).writes(targets.iter().copied());
    p.resolve("methods::wboit::resolve", targets)
        .features(feature);
}
