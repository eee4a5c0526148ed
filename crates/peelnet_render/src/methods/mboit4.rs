//! `mboit4`: moment-based transparency with four power moments (Münstermann et al. 2018).

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::SUMS,
};
use crate::RenderError;

/// The paper's bias for power moments in 32 and in 16 bits.
const BIAS: [f32; 2] = [5e-7, 6e-5];

pub(super) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let moments = |label, channels| Target {
        label,
        channels,
        full: true,
        blend: Blend::Add,
    };
    let half = b.spec.full_precision()? == Some(false);
    let bias = b.spec.number("bias", BIAS[usize::from(half)])?;
    let overestimation = b.spec.number("overestimation", 0.25)?;
    let features: &[&str] = match b.spec.word("own", &["in", "out"])? {
        "out" => &["own_share_out"],
        _ => &[],
    };
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    let parameters =
        format!("const BIAS: f32 = {bias:?};\nconst OVERESTIMATION: f32 = {overestimation:?};\n");
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, moments("absorbance", 1), moments("moments", 4)],
            passes: &[
                Gather {
                    label: "moments",
                    shader: "methods::mboit4::moments",
                    features: &[],
                    extra: &[],
                    writes: &[1, 2],
                    reads: &[],
                },
                Gather {
                    label: "gather",
                    shader: "methods::mboit4::gather",
                    features,
                    extra: &[("parameters", &parameters)],
                    writes: &[0],
                    reads: &[1, 2],
                },
            ],
            resolve: "methods::mboit4::resolve",
            resolve_features: &[],
            resolve_reads: &[0, 1],
        },
    )
}
