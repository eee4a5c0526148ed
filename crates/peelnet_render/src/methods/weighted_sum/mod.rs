//! `weighted-sum`: colours summed as they are (Meshkin 2007).

mod expectations;
pub mod reference;

use crate::methods::prelude::*;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    expectations: expectations::METHOD,
    ..Method::new("weighted-sum", "Meshkin 2007", passes)
};

fn passes(p: &mut Passes<'_>) {
    let sums = p.target(SUMS);
    p.geometry("methods::weighted_sum::gather", Needs::COLOR)
        .writes([sums]);
    p.resolve("methods::weighted_sum::resolve", [sums]);
}
