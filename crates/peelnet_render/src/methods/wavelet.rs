//! `wavelet-3`: absorbance in front as Haar wavelets (Aizenshtein, Smal & McGuire 2022). The CPU twin is
//! `peelnet_core::methods::wavelet`.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    mboit::own_share,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::RenderError;

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    // Four targets of 16 bits fill the 32 bytes a pixel that portable WebGPU lets one pass write.
    let coefficients = |label| Target {
        label,
        channels: 4,
        full: false,
        blend: Blend::Add,
    };
    let features = own_share(b, "out")?;
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
