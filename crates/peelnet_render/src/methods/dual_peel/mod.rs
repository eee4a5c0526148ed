//! `dual-peel`: two layers a pass, one from the front (under) and one from the back (over), until nothing is left
//! (Bavoil & Myers 2008).

mod expectations;

use crate::geometry::{
    depth_peel::{DUAL_BYTES, DepthPeel},
    frame::{attachment, clear_color},
    fullscreen::FullscreenPass,
};
use crate::gpu::{bind::Bind, wgpu};
use crate::methods::prelude::*;
use crate::passes::{
    compositor::resolve,
    peeling::{self, PASSES, Peel, Peeling},
};

/// Precision of the colours that layers are blended into; peeled depths have 32 bits always.
const COLORS: Parameter = Parameter::words(
    "colors",
    "f32 (default) or f16: what layers are blended into",
    &["f32", "f16"],
);

fn colors(spec: &MethodSpec) -> Precision {
    match COLORS.word(spec) {
        "f16" => Precision::Half,
        _ => Precision::Full,
    }
}

pub(super) const METHOD: Method = Method {
    parameters: &[PASSES, COLORS],
    curve: &["", ":passes=2", ":passes=4"],
    expectations: expectations::METHOD,
    ..Method::own("dual-peel", "exact: both ends, two layers a pass", build)
};

#[derive(Debug)]
struct Dual {
    peel: DepthPeel,
    /// Layers from the front and from the back, with what they start from; alpha is the transmittance of each stack.
    stacks: [(wgpu::TextureView, [f64; 4]); 2],
    /// By parity of the pass.
    blend: [FullscreenPass; 2],
    resolve: FullscreenPass,
    /// Bytes a pixel of both stacks.
    blended_bytes: f64,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (gpu, frame) = (&b.scene.gpu, b.frame);
    let full = colors(b.spec) == Precision::Full;
    let stack = |name, blend| Target {
        full,
        ..Target::half(name, 4, blend)
    };
    let targets = [stack("fronts", Blend::Under), stack("backs", Blend::Over)];
    let none = wgpu::TextureUsages::empty();
    let texture = |t: Target| {
        let view = gpu.texture(t.name, t.format(), frame.size, 1, none)?;
        Ok::<_, RenderError>((view, t.blend.start()))
    };
    let stacks = [texture(targets[0])?, texture(targets[1])?];
    let found = peeling::found_buffer(b)?;
    let peel = DepthPeel::dual(b.scene, frame, &[], Some(&found))?;
    let states = targets.map(|t| Some(t.state()));
    let blend = |from: usize| {
        let entries = [
            ("before", Bind::Texture(&peel.reached[from])),
            ("after", Bind::Texture(&peel.reached[1 - from])),
            ("front", Bind::Texture(&peel.layers[0])),
            ("back", Bind::Texture(&peel.layers[1])),
            ("found", Bind::Write(&found)),
        ];
        let shader = "methods::dual_peel::blend";
        FullscreenPass::new(gpu, shader, &[], &[], &entries, &states, 1)
    };
    let entries = [
        ("background", Bind::Texture(&frame.background)),
        ("fronts", Bind::Texture(&stacks[0].0)),
        ("backs", Bind::Texture(&stacks[1].0)),
    ];
    let shader = "methods::dual_peel::resolve";
    let dual = Dual {
        blend: [blend(0)?, blend(1)?],
        resolve: resolve(gpu, frame, shader, &[], &[], &entries)?,
        peel,
        stacks,
        blended_bytes: if full { 32.0 } else { 16.0 },
    };
    Peeling::boxed(b, found, dual)
}

impl Peel for Dual {
    const LAYERS: u32 = 2;

    fn begin(&self, cx: &mut DrawContext<'_, '_>) {
        self.peel.init(cx.recorder, cx.scene, cx.frame);
        let clear = self.stacks.each_ref();
        let clear = clear.map(|(view, start)| clear_color(view, *start));
        drop(cx.recorder.render("clear", &clear, None));
    }

    fn pass(&self, cx: &mut DrawContext<'_, '_>, number: u32) {
        self.peel
            .peel(cx.recorder, cx.scene, cx.frame, number, cx.counting);
        let stacks = self.stacks.each_ref();
        let targets = stacks.map(|(view, _)| attachment(view, wgpu::LoadOp::Load));
        self.blend[(number % 2) as usize].draw(cx.recorder, &targets, None);
    }

    fn resolve(&self, _: u32) -> &FullscreenPass {
        &self.resolve
    }

    fn besides(&self) -> (u32, u32, f64) {
        (1, 2, DUAL_BYTES + self.blended_bytes)
    }
}
