//! `deep-small`, `deep-medium`, `deep-large`: known layers without ordered access, in three or four slabs cut where the pixel's layers are, and
//! a learned guess of what lies between them, drawn with the exported text itself. `slabs` is the same without a network.

mod expectations;
pub mod reference;

use crate::methods::{prelude::*, tiles};
use peelnet_core::methods::slabs::Layout;
use peelnet_model::inputs::{SlabInputs, slab_surroundings};

const KEEP: Parameter = Parameter::words(
    "keep",
    "large (default, 41 bytes a pixel): four slabs; medium (33 bytes): three; small (29 bytes): three, and the farthest fragment of the nearest alone",
    &["large", "medium", "small"],
);

const RANGE: Parameter = Parameter::words(
    "range",
    "where the depths come from that slabs are cut at: one pixel in 64, drawn first without shading (tiles, by default); from where the pixel's ray enters the first box around a transparent part to where it leaves the last (boxes), found by a pass over boxes; or the frame's nearest and farthest depth (frame). Without tiles errors are several times as large",
    &["tiles", "boxes", "frame"],
);

/// A pixel's ends, as boxes say.
const BOXES: Target = Target::half("range", 2, Blend::MaxBytes);

/// What a method without a network keeps.
fn plain_layout(spec: &MethodSpec) -> Layout {
    let name = KEEP.word(spec);
    let found = Layout::ALL.into_iter().find(|l| l.name() == name);
    found.unwrap_or(Layout::Large)
}

const fn slabs(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[RANGE],
        learned: true,
        expectations: expectations::SLABS,
        ..Method::new(name, about, passes)
    }
}

pub(super) const METHOD: Method = Method {
    parameters: &[KEEP, RANGE],
    learned: false,
    curve: &["", ":keep=medium", ":keep=small"],
    expectations: expectations::METHOD,
    ..slabs(
        "slabs",
        "slabs of depth where the pixel's layers are, each with its own sums and known ends; no network",
    )
};

pub(super) const SMALL: Method = Method {
    expectations: expectations::SMALL,
    ..slabs(
        "deep-small",
        "known layers of three slabs and a learned guess between them, 29 bytes a pixel",
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":range=boxes", ":range=frame", ":scale=0.5"],
    expectations: expectations::MEDIUM,
    ..slabs(
        "deep-medium",
        "the same in 33 bytes a pixel: the one to ship",
    )
};

pub(super) const LARGE: Method = Method {
    curve: &["", ":range=boxes", ":range=frame"],
    expectations: expectations::LARGE,
    ..slabs(
        "deep-large",
        "the same of four slabs, 41 bytes a pixel: the most accurate",
    )
};

fn passes(p: &mut Passes<'_>) {
    let layout = if let Some(recipe) = p.on.recipe {
        let inputs = recipe.inputs.downcast::<SlabInputs>();
        let layout = inputs.and_then(|inputs| inputs.design.layout());
        layout.expect("the recipe of a method of slabs keeps what a layout holds")
    } else {
        let layout = plain_layout(p.on.spec);
        p.without_network(slab_surroundings(layout));
        layout
    };
    let surroundings = slab_surroundings(layout);
    let [of_slabs, _] = surroundings.passes else {
        unreachable!("a pass of the statistics and one of the weights")
    };
    // The shaders' own case is the largest.
    let is_large = layout == Layout::Large;
    let own_layout = (!is_large).then_some(layout.name());
    let range = RANGE.word(p.on.spec);
    let source = ["frame", "boxes"].into_iter().find(|word| *word == range);
    let features = || own_layout.into_iter().chain(source);
    let sums = p.target(SUMS);
    let kept = p.described(of_slabs.targets);
    let found = match (source, surroundings.around) {
        (Some("boxes"), _) => {
            let range = p.target(BOXES);
            let pass = p.geometry("methods::slabs::boxes", Needs::DEPTH).boxes();
            pass.label("range").writes([range]);
            Some(range)
        }
        (None, Some(around)) => Some(tiles::draw(p, around, false).quantiles),
        _ => None,
    };
    let first = kept[0];
    p.geometry("methods::slabs::statistics", Needs::OPACITY)
        .features(features())
        .reads(found)
        .writes(kept.iter().copied());
    p.geometry("methods::slabs::gather", Needs::COLOR)
        .features(features())
        .reads(kept)
        .reads(found)
        .writes([sums]);
    p.resolve("methods::slabs::resolve", [sums, first])
        .features((!is_large).then_some("three"));
    p.tint();
}
