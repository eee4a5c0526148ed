//! `painter-object` and `painter-triangle`: sort on the CPU, blend in hardware: what engines do by default. Not exact for
//! surfaces that intersect, or overlap in a cycle.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor, DrawContext, FrameStats},
    method::{Method, Promises, Role},
    parameter::{Parameter, TARGETS, Word},
    spec::MethodSpec,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::{fragment::Fragment, methods::over};
use peelnet_raster::{GeometryPass, GeometryPipelines, Order, Sorted, Surfaces};

const SORT: Word = Word {
    name: "sort",
    about: "on (default) or off: hardware blending in the scene's order",
    words: &["on", "off"],
};

const fn promises(sorted: bool) -> Promises {
    Promises {
        order_independent: sorted,
        sorted,
        straight: true,
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

/// Premultiplied colour and alpha, as the sum of all fragments takes them.
const SHADER: &str = "methods::weighted_sum::gather";

fn build(b: &Build<'_>, order: Order) -> Result<Box<dyn Compositor>, RenderError> {
    if b.frame.output.is_over() {
        return Ok(Box::new(Straight::new(b, order)?));
    }
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
                label: PASS,
                shader: SHADER,
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

const PASS: &str = "blend";

/// Onto the target itself, as engines draw: no targets of its own and no pass over the pixels.
#[derive(Debug)]
struct Straight {
    pipelines: GeometryPipelines,
    sorted: Option<Sorted>,
}

impl Straight {
    fn new(b: &Build<'_>, order: Order) -> Result<Self, RenderError> {
        let output = b.frame.output;
        let pass = GeometryPass {
            label: PASS,
            shader: SHADER,
            targets: &[Some(output.state())],
            samples: output.samples(),
            ..GeometryPass::NONE
        };
        Ok(Self {
            pipelines: b
                .scene
                .pipelines(b.gpu, b.frame, Surfaces::Transparent, &pass)?,
            sorted: Sorted::new(b.gpu, b.scene, order)?,
        })
    }
}

impl Compositor for Straight {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(sorted) = &mut self.sorted {
            sorted.sort(cx.recorder, cx.scene, cx.camera);
        }
        let output = cx.output();
        let mut pass = cx.recorder.render(PASS, &[output], None);
        match &self.sorted {
            Some(sorted) => sorted.draw(&mut pass, cx.scene, cx.frame, &self.pipelines),
            None => cx
                .scene
                .draw(&mut pass, cx.frame, Surfaces::Transparent, &self.pipelines),
        }
        let order = self.sorted.as_ref().map_or(0, Sorted::bytes);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: 1,
            bytes_per_pixel: order as f64 / f64::from(cx.frame.pixels()),
            ..Default::default()
        })
    }
}
