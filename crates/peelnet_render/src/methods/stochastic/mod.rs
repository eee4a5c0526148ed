//! `stochastic-s`: screen-door samples with alpha correction (Enderton et al. 2010).

mod expectations;
pub mod reference;

use crate::methods::prelude::*;

pub(super) const METHOD: Method = Method {
    numbered: Numbered::powers(1, 256),
    parameters: &[TARGETS],
    curve: &["-4", "-16", "-64"],
    expectations: expectations::METHOD,
    ..Method::new(
        "stochastic",
        "Enderton et al. 2010, S screen-door samples with alpha correction",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let samples = p.on.spec.number();
    p.parameters = format!("const SAMPLES: u32 = {samples}u;\n");
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let nearest = p.storage("nearest", 4 * samples, 0);
    p.geometry(
        "methods::stochastic::depths",
        Needs::OPACITY | Needs::TRIANGLE,
    )
    .writes([transmittance, nearest]);
    p.geometry(
        "methods::stochastic::gather",
        Needs::COLOR | Needs::TRIANGLE,
    )
    .reads([nearest])
    .writes([sums]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
}
