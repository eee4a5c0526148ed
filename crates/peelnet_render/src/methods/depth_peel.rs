//! `depth-peel`: front to back, one layer a pass (Everitt 2001), until a pass peels nothing.

use super::{
    compositor::{Build, Compositor, DrawContext, Fit, FrameStats, Learning},
    method::{Method, Promises},
    parameter::{Count, Parameter},
    peeling::Passes,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::over;
use peelnet_gpu::{bind::Bind, wgpu};
use peelnet_raster::{
    frame::clear_color,
    fullscreen::FullscreenPass,
    single::{self, SinglePeel},
};
use std::ops::Range;

pub(super) const PASSES: Count = Count {
    name: "passes",
    about: "a cap on the number of peeling passes",
    most: 1 << 20,
};

/// Coincident fragments that are drawn in another order.
pub(super) const COINCIDENT: Flaw = Flaw::new(
    Property::Order,
    &["coplanar"],
    "coincident fragments are separated by a depth test that keeps the first drawn, because portable WebGPU can compare no triangle beside the depth; they must be drawn in the order of their numbers, as the renderer does, or some are lost",
);

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(PASSES)],
    promises: |s| Promises {
        exact: PASSES.given(s).is_none(),
        sorted: PASSES.given(s).is_none(),
        peels: true,
        ..Promises::EXACT
    },
    curve: &["", ":passes=2", ":passes=4", ":passes=8"],
    twin: Some(|s, p| {
        let sorted = over::sorted(p.fragments);
        let passes = PASSES.given(s).unwrap_or(u64::MAX) as usize;
        let reached = &sorted[..passes.min(sorted.len())];
        Some(over::composite(reached, p.background))
    }),
    flaws: &[COINCIDENT.when(|s| PASSES.given(s).is_none())],
    ..Method::new(
        "depth-peel",
        "exact: front to back, one layer a pass",
        build,
    )
};

#[derive(Debug)]
struct DepthPeel {
    peel: SinglePeel,
    accumulated: [wgpu::TextureView; 2],
    /// By parity of the pass, without and with counting.
    under: [[FullscreenPass; 2]; 2],
    resolve: [FullscreenPass; 2],
    passes: Passes,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (gpu, frame) = (b.gpu, b.frame);
    let peel = SinglePeel::new(gpu, b.scene, frame, &[])?;
    let format = wgpu::TextureFormat::Rgba32Float;
    let texture = || {
        gpu.texture(
            "accumulated",
            format,
            frame.size,
            1,
            wgpu::TextureUsages::empty(),
        )
    };
    let accumulated = [texture()?, texture()?];
    let passes = Passes::new(gpu, 1, PASSES.given(b.spec))?;
    let target = [Some(format.into())];
    let under = |features: &[&str], from: usize| {
        FullscreenPass::new(
            gpu,
            "methods::depth_peel::under",
            features,
            &[],
            &[
                Bind::Texture(&accumulated[from]),
                Bind::Texture(&peel.layer),
                Bind::Uint(&peel.keys[1 - from]),
                Bind::Write(&passes.found),
            ],
            &target,
        )
    };
    let resolve = |from: usize| {
        FullscreenPass::resolve(
            gpu,
            "methods::depth_peel::resolve",
            &[],
            &[],
            &[
                Bind::Texture(&frame.background),
                Bind::Texture(&accumulated[from]),
            ],
            frame.output,
        )
    };
    Ok(Box::new(DepthPeel {
        under: [
            [under(&[], 0)?, under(&[], 1)?],
            [under(&["counted"], 0)?, under(&["counted"], 1)?],
        ],
        resolve: [resolve(0)?, resolve(1)?],
        peel,
        accumulated,
        passes,
    }))
}

impl Compositor for DepthPeel {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let passes = self.passes.begin(cx)?;
        if cx.only_count {
            return Ok(FrameStats::default());
        }
        self.peel.init(cx.recorder);
        drop(cx.recorder.render(
            "clear",
            &[clear_color(&self.accumulated[0], [0.0, 0.0, 0.0, 1.0])],
            None,
        ));
        for number in 0..passes {
            let from = (number % 2) as usize;
            self.passes.before(cx);
            self.peel.peel(cx.recorder, cx.scene, cx.frame, number);
            self.under[usize::from(cx.counting)][from].draw(
                cx.recorder,
                &[clear_color(&self.accumulated[1 - from], [0.0; 4])],
            );
            self.passes.after(cx, number);
        }
        cx.resolve(&self.resolve[(passes % 2) as usize]);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: passes,
            fullscreen_passes: passes + 3,
            bytes_per_pixel: single::BYTES_PER_PIXEL + 2.0 * 16.0,
            ..Default::default()
        })
    }

    fn is_ready(&self) -> bool {
        self.passes.is_known()
    }

    fn feedback(&self) -> Vec<(wgpu::Buffer, Range<u64>)> {
        self.passes.feedback()
    }

    fn learn(
        &mut self,
        _cx: &Learning<'_>,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        self.passes.learn(words, stats)
    }

    fn version(&self) -> u64 {
        self.passes.version()
    }
}
