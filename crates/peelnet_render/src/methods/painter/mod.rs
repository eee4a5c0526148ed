//! `painter-object` and `painter-triangle`: sort on the CPU, blend in hardware: what engines do by default. Not exact for
//! surfaces that intersect, or overlap in a cycle.

mod expectations;

use crate::geometry::Order;
use crate::methods::prelude::*;

const SORT: Parameter = Parameter::words(
    "sort",
    "on (default) or off: hardware blending in the scene's order",
    &["on", "off"],
);

/// Of triangles.
const SORT_ON: Parameter = Parameter::words(
    "sort",
    "cpu (default) or gpu: where triangles are sorted; on the GPU by a radix sort, for scenes of one kind of material, such as splats",
    &["cpu", "gpu"],
);

fn sorts(spec: &MethodSpec) -> bool {
    spec.name() == "painter-triangle" || SORT.word(spec) == "on"
}

fn order(spec: &MethodSpec) -> Order {
    match spec.name() {
        "painter-triangle" if SORT_ON.word(spec) == "gpu" => Order::TrianglesOnGpu,
        "painter-triangle" => Order::Triangles,
        _ if sorts(spec) => Order::Objects,
        _ => Order::Scene,
    }
}

const fn painter(name: &'static str, about: &'static str) -> Method {
    Method {
        parameters: &[TARGETS],
        expectations: expectations::PAINTER,
        ..Method::new(name, about, passes)
    }
}

pub(super) const OBJECTS: Method = Method {
    parameters: &[TARGETS, SORT],
    curve: &["", ":sort=off"],
    expectations: expectations::OBJECTS,
    ..painter(
        "painter-object",
        "objects sorted on the CPU, hardware blending",
    )
};

pub(super) const TRIANGLES: Method = Method {
    parameters: &[TARGETS, SORT_ON],
    ..painter(
        "painter-triangle",
        "triangles, or splats, sorted by their centres, hardware blending",
    )
};

fn passes(p: &mut Passes<'_>) {
    p.order = order(p.on.spec);
    // Over a target as engines draw: no targets of its own and no pass over the pixels.
    let layers = match p.on.over {
        true => p.output(),
        false => p.target(Target::half("layers", 4, Blend::Over)),
    };
    // Premultiplied colour and alpha, as the sum of all fragments takes them.
    p.geometry("methods::weighted_sum::gather", Needs::COLOR)
        .label("blend")
        .writes([layers]);
    if !p.on.over {
        p.resolve("methods::depth_peel::resolve", [layers]);
    }
}
