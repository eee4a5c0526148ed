//! `weighted-average`: the mean colour, covering as so many layers of the mean opacity (Bavoil & Myers 2008).

mod expectations;
pub mod reference;

use crate::methods::prelude::*;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    expectations: expectations::METHOD,
    ..Method::new("weighted-average", "Bavoil & Myers 2008", passes)
};

fn passes(p: &mut Passes<'_>) {
    let sums = p.target(SUMS);
    let count = p.target(Target::half("counts", 1, Blend::Add));
    p.geometry("methods::weighted_average::gather", Needs::COLOR)
        .writes([sums, count]);
    p.resolve("methods::weighted_average::resolve", [sums, count]);
}
