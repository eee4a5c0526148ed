//! `wavelet-R`: absorbance in front as Haar wavelets of rank R (Aizenshtein, Smal & McGuire 2022). `reference.rs` states the sources.

mod expectations;
pub mod reference;

use crate::methods::{
    bins::{RANGE_TARGETS, bounds, range_pass},
    mboit::own_share,
    prelude::*,
};
use reference::Settings;

const OWN: Parameter = Parameter::words(
    "own",
    "out (default) or in: a fragment's own absorbance",
    &["out", "in"],
);

const BOUNDS: Parameter = Parameter::words(
    "bounds",
    "frame (default) or pixel: the range of depths; a pixel's own takes one more pass",
    &["frame", "pixel"],
);

fn settings(spec: &MethodSpec) -> Settings {
    Settings {
        rank: spec.number(),
        bounds: bounds(spec, BOUNDS),
        own_share_out: OWN.word(spec) == "out",
    }
}

pub(super) const METHOD: Method = Method {
    numbered: Numbered::range(2, 3),
    parameters: &[RANGE_TARGETS, OWN, BOUNDS],
    curve: &[
        "-3",
        "-2",
        "-3:own=in",
        "-3:bounds=pixel",
        "-2:bounds=pixel",
        "-3:targets=f32",
    ],
    expectations: expectations::METHOD,
    ..Method::new(
        "wavelet",
        "Aizenshtein, Smal & McGuire 2022, Haar wavelets of rank R",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let Settings {
        rank,
        bounds,
        own_share_out,
    } = settings(p.on.spec);
    let four = |label| Target::half(label, 4, Blend::Add);
    p.parameters = format!("const BINS: f32 = {}.0;\n", 2 << rank);
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let lower = p.targets(["whole", "quarters"].map(four));
    let eighths = match rank {
        3 => p.targets(["near_eighths", "far_eighths"].map(four)),
        _ => Vec::new(),
    };
    let (rank_3, all) = (rank == 3, [lower.clone(), eighths.clone()].concat());
    let range = range_pass(p, bounds);
    // One pass of portable WebGPU writes 32 bytes a pixel: four targets of 16 bits, two of 32.
    let parts: Vec<(&[&'static str], _)> = match p.on.spec.targets() {
        Some(Precision::Full) if rank_3 => vec![(&["lower"], lower), (&["eighths"], eighths)],
        _ if rank_3 => vec![(&["lower", "eighths"], all.clone())],
        _ => vec![(&["lower"], lower)],
    };
    for (features, written) in parts {
        p.geometry("methods::wavelet::coefficients", Needs::OPACITY)
            .features(features.iter().copied())
            .reads_range(range)
            .writes(written);
    }
    p.geometry("methods::wavelet::gather", Needs::COLOR)
        .features(own_share(own_share_out))
        .features(rank_3.then_some("eighths"))
        .reads(all)
        .reads_range(range)
        .writes([sums, transmittance]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
}
