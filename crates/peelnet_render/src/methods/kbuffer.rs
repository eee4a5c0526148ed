//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013). The
//! CPU twin is `peelnet_core::methods::kbuffer`.

use super::{
    prelude::*,
    stored::{self, COLORS},
};
use peelnet_core::{methods::kbuffer, weights::Weight};

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

/// Few enough places that tails of hundreds of fragments are left in the hard cases.
fn long_tails(spec: &MethodSpec) -> bool {
    spec.number() <= 8 && half_sums(spec)
}

const TOO_FEW_PLACES: Flaw = Flaw::new(
    Property::Order,
    "coplanar",
    "of more coincident fragments than places, those that arrive first are kept: places are ordered by depth in one atomic word, and portable WebGPU has no atomics of 64 bits, which the triangle would need beside it",
)
.when(|s| s.number() < 16);

const fn method(name: &'static str, about: &'static str) -> Method {
    Method {
        numbered: Numbered::range(1, 64),
        promises: |s| stored::promises(s, Promises::NORMALISED),
        twin: Some(|s, p| {
            let (fragments, c0, places) = (p.fragments, p.background, s.number() as usize);
            let (weight, colors) = (tail(s).0, stored::colors(s));
            Some(kbuffer::composite(fragments, c0, places, weight, colors))
        }),
        ..Method::new(name, about, plan)
    }
}

pub(super) const PLAIN: Method = Method {
    parameters: &[TARGETS, COLORS],
    curve: &["-2", "-4", "-8", "-4:colors=f16", "-4:colors=u8"],
    flaws: &[
        TOO_FEW_PLACES,
        Flaw::swallowed("alpha-tiny deep").when(long_tails),
        stored::in_bytes(
            Property::Background,
            "alpha-zero coplanar emissive far grazing intersecting isolated moving-camera opaque-mix thin-slab \
             two-layers wide-range",
        ),
        stored::in_bytes(
            Property::Hull,
            "coplanar emissive grazing intersecting moving-camera near-overflow",
        ),
        stored::in_bytes(Property::Single, "emissive grazing"),
    ],
    ..method("kbuffer", "the K nearest exactly, the rest blended by eq 5")
};

pub(super) const HYBRID: Method = Method {
    parameters: &[TARGETS, WEIGHT, COLORS],
    curve: &["-2", "-4", "-8"],
    flaws: &[
        TOO_FEW_PLACES,
        Flaw::swallowed("deep").when(long_tails),
        Flaw::reordered("deep").when(long_tails),
        Flaw::overflowing("near-overflow").when(long_tails),
    ],
    ..method("hybrid", "the K nearest exactly, the rest blended by eq 6")
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let (k, (_, weight)) = (p.b.spec.number(), tail(p.b.spec));
    let (_, bytes, layout) = stored::layout(p.b.spec);
    p.parameters = format!("const K: u32 = {k}u;\n");
    let sums = p.target(SUMS)?;
    let transmittance = p.target(TRANSMITTANCE)?;
    let nearest = p.storage("nearest depths", 4 * k, 0)?;
    let triangles = p.storage("nearest triangles", 4 * k, 0)?;
    let colors = p.storage("nearest colours", bytes * k, 0)?;
    p.geometry("methods::kbuffer::insert").writes([nearest]);
    p.geometry("methods::kbuffer::gather")
        .features([weight])
        .features(layout)
        .reads([nearest])
        .writes([sums, transmittance, triangles, colors]);
    let read = [sums, transmittance, nearest, triangles, colors];
    p.resolve("methods::kbuffer::resolve", read)
        .features(layout);
    Ok(())
}
