//! `wavelet-3`: absorbance in front as Haar wavelets (Aizenshtein, Smal & McGuire 2022). The CPU twin is
//! `peelnet_core::methods::wavelet`.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    mboit::own_share,
    method::Method,
    parameter::{Parameter, Word},
    spec::MethodSpec,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::wavelet;

const OWN: Word = Word {
    name: "own",
    about: "out (default) or in: a fragment's own absorbance",
    words: &["out", "in"],
};

fn own_out(spec: &MethodSpec) -> bool {
    OWN.of(spec) == "out"
}

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Word(OWN)],
    curve: &["", ":own=in"],
    twin: Some(|s, p| {
        let (fragments, c0) = (p.fragments, p.background);
        Some(wavelet::composite(fragments, c0, &p.warp, own_out(s)))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        Some(wavelet::transmittances(fragments, warp, own_out(s)))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::new(
            Property::Transmittance,
            &["two-layers"],
            "rank 3 separates eight depths (Aizenshtein et al. 2022)",
        )
        .when(own_out),
    ],
    ..Method::new(
        "wavelet-3",
        "Aizenshtein, Smal & McGuire 2022, Haar wavelets of rank 3",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    // Four targets of 16 bits fill the 32 bytes a pixel that portable WebGPU lets one pass write.
    let coefficients = |label| Target {
        label,
        channels: 4,
        full: false,
        blend: Blend::Add,
    };
    let features = own_share(own_out(b.spec));
    commutative::build(
        b,
        &Plan {
            targets: &[
                SUMS,
                TRANSMITTANCE,
                coefficients("average, whole and halves"),
                coefficients("quarters"),
                coefficients("near eighths"),
                coefficients("far eighths"),
            ],
            passes: &[
                Gather {
                    label: "coefficients",
                    shader: "methods::wavelet::coefficients",
                    writes: &[2, 3, 4, 5],
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::wavelet::gather",
                    features,
                    writes: &[0, 1],
                    reads: &[2, 3, 4, 5],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
