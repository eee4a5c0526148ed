//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013). The
//! CPU twin is `peelnet_core::methods::kbuffer`.

use super::{
    commutative::{self, Gather, Plan, Storage},
    compositor::{Build, Compositor},
    method::{Method, Numbered, Promises},
    parameter::{Parameter, TARGETS, Word},
    spec::MethodSpec,
    stored::{self, COLORS},
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::{methods::kbuffer, weights::Weight};

const WEIGHT: Word = Word {
    name: "weight",
    about: "of the tail: eq9 (default), eq7 or eq8",
    words: &["eq9", "eq7", "eq8"],
};

const K: Option<Numbered> = Some(Numbered {
    least: 1,
    most: 64,
    power_of_two: false,
});

/// Few enough places that tails of hundreds of fragments are left in the hard cases.
fn long_tails(spec: &MethodSpec) -> bool {
    spec.number() <= 8 && half_sums(spec)
}

const TOO_FEW_PLACES: Flaw = Flaw::new(
    Property::Order,
    &["coplanar"],
    "of more coincident fragments than places, those that arrive first are kept: places are ordered by depth in one atomic word, and portable WebGPU has no atomics of 64 bits, which the triangle would need beside it",
)
.when(|s| s.number() < 16);

pub(super) const PLAIN: Method = Method {
    numbered: K,
    parameters: &[TARGETS, Parameter::Word(COLORS)],
    promises: |s| stored::promises(s, Promises::NORMALISED),
    curve: &["-2", "-4", "-8", "-4:colors=f16", "-4:colors=u8"],
    twin: Some(|s, p| {
        let places = s.number() as usize;
        Some(kbuffer::composite(
            p.fragments,
            p.background,
            places,
            None,
            stored::colors(s),
        ))
    }),
    flaws: &[
        TOO_FEW_PLACES,
        Flaw::swallowed(&["alpha-tiny", "deep"]).when(long_tails),
        stored::in_bytes(
            Property::Background,
            &[
                "alpha-zero",
                "coplanar",
                "emissive",
                "far",
                "grazing",
                "intersecting",
                "isolated",
                "moving-camera",
                "opaque-mix",
                "thin-slab",
                "two-layers",
                "wide-range",
            ],
        ),
        stored::in_bytes(
            Property::Hull,
            &[
                "coplanar",
                "emissive",
                "grazing",
                "intersecting",
                "moving-camera",
                "near-overflow",
            ],
        ),
        stored::in_bytes(Property::Single, &["emissive", "grazing"]),
    ],
    ..Method::new(
        "kbuffer",
        "the K nearest exactly, the rest blended by eq 5",
        plain,
    )
};

pub(super) const HYBRID: Method = Method {
    numbered: K,
    parameters: &[TARGETS, Parameter::Word(WEIGHT), Parameter::Word(COLORS)],
    promises: |s| stored::promises(s, Promises::NORMALISED),
    curve: &["-2", "-4", "-8"],
    twin: Some(|s, p| {
        let places = s.number() as usize;
        let weight = match WEIGHT.of(s) {
            "eq7" => Weight::Eq7,
            "eq8" => Weight::Eq8,
            _ => Weight::Eq9,
        };
        let tail = Some(weight);
        Some(kbuffer::composite(
            p.fragments,
            p.background,
            places,
            tail,
            stored::colors(s),
        ))
    }),
    flaws: &[
        TOO_FEW_PLACES,
        Flaw::swallowed(&["deep"]).when(long_tails),
        Flaw::reordered(&["deep"]).when(long_tails),
        Flaw::overflowing(&["near-overflow"]).when(long_tails),
    ],
    ..Method::new(
        "hybrid",
        "the K nearest exactly, the rest blended by eq 6",
        hybrid,
    )
};

/// The tail by eq 5.
fn plain(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, "unweighted")
}

/// The tail by eq 6.
fn hybrid(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, WEIGHT.of(b.spec))
}

fn build(b: &Build<'_>, weight: &str) -> Result<Box<dyn Compositor>, RenderError> {
    let k = b.spec.number();
    let parameters = format!("const K: u32 = {k}u;\n");
    let extra = [("parameters", parameters.as_str())];
    let kept = stored::colors(b.spec);
    let layout = stored::features(kept);
    let gathering = [&[weight], layout].concat();
    let (nearest, triangles, colors) = (0, 1, 2);
    let storage = |label, bytes| Storage {
        label,
        bytes: bytes * k,
        of_frame: 0,
    };
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE],
            storage: &[
                storage("nearest depths", 4),
                storage("nearest triangles", 4),
                storage("nearest colours", stored::bytes(kept)),
            ],
            passes: &[
                Gather {
                    label: "insert",
                    shader: "methods::kbuffer::insert",
                    extra: &extra,
                    stores: &[nearest],
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::kbuffer::gather",
                    features: &gathering,
                    extra: &extra,
                    writes: &[0, 1],
                    loads: &[nearest],
                    stores: &[triangles, colors],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::kbuffer::resolve",
            resolve_features: layout,
            resolve_extra: &extra,
            resolve_reads: &[0, 1],
            resolve_loads: &[nearest, triangles, colors],
            ..Plan::NONE
        },
    )
}
