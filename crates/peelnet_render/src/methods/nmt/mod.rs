//! `nmt`: eq 6 with the transmittance that a network reads off four raw moments (Tsopouridis et al. 2024), drawn with the exported
//! text itself. Targets are the published ones, 56 bytes a pixel.

mod expectations;

use crate::methods::prelude::*;

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::targets("f32 (default, as published) or f16")],
    learned: true,
    curve: &["", ":targets=f16"],
    expectations: expectations::METHOD,
    ..Method::new(
        "nmt",
        "Tsopouridis et al. 2024: a network reads four moments",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let sums = p.target(Target { full: true, ..SUMS });
    // b_0 and the number of fragments: published with four channels.
    let totals = p.target(Target::full("totals", 4, Blend::Add));
    let moments = p.target(Target::full("moments", 4, Blend::Add));
    let extent = p.target(Target::full("extents", 2, Blend::MaxAdd));
    p.geometry("methods::nmt::statistics", Needs::OPACITY)
        .writes([totals, moments, extent]);
    p.geometry("methods::nmt::gather", Needs::COLOR)
        .reads([totals, moments, extent])
        .writes([sums]);
    p.resolve("methods::nmt::resolve", [sums, totals]);
}
