//! `wavelet-R`: absorbance in front as Haar wavelets of rank R (Aizenshtein, Smal & McGuire 2022). The CPU twin is
//! `peelnet_core::methods::wavelet`, which states the sources.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    mboit::own_share,
    method::{Method, Numbered},
    parameter::{Parameter, Precision, Word},
    range::{BOUNDS_OF_FRAME, PIXEL_BOUNDS, RANGE, RANGE_PASS, RANGE_TARGETS, bounds},
    spec::MethodSpec,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::{
    range::Bounds,
    wavelet::{self, Settings},
};

const OWN: Word = Word {
    name: "own",
    about: "out (default) or in: a fragment's own absorbance",
    words: &["out", "in"],
};

fn settings(spec: &MethodSpec) -> Settings {
    Settings {
        rank: spec.number(),
        bounds: bounds(spec, BOUNDS_OF_FRAME),
        own_share_out: OWN.of(spec) == "out",
    }
}

const OWN_SHARE: Flaw = Flaw::new(
    Property::Transmittance,
    &["isolated", "two-layers"],
    "a fragment's own absorbance counts by its place in its bin; own=out leaves it out",
)
.when(|s| !settings(s).own_share_out && settings(s).bounds == Bounds::Frame);

pub(super) const METHOD: Method = Method {
    numbered: Some(Numbered {
        least: 2,
        most: 3,
        power_of_two: false,
    }),
    parameters: &[
        RANGE_TARGETS,
        Parameter::Word(OWN),
        Parameter::Word(BOUNDS_OF_FRAME),
    ],
    curve: &[
        "-3",
        "-2",
        "-3:own=in",
        "-3:bounds=pixel",
        "-2:bounds=pixel",
        "-3:targets=f32",
    ],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        Some(wavelet::composite(fragments, c0, &p.warp, &settings(s)))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        Some(wavelet::transmittances(fragments, warp, &settings(s)))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::unsettled(Property::Order, &["deep", "near-overflow"]),
        Flaw::new(
            Property::Transmittance,
            &["two-layers"],
            "rank 3 separates eight depths (Aizenshtein et al. 2022)",
        )
        .when(|s| settings(s).own_share_out && settings(s).bounds == Bounds::Frame),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "eight bins over the whole frame's depth blur what lies close together",
        )
        .when(|s| settings(s).rank == 2 && settings(s).bounds == Bounds::Frame),
        OWN_SHARE,
        Flaw {
            property: Property::Opaque,
            cases: &["alpha-near-one"],
            ..OWN_SHARE
        },
    ],
    ..Method::new(
        "wavelet",
        "Aizenshtein, Smal & McGuire 2022, Haar wavelets of rank R",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let Settings {
        rank,
        bounds,
        own_share_out,
    } = settings(b.spec);
    let coefficients = |label| Target {
        label,
        channels: 4,
        full: false,
        blend: Blend::Add,
    };
    let mut targets = vec![
        SUMS,
        TRANSMITTANCE,
        coefficients("average, whole and halves"),
        coefficients("quarters"),
    ];
    let mut fours = vec![2, 3];
    let mut features = own_share(own_share_out).to_vec();
    if rank == 3 {
        fours.extend([4, 5]);
        features.push("eighths");
        targets.extend(["near eighths", "far eighths"].map(coefficients));
    }
    let mut range = vec![];
    let mut of_range: &[&str] = &[];
    if bounds == Bounds::Pixel {
        range.push(targets.len());
        targets.push(RANGE);
        of_range = &[PIXEL_BOUNDS];
    }
    // One pass of portable WebGPU writes 32 bytes a pixel: four targets of 16 bits, two of 32.
    let parts: &[&[&str]] = match (rank, b.spec.targets()) {
        (3, Some(Precision::Full)) => &[&["lower"], &["eighths"]],
        (3, _) => &[&["lower", "eighths"]],
        _ => &[&["lower"]],
    };
    let parts: Vec<_> = parts
        .iter()
        .map(|part| [*part, of_range].concat())
        .collect();
    let parameters = format!("const BINS: f32 = {}.0;\n", 2 << rank);
    let extra = [("parameters", parameters.as_str())];
    let reads = [fours.as_slice(), &range].concat();
    features.extend(of_range);
    let mut passes = Vec::new();
    passes.extend((!range.is_empty()).then_some(Gather {
        writes: &range,
        ..RANGE_PASS
    }));
    let writes = fours.chunks(fours.len() / parts.len());
    passes.extend(parts.iter().zip(writes).map(|(features, writes)| Gather {
        label: "coefficients",
        shader: "methods::wavelet::coefficients",
        features,
        extra: &extra,
        writes,
        reads: &range,
        ..Gather::NONE
    }));
    passes.push(Gather {
        shader: "methods::wavelet::gather",
        features: &features,
        extra: &extra,
        writes: &[0, 1],
        reads: &reads,
        ..Gather::NONE
    });
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes: &passes,
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
