//! `deep-one`, `deep-one-wide`: one geometry pass at full resolution, of which the nearest fragment's colour and three or six sums are kept, and a
//! network that says how much of each sum is seen, drawn with the exported text itself. `one` and `one-wide` are the same by a formula.

mod expectations;
pub mod reference;

use crate::methods::{prelude::*, tiles};
use peelnet_core::methods::one::Design;
use peelnet_model::inputs::one_surroundings;

const RANGE: Parameter = Parameter::words(
    "range",
    "where the depths come from that sums are parted at: one pixel in 64, drawn first without shading (tiles, by default), what the last frame's sums show (last), which draws those pixels in the first frame and after jumps alone, or the frame's nearest and farthest depth (frame), with several times the error",
    &["tiles", "last", "frame"],
);

/// Whether pixels are drawn without looking at others.
fn is_framed(spec: &MethodSpec) -> bool {
    RANGE.word(spec) == "frame"
}

/// Whether the last frame says where depths are.
fn from_last(spec: &MethodSpec) -> bool {
    RANGE.word(spec) == "last"
}

/// What a method keeps.
fn design(spec: &MethodSpec) -> Design {
    if spec.name().ends_with("wide") {
        Design::WIDE
    } else {
        Design::ONE
    }
}

const fn one(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[RANGE],
        curve: &["", ":range=last", ":range=frame"],
        expectations: expectations::ONE,
        ..Method::new(name, about, passes)
    }
}

pub(super) const METHOD: Method = one(
    "one",
    "one geometry pass: the nearest fragment with its colour, and three sums; 32 bytes a pixel, no network",
);

pub(super) const WIDE: Method = Method {
    expectations: expectations::WIDE,
    ..one(
        "one-wide",
        "the same with six sums, 64 bytes a pixel: more than WebGPU promises",
    )
};

pub(super) const DEEP: Method = Method {
    learned: true,
    curve: &["", ":range=last", ":range=frame", ":scale=0.5"],
    ..one(
        "deep-one",
        "one geometry pass, and a network that says how much of each of three sums is seen; 32 bytes a pixel",
    )
};

pub(super) const DEEP_WIDE: Method = Method {
    learned: true,
    expectations: expectations::WIDE,
    ..one(
        "deep-one-wide",
        "the same of six sums, 64 bytes a pixel: more than WebGPU promises",
    )
};

fn passes(p: &mut Passes<'_>) {
    let design = design(p.on.spec);
    let surroundings = one_surroundings(design);
    if p.on.recipe.is_none() {
        p.without_network(surroundings);
    }
    let is_wide = design == Design::WIDE;
    let is_framed = is_framed(p.on.spec);
    let features = || {
        let wide = is_wide.then_some("wide").into_iter();
        wide.chain(is_framed.then_some("frame"))
    };
    let kept = p.described(surroundings.passes[0].targets);
    let around = surroundings.around.filter(|_| !is_framed);
    let from_last = from_last(p.on.spec);
    let tiles = around.map(|around| tiles::draw(p, around, from_last));
    let found = tiles.as_ref().map(|tiles| tiles.quantiles);
    p.geometry("methods::one::gather", Needs::COLOR)
        .features(features())
        .reads(found)
        .writes(kept.iter().copied());
    if let Some(tiles) = tiles.filter(|_| from_last) {
        p.compute("methods::one::last", tiles.count)
            .features(is_wide.then_some("wide"))
            .reads(kept.iter().copied())
            .reads([tiles.quantiles])
            .writes([tiles.seen]);
    }
    let tint = p.on.tinted.then(|| p.target(crate::passes::TINTED));
    if let Some(tint) = tint {
        p.geometry("methods::one::tint", Needs::COLOR)
            .writes([tint]);
    }
    p.resolve("methods::one::resolve", kept)
        .features(features().chain(tint.map(|_| "tinted")))
        .reads(found)
        .reads(tint);
}
