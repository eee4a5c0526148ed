//! `deep-anchored-small`, `deep-anchored-medium`: a learned fraction of the others' absorbance, anchored at both ends, drawn with the
//! exported text itself.

mod expectations;

use crate::methods::prelude::*;
use peelnet_core::statistics::SumPrecision;

const fn anchored(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[TARGETS],
        learned: true,
        expectations: expectations::ANCHORED,
        ..Method::new(name, about, passes)
    }
}

pub(super) const SMALL: Method = Method {
    curve: &["", ":targets=f32"],
    expectations: expectations::SMALL,
    ..anchored(
        "deep-anchored-small",
        "a learned share of what lies between the pixel's ends, 5-8-1",
    )
};

pub(super) const MEDIUM: Method = Method {
    curve: &["", ":targets=f32", ":scale=0.5"],
    expectations: expectations::MEDIUM,
    ..anchored("deep-anchored-medium", "the same with exact ends, 5-12-1")
};

fn passes(p: &mut Passes<'_>) {
    let recipe = p.on.recipe.expect("its network's");
    let ends = recipe.inputs.known_apart().then_some(ENDS);
    let feature = ends.map(|_| "separate_ends");
    let statistic = |label, blend| Target {
        full: recipe.sums == SumPrecision::Exact,
        ..Target::half(label, 4, blend)
    };
    let sums = p.target(SUMS);
    let moments = p.target(statistic("moments", Blend::Add));
    let extent = p.target(statistic("extent", Blend::MaxAdd));
    let ends = p.targets(ends);
    p.geometry("methods::anchored::statistics", Needs::OPACITY)
        .features(feature)
        .writes([moments, extent]);
    p.geometry("methods::anchored::gather", Needs::COLOR)
        .features(feature)
        .reads([moments, extent])
        .writes([sums])
        .writes(ends.iter().copied());
    p.resolve("methods::anchored::resolve", [sums, moments])
        .features(feature)
        .reads(ends);
    p.tint();
}
