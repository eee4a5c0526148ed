//! `deep-thesis`: eq 6 with the weight of the thesis's network (Papakostas 2022), drawn with the exported text itself.

mod expectations;

use crate::methods::{
    prelude::*,
    wboit::{COMPOSITE, is_printed},
};

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, COMPOSITE],
    curve: &["", ":composite=printed"],
    learned: true,
    expectations: expectations::METHOD,
    ..Method::new(
        "deep-thesis",
        "Papakostas 2022: eq 6 with a network's weight",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let printed = is_printed(p.on.spec).then_some("printed");
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let statistics = p.target(Target::half("statistics", 2, Blend::Add));
    p.geometry("methods::deep_thesis::statistics", Needs::OPACITY)
        .writes([statistics]);
    p.geometry("methods::deep_thesis::gather", Needs::COLOR)
        .features(printed)
        .reads([statistics])
        .writes([sums, transmittance]);
    p.resolve("methods::deep_thesis::resolve", [sums, transmittance]);
}
