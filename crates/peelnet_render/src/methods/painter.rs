//! `painter-object` and `painter-triangle`: sort on the CPU, blend in hardware: what engines do by default. Not exact for
//! surfaces that intersect, or overlap in a cycle.

use super::{
    Build, Compositor,
    commutative::{self, Blend, Gather, Plan, Target},
};
use crate::{RenderError, scene::Order};

pub(super) fn objects(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let order = match b.spec.word("sort", &["on", "off"])? {
        "off" => Order::Scene,
        _ => Order::Objects,
    };
    build(b, order)
}

pub(super) fn triangles(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, Order::Triangles)
}

fn build(b: &Build<'_>, order: Order) -> Result<Box<dyn Compositor>, RenderError> {
    commutative::build(
        b,
        &Plan {
            targets: &[Target {
                label: "layers",
                channels: 4,
                full: false,
                blend: Blend::Over,
            }],
            passes: &[Gather {
                label: "blend",
                // Premultiplied colour and alpha, as the sum of all fragments takes them.
                shader: "methods::weighted_sum::gather",
                writes: &[0],
                ..Gather::NONE
            }],
            order,
            resolve: "methods::depth_peel::resolve",
            resolve_reads: &[0],
            ..Plan::NONE
        },
    )
}
