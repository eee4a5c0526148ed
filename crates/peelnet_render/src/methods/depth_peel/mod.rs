//! `depth-peel`: front to back, one layer a pass (Everitt 2001), until a pass peels nothing.

pub(super) mod expectations;

use crate::geometry::{
    depth_peel::{DepthPeel, SINGLE_BYTES},
    frame::clear_color,
    fullscreen::FullscreenPass,
};
use crate::gpu::{bind::Bind, wgpu};
use crate::methods::prelude::*;
use crate::passes::{
    compositor::resolve,
    peeling::{self, PASSES, Peel, Peeling},
};

pub(super) const METHOD: Method = Method {
    parameters: &[PASSES],
    curve: &["", ":passes=2", ":passes=4", ":passes=8"],
    expectations: expectations::METHOD,
    ..Method::own(
        "depth-peel",
        "exact: front to back, one layer a pass",
        |b| {
            let found = peeling::found_buffer(b)?;
            let peel = Layers::new(b, &found)?;
            Peeling::boxed(b, found, peel)
        },
    )
};

/// Layers peeled from the front, one a pass, and what is composited so far.
#[derive(Debug)]
pub(super) struct Layers {
    pub peel: DepthPeel,
    /// In turn.
    pub accumulated: [wgpu::TextureView; 2],
    /// By parity of the pass, without and with counting.
    under: [[FullscreenPass; 2]; 2],
    resolve: [FullscreenPass; 2],
}

impl Layers {
    /// Bytes a pixel.
    pub const BYTES: f64 = SINGLE_BYTES + 2.0 * 16.0;

    pub fn new(b: &Build<'_>, found: &wgpu::Buffer) -> Result<Self, RenderError> {
        let (gpu, frame) = (&b.scene.gpu, b.frame);
        let peel = DepthPeel::single(b.scene, frame, &[])?;
        let format = wgpu::TextureFormat::Rgba32Float;
        let none = wgpu::TextureUsages::empty();
        let texture = || gpu.texture("accumulated", format, frame.size, 1, none);
        let accumulated = [texture()?, texture()?];
        let under = |features: &[&str], from: usize| {
            let entries = [
                ("before", Bind::Texture(&accumulated[from])),
                ("layer", Bind::Texture(&peel.layers[0])),
                ("key", Bind::Texture(&peel.reached[1 - from])),
                ("found", Bind::Write(found)),
            ];
            let (shader, target) = ("methods::depth_peel::under", [Some(format.into())]);
            FullscreenPass::new(gpu, shader, features, &[], &entries, &target, 1)
        };
        let resolve = |from: usize| {
            let entries = [
                ("background", Bind::Texture(&frame.background)),
                ("layers", Bind::Texture(&accumulated[from])),
            ];
            resolve(
                gpu,
                frame,
                "methods::depth_peel::resolve",
                &[],
                &[],
                &entries,
            )
        };
        Ok(Self {
            under: [
                [under(&[], 0)?, under(&[], 1)?],
                [under(&["counted"], 0)?, under(&["counted"], 1)?],
            ],
            resolve: [resolve(0)?, resolve(1)?],
            peel,
            accumulated,
        })
    }
}

impl Peel for Layers {
    const LAYERS: u32 = 1;

    fn begin(&self, cx: &mut DrawContext<'_, '_>) {
        self.peel.init(cx.recorder, cx.scene, cx.frame);
        let clear = [clear_color(&self.accumulated[0], [0.0, 0.0, 0.0, 1.0])];
        drop(cx.recorder.render("clear", &clear, None));
    }

    fn pass(&self, cx: &mut DrawContext<'_, '_>, number: u32) {
        let from = (number % 2) as usize;
        self.peel
            .peel(cx.recorder, cx.scene, cx.frame, number, false);
        let target = [clear_color(&self.accumulated[1 - from], [0.0; 4])];
        self.under[usize::from(cx.counting)][from].draw(cx.recorder, &target, None);
    }

    fn resolve(&self, passes: u32) -> &FullscreenPass {
        &self.resolve[(passes % 2) as usize]
    }

    fn besides(&self) -> (u32, u32, f64) {
        (0, 3, Self::BYTES)
    }
}
