//! `painter-object` and `painter-triangle`: sort on the CPU, blend in hardware: what engines do by default. Not exact for
//! surfaces that intersect, or overlap in a cycle.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    method::{Method, Promises, Role},
    parameter::{Parameter, TARGETS, Word},
    spec::MethodSpec,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::{fragment::Fragment, methods::over};
use peelnet_raster::Order;

const SORT: Word = Word {
    name: "sort",
    about: "on (default) or off: hardware blending in the scene's order",
    words: &["on", "off"],
};

const fn promises(sorted: bool) -> Promises {
    Promises {
        order_independent: sorted,
        sorted,
        ..Promises::NORMALISED
    }
}

fn sorts(spec: &MethodSpec) -> bool {
    SORT.of(spec) == "on"
}

/// Over-blending in the order of drawing: what is drawn last lies in front.
fn blend(drawn: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    drawn.iter().fold(background, |behind, f| {
        let color = f.premultiplied();
        std::array::from_fn(|k| color[k] + (1.0 - f.alpha) * behind[k])
    })
}

pub(super) const OBJECTS: Method = Method {
    parameters: &[TARGETS, Parameter::Word(SORT)],
    promises: |s| promises(sorts(s)),
    curve: &["", ":sort=off"],
    roles: &[(Role::HardwareBlending, "painter-object:sort=off")],
    // Exact where objects neither intersect nor overlap in a cycle.
    twin: Some(|s, p| {
        Some(if sorts(s) {
            over::composite(p.fragments, p.background)
        } else {
            blend(p.fragments, p.background)
        })
    }),
    flaws: &[
        Flaw::swallowed(&["alpha-tiny", "deep", "near-overflow"]),
        Flaw::new(
            Property::Steady,
            &["passing"],
            "objects swap whole (popping)",
        )
        .when(sorts),
    ],
    ..Method::new(
        "painter-object",
        "objects sorted on the CPU, hardware blending",
        objects,
    )
};

pub(super) const TRIANGLES: Method = Method {
    parameters: &[TARGETS],
    promises: |_| promises(true),
    // Exact where triangles do not intersect.
    twin: Some(|_, p| Some(over::composite(p.fragments, p.background))),
    flaws: &[Flaw::swallowed(&["alpha-tiny", "deep", "near-overflow"])],
    ..Method::new(
        "painter-triangle",
        "triangles sorted on the CPU, hardware blending",
        triangles,
    )
};

fn objects(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(
        b,
        if sorts(b.spec) {
            Order::Objects
        } else {
            Order::Scene
        },
    )
}

fn triangles(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
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
