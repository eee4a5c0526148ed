//! `stochastic-s`: screen-door samples with alpha correction (Enderton et al. 2010). The CPU twin is
//! `peelnet_core::methods::stochastic`.

use super::{
    commutative::{self, Gather, Plan, Storage},
    compositor::{Build, Compositor},
    method::{Method, Numbered, Promises},
    parameter::TARGETS,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property, half_sums},
};
use peelnet_core::methods::stochastic;

pub(super) const METHOD: Method = Method {
    numbered: Some(Numbered {
        least: 1,
        most: 256,
        power_of_two: true,
    }),
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
        Flaw::swallowed(&["deep", "near-overflow"]),
        Flaw::reordered(&["deep", "near-overflow"]),
        Flaw::swallowed(&["alpha-tiny"]).when(|s| s.number() >= 64 && half_sums(s)),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "noise: one sample of sixteen weighs 0.06 (Enderton et al. 2010)",
        ),
    ],
    ..Method::new(
        "stochastic",
        "Enderton et al. 2010, S screen-door samples with alpha correction",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let samples = b.spec.number();
    let parameters = format!("const SAMPLES: u32 = {samples}u;\n");
    let extra = [("parameters", parameters.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE],
            storage: &[Storage {
                label: "sample depths",
                bytes: 4 * samples,
                of_frame: 0,
            }],
            passes: &[
                Gather {
                    label: "depths",
                    shader: "methods::stochastic::depths",
                    extra: &extra,
                    writes: &[1],
                    stores: &[0],
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::stochastic::gather",
                    extra: &extra,
                    writes: &[0],
                    loads: &[0],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
