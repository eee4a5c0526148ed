//! `painter-object` and `painter-triangle`: sort on the CPU, blend in hardware: what engines do by default. Not exact for
//! surfaces that intersect, or overlap in a cycle.

use super::{plan::Resource, prelude::*};
use crate::geometry::Order;
use peelnet_core::{fragment::Fragment, methods::over};

const SORT: Parameter = Parameter::words(
    "sort",
    "on (default) or off: hardware blending in the scene's order",
    &["on", "off"],
);

fn sorts(spec: &MethodSpec) -> bool {
    SORT.word(spec) == "on"
}

fn order(spec: &MethodSpec) -> Order {
    match spec.name() {
        "painter-triangle" => Order::Triangles,
        _ if sorts(spec) => Order::Objects,
        _ => Order::Scene,
    }
}

/// Over-blending in the order of drawing: what is drawn last lies in front.
fn blend(drawn: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    drawn.iter().fold(background, |behind, f| {
        let color = f.premultiplied();
        std::array::from_fn(|k| color[k] + (1.0 - f.alpha) * behind[k])
    })
}

const SWALLOWED: Flaw = Flaw::swallowed("alpha-tiny deep near-overflow");

const fn painter(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[TARGETS],
        promises: |s| Promises {
            order_independent: sorts(s),
            sorted: sorts(s),
            straight: true,
            ..Promises::NORMALISED
        },
        // Exact where objects, or triangles, neither intersect nor overlap in a cycle.
        twin: Some(|s, p| {
            Some(if sorts(s) {
                over::composite(p.fragments, p.background)
            } else {
                blend(p.fragments, p.background)
            })
        }),
        flaws: &[SWALLOWED],
        ..Method::new(name, about, plan)
    }
}

pub(super) const OBJECTS: Method = Method {
    parameters: &[TARGETS, SORT],
    curve: &["", ":sort=off"],
    flaws: &[
        SWALLOWED,
        Flaw::new(Property::Steady, "passing", "objects swap whole (popping)").when(sorts),
    ],
    ..painter(
        "painter-object",
        "objects sorted on the CPU, hardware blending",
    )
};

pub(super) const TRIANGLES: Method = painter(
    "painter-triangle",
    "triangles sorted on the CPU, hardware blending",
);

/// Premultiplied colour and alpha, as the sum of all fragments takes them.
const SHADER: &str = "methods::weighted_sum::gather";

const PASS: &str = "blend";

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    p.order = order(p.b.spec);
    if p.b.frame.output.is_over() {
        // As engines draw: no targets of its own and no pass over the pixels.
        let output = p.resource(Resource::Output);
        p.geometry(SHADER).label(PASS).writes([output]);
    } else {
        let layers = p.target(Target::half("layers", 4, Blend::Over))?;
        p.geometry(SHADER).label(PASS).writes([layers]);
        p.resolve("methods::depth_peel::resolve", [layers]);
    }
    Ok(())
}
