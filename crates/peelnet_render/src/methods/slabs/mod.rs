//! `deep-small`, `deep-medium`, `deep-large`: known layers without ordered access, in three or four slabs cut where the pixel's layers are, and
//! a learned guess of what lies between them, drawn with the exported text itself. `slabs` is the same without a network.

mod expectations;
pub mod reference;

use crate::methods::prelude::*;
use peelnet_core::methods::slabs::Layout;
use peelnet_model::inputs::{SlabInputs, slab_surroundings};

const KEEP: Parameter = Parameter::words(
    "keep",
    "large (default, 50 bytes a pixel): four slabs; medium (42 bytes): three; small (38 bytes): three, and the farthest fragment of the nearest alone",
    &["large", "medium", "small"],
);

const RANGE: Parameter = Parameter::words(
    "range",
    "what slabs are cut by: the absorbances of eight bins of depth between the pixel's ends (pixel, by default), found by a geometry pass of its own; depth from where the pixel's ray enters the first box around a transparent part to where it leaves the last (boxes), found by a pass over boxes; or depth in the frame (frame), with a pass less and several times the error",
    &["pixel", "boxes", "frame"],
);

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
        "known layers of three slabs and a learned guess between them, 38 bytes a pixel",
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":range=boxes", ":range=frame", ":scale=0.5"],
    expectations: expectations::MEDIUM,
    ..slabs(
        "deep-medium",
        "the same in 42 bytes a pixel: the one to ship",
    )
};

pub(super) const LARGE: Method = Method {
    curve: &["", ":range=boxes", ":range=frame"],
    expectations: expectations::LARGE,
    ..slabs(
        "deep-large",
        "the same of four slabs, 50 bytes a pixel: the most accurate",
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
    let [framed, boxes] = ["frame", "boxes"].map(|word| RANGE.word(p.on.spec) == word);
    // The shaders' own case is the largest, over a range of its own.
    let is_large = layout == Layout::Large;
    let own_layout = (!is_large).then_some(layout.name());
    let source = match (framed, boxes) {
        (true, _) => Some("frame"),
        (_, true) => Some("boxes"),
        _ => None,
    };
    let features = || own_layout.into_iter().chain(source);
    let sums = p.target(SUMS);
    let [of_range, of_slabs, _] = slab_surroundings(layout).passes else {
        unreachable!("a pass of the range, one of the statistics and one of the weights")
    };
    let kept = p.described(of_slabs.targets);
    // Over boxes the range alone, which is the last; over the frame nothing.
    let skipped = match source {
        None => 0,
        Some("boxes") => of_range.targets.len() - 1,
        Some(_) => of_range.targets.len(),
    };
    let found = p.described(&of_range.targets[skipped..]);
    if boxes {
        let pass = p.geometry("methods::slabs::boxes", Needs::DEPTH).boxes();
        pass.label("range").writes(found.iter().copied());
    } else if !framed {
        p.geometry("methods::slabs::range", Needs::OPACITY)
            .writes(found.iter().copied());
    }
    let first = kept[0];
    p.geometry("methods::slabs::statistics", Needs::OPACITY)
        .features(features())
        .reads(found.iter().copied())
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
