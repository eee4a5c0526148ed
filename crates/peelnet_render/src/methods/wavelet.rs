//! `wavelet-R`: absorbance in front as Haar wavelets of rank R (Aizenshtein, Smal & McGuire 2022). The CPU twin is
//! `peelnet_core::methods::wavelet`, which states the sources.

use super::{
    bins::{RANGE_TARGETS, bounds, range_pass},
    mboit::own_share,
    prelude::*,
};
use peelnet_core::methods::{
    range::Bounds,
    wavelet::{self, Settings},
};

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

fn of_frame(spec: &MethodSpec) -> bool {
    settings(spec).bounds == Bounds::Frame
}

const fn own_share_in(property: Property, cases: &'static str) -> Flaw {
    let reason =
        "a fragment's own absorbance counts by its place in its bin; own=out leaves it out";
    Flaw::new(property, cases, reason).when(|s| of_frame(s) && !settings(s).own_share_out)
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
    twin: Some(weighted_twin),
    transmittances: Some(|s, fragments, warp, _| {
        Some(wavelet::transmittances(fragments, warp, &settings(s)))
    }),
    flaws: &[
        Flaw::swallowed("deep"),
        Flaw::unsettled(Property::Order, "deep near-overflow"),
        Flaw::new(
            Property::Transmittance,
            "two-layers",
            "rank 3 separates eight depths (Aizenshtein et al. 2022)",
        )
        .when(|s| of_frame(s) && settings(s).own_share_out),
        Flaw::new(
            Property::Opaque,
            "alpha-near-one",
            "eight bins over the whole frame's depth blur what lies close together",
        )
        .when(|s| of_frame(s) && s.number() == 2),
        own_share_in(Property::Transmittance, "isolated two-layers"),
        own_share_in(Property::Opaque, "alpha-near-one"),
    ],
    ..Method::new(
        "wavelet",
        "Aizenshtein, Smal & McGuire 2022, Haar wavelets of rank R",
        plan,
    )
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let Settings {
        rank,
        bounds,
        own_share_out,
    } = settings(p.b.spec);
    let four = |label| Target::half(label, 4, Blend::Add);
    p.parameters = format!("const BINS: f32 = {}.0;\n", 2 << rank);
    let sums = p.target(SUMS)?;
    let transmittance = p.target(TRANSMITTANCE)?;
    let lower = p.targets(["average, whole and halves", "quarters"].map(four))?;
    let eighths = match rank {
        3 => p.targets(["near eighths", "far eighths"].map(four))?,
        _ => Vec::new(),
    };
    let (rank_3, all) = (rank == 3, [lower.clone(), eighths.clone()].concat());
    let range = range_pass(p, bounds)?;
    // One pass of portable WebGPU writes 32 bytes a pixel: four targets of 16 bits, two of 32.
    let parts: Vec<(&[&'static str], _)> = match p.b.spec.targets() {
        Some(Precision::Full) if rank_3 => vec![(&["lower"], lower), (&["eighths"], eighths)],
        _ if rank_3 => vec![(&["lower", "eighths"], all.clone())],
        _ => vec![(&["lower"], lower)],
    };
    for (features, written) in parts {
        p.geometry("methods::wavelet::coefficients")
            .features(features.iter().copied())
            .reads_range(range)
            .writes(written);
    }
    p.geometry("methods::wavelet::gather")
        .features(own_share(own_share_out))
        .features(rank_3.then_some("eighths"))
        .reads(all)
        .reads_range(range)
        .writes([sums, transmittance]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
    Ok(())
}
