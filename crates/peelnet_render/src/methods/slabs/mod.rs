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

/// What the statistics pass writes: of each slab its absorbance, its nearest and its farthest fragment and its mean, as far as there is room
/// in the layout; what is left of a target's channels holds a mean or the farthest of one slab.
fn statistics(layout: Layout) -> Vec<Target> {
    use Blend::{Add, Max, MaxAdd};
    let four = |name, blend| Target::half(name, 4, blend);
    match layout {
        Layout::Small => vec![
            four("absorbances", Add),
            four("nearest", Max),
            Target::half("firsts", 2, Add),
        ],
        Layout::Medium => vec![
            four("absorbances", Add),
            four("nearest", MaxAdd),
            four("farthest", MaxAdd),
        ],
        Layout::Large => vec![
            four("absorbances", Add),
            four("nearest", Max),
            four("farthest", Max),
            four("firsts", Add),
        ],
    }
}

fn passes(p: &mut Passes<'_>) {
    let layout = if let Some(recipe) = p.on.recipe {
        let inputs = recipe.inputs.downcast::<SlabInputs>();
        let layout = inputs.and_then(|inputs| inputs.design.layout());
        layout.expect("the recipe of a method of slabs keeps what a layout holds")
    } else {
        p.network.push_str(
            "// The guess without a network: the middle between the bounds.\n\
             fn peelnet_network(between: PeelnetBetween) -> f32 {\n    return 0.5;\n}\n",
        );
        let layout = plain_layout(p.on.spec);
        for module in slab_surroundings(layout).modules {
            let text = crate::shaders::source(module);
            p.network.push_str(text.expect("modules of the repository"));
        }
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
    let kept = p.targets(statistics(layout));
    let bins = ["bins_front", "bins_back"].map(|name| Target::half(name, 4, Blend::AddBytes));
    let bins = bins.into_iter().filter(|_| source.is_none());
    let range = (!framed).then_some(Target::half("range", 2, Blend::MaxBytes));
    let found = p.targets(bins.chain(range));
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
