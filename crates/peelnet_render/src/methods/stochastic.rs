//! `stochastic-s`: screen-door samples with alpha correction (Enderton et al. 2010). The CPU twin is
//! `peelnet_core::methods::stochastic`.

use super::{
    Build, Compositor,
    commutative::{self, Gather, Plan, Storage},
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::RenderError;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let samples = b.spec.size();
    if !samples.is_power_of_two() {
        return Err(RenderError::Knob {
            method: b.spec.to_string(),
            message: format!(
                "the number of samples must be a power of two: {} or {}",
                samples.next_power_of_two() / 2,
                samples.next_power_of_two()
            ),
        });
    }
    let parameters = format!("const SAMPLES: u32 = {samples}u;\n");
    let extra = [("parameters", parameters.as_str())];
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE],
            storage: &[Storage {
                label: "sample depths",
                bytes: 4 * samples,
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
