//! `mboit4` and `mboit6`: moment-based transparency with four and six power moments (Münstermann et al. 2018).

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
    weighted::SUMS,
};
use crate::RenderError;

const fn moments(label: &'static str, channels: u32) -> Target {
    Target {
        label,
        channels,
        full: true,
        blend: Blend::Add,
    }
}

/// What four and six moments differ in.
struct Order {
    /// The paper's bias for power moments in 32 and in 16 bits.
    bias: [f32; 2],
    targets: &'static [Target],
    moments: &'static str,
    gather: &'static str,
    /// The targets that hold moments.
    reads: &'static [usize],
}

const FOUR: Order = Order {
    bias: [5e-7, 6e-5],
    targets: &[SUMS, moments("absorbance", 1), moments("moments", 4)],
    moments: "methods::mboit4::moments",
    gather: "methods::mboit4::gather",
    reads: &[1, 2],
};

const SIX: Order = Order {
    bias: [5e-6, 6e-4],
    targets: &[
        SUMS,
        moments("absorbance", 1),
        moments("moments 1 to 4", 4),
        moments("moments 5 and 6", 2),
    ],
    moments: "methods::mboit6::moments",
    gather: "methods::mboit6::gather",
    reads: &[1, 2, 3],
};

pub(super) fn four(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, &FOUR)
}

pub(super) fn six(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, &SIX)
}

fn build(b: &Build<'_>, order: &Order) -> Result<Box<dyn Compositor>, RenderError> {
    let half = b.spec.full_precision()? == Some(false);
    let bias = b.spec.number("bias", order.bias[usize::from(half)])?;
    let overestimation = b.spec.number("overestimation", 0.25)?;
    let features = own_share(b, "in")?;
    // `{:?}` prints the shortest text that reads back the same, with a point or an exponent.
    let parameters =
        format!("const BIAS: f32 = {bias:?};\nconst OVERESTIMATION: f32 = {overestimation:?};\n");
    commutative::build(
        b,
        &Plan {
            targets: order.targets,
            passes: &[
                Gather {
                    label: "moments",
                    shader: order.moments,
                    writes: order.reads,
                    ..Gather::NONE
                },
                Gather {
                    shader: order.gather,
                    features,
                    extra: &[("parameters", &parameters)],
                    writes: &[0],
                    reads: order.reads,
                    ..Gather::NONE
                },
            ],
            resolve: "methods::mboit4::resolve",
            resolve_reads: &[0, 1],
            tinted_by: Some(1),
            ..Plan::NONE
        },
    )
}

/// The shader feature for the knob `own`: whether a fragment's own absorbance is `in` or `out` of what lies in front of it.
pub(super) fn own_share(
    b: &Build<'_>,
    default: &'static str,
) -> Result<&'static [&'static str], RenderError> {
    let other = if default == "in" { "out" } else { "in" };
    Ok(match b.spec.word("own", &[default, other])? {
        "out" => &["own_share_out"],
        _ => &[],
    })
}
