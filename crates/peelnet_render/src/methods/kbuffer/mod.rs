//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013).

mod expectations;
pub mod reference;

use crate::methods::{
    prelude::*,
    stored_colors::{self, COLORS},
};
use peelnet_core::weights::Weight;

const WEIGHT: Parameter = Parameter::words(
    "weight",
    "of the tail: eq9 (default), eq7 or eq8",
    &["eq9", "eq7", "eq8"],
);

/// The weight of the tail, and its feature of the shader: eq 5 has none.
fn tail(spec: &MethodSpec) -> (Option<Weight>, &'static str) {
    match (spec.name(), WEIGHT.word(spec)) {
        ("kbuffer", _) => (None, "unweighted"),
        (_, "eq7") => (Some(Weight::Eq7), "eq7"),
        (_, "eq8") => (Some(Weight::Eq8), "eq8"),
        _ => (Some(Weight::Eq9), "eq9"),
    }
}

const fn method(name: &'static str, about: &'static str) -> Method {
    Method {
        numbered: Numbered::range(1, 64),
        expectations: expectations::METHOD,
        ..Method::new(name, about, passes)
    }
}

pub(super) const PLAIN: Method = Method {
    parameters: &[TARGETS, COLORS],
    curve: &[
        "-2",
        "-4",
        "-8",
        "-4:colors=f16",
        "-4:colors=u8",
        "-8:colors=u8",
    ],
    expectations: expectations::PLAIN,
    ..method("kbuffer", "the K nearest exactly, the rest blended by eq 5")
};

pub(super) const HYBRID: Method = Method {
    parameters: &[TARGETS, WEIGHT, COLORS],
    curve: &["-2", "-4", "-8", "-8:colors=u8"],
    expectations: expectations::HYBRID,
    ..method("hybrid", "the K nearest exactly, the rest blended by eq 6")
};

fn passes(p: &mut Passes<'_>) {
    let (k, (_, weight)) = (p.on.spec.number(), tail(p.on.spec));
    let (_, bytes, layout) = stored_colors::layout(p.on.spec);
    p.parameters = format!("const K: u32 = {k}u;\n");
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let nearest = p.storage("nearest", 4 * k, 0);
    let triangles = p.storage("triangles", 4 * k, 0);
    let colors = p.storage("colors", bytes * k, 0);
    p.geometry("methods::kbuffer::insert", Needs::DEPTH)
        .writes([nearest]);
    p.geometry("methods::kbuffer::gather", Needs::COLOR | Needs::TRIANGLE)
        .features([weight])
        .features(layout)
        .reads([nearest])
        .writes([sums, transmittance, triangles, colors]);
    let read = [sums, transmittance, nearest, triangles, colors];
    p.resolve("methods::kbuffer::resolve", read)
        .features(layout);
}
