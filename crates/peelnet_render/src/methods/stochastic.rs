//! `stochastic-s`: screen-door samples with alpha correction (Enderton et al. 2010). The CPU twin is
//! `peelnet_core::methods::stochastic`.

use super::prelude::*;
use peelnet_core::methods::stochastic;

pub(super) const METHOD: Method = Method {
    numbered: Numbered::powers(1, 256),
    parameters: &[TARGETS],
    promises: |_| Promises {
        noisy: true,
        ..Promises::NORMALISED
    },
    curve: &["-4", "-16", "-64"],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        Some(stochastic::composite(fragments, c0, s.number(), p.position))
    }),
    flaws: &[
        Flaw::swallowed("deep near-overflow"),
        Flaw::reordered("deep near-overflow"),
        Flaw::swallowed("alpha-tiny").when(|s| s.number() >= 64 && half_sums(s)),
        Flaw::new(
            Property::Opaque,
            "alpha-near-one",
            "noise: one sample of sixteen weighs 0.06 (Enderton et al. 2010)",
        ),
    ],
    ..Method::new(
        "stochastic",
        "Enderton et al. 2010, S screen-door samples with alpha correction",
        plan,
    )
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let samples = p.b.spec.number();
    p.parameters = format!("const SAMPLES: u32 = {samples}u;\n");
    let sums = p.target(SUMS)?;
    let transmittance = p.target(TRANSMITTANCE)?;
    let nearest = p.storage("sample depths", 4 * samples, 0)?;
    p.geometry("methods::stochastic::depths")
        .writes([transmittance, nearest]);
    p.geometry("methods::stochastic::gather")
        .reads([nearest])
        .writes([sums]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
    Ok(())
}
