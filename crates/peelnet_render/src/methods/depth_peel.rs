//! `depth-peel`: front to back, one layer a pass (Everitt 2001), until a pass peels nothing.

use super::{Build, Compositor, Count, DrawContext, FrameStats, Method, Parameter, Promises};
use crate::{
    Flaw, Property, RenderError,
    passes::{
        count::CountPass,
        fullscreen::FullscreenPass,
        single::{self, SinglePeel},
    },
    scene::clear_color,
};
use peelnet_core::methods::over;
use peelnet_gpu::{bind::Bind, wgpu};

pub(super) const PASSES: Count = Count {
    name: "passes",
    about: "a cap on the number of peeling passes",
};

/// Coincident fragments that are drawn in another order.
pub(super) const COINCIDENT: Flaw = Flaw::new(
    Property::Order,
    &["coplanar"],
    "coincident fragments are told apart by a depth test that keeps the first drawn, so that they must be drawn in the order of their numbers",
);

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(PASSES)],
    promises: |s| Promises {
        exact: PASSES.given(s).is_none(),
        sorted: PASSES.given(s).is_none(),
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
    found: wgpu::Buffer,
    count: Option<CountPass>,
    max_passes: u64,
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
            wgpu::TextureUsages::empty(),
        )
    };
    let accumulated = [texture()?, texture()?];
    let found = gpu.storage("found", 8)?;
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
                Bind::Write(&found),
            ],
            &target,
        )
    };
    let resolve = |from: usize| {
        FullscreenPass::new(
            gpu,
            "methods::depth_peel::resolve",
            &[],
            &[],
            &[
                Bind::Texture(&frame.background),
                Bind::Texture(&accumulated[from]),
            ],
            &target,
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
        found,
        count: None,
        max_passes: PASSES.given(b.spec).unwrap_or(u64::MAX),
    }))
}

impl Compositor for DepthPeel {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let gpu = cx.recorder.gpu();
        let total = super::dual_peel::count(&mut self.count, cx)?;
        self.peel.init(cx.recorder);
        drop(cx.recorder.render(
            "clear",
            &[clear_color(&self.accumulated[0], [0.0, 0.0, 0.0, 1.0])],
            None,
        ));
        let (mut passes, mut peeled) = (0u32, 0u64);
        while u64::from(passes) < self.max_passes {
            let from = (passes % 2) as usize;
            cx.recorder.encoder().clear_buffer(&self.found, 0, None);
            self.peel.peel(cx.recorder, cx.scene, cx.frame, passes);
            self.under[usize::from(cx.counting)][from].draw(
                cx.recorder,
                &[clear_color(&self.accumulated[1 - from], [0.0; 4])],
            );
            cx.recorder.submit();
            passes += 1;
            let found: Vec<u32> = gpu.read(&self.found, 0..8)?;
            peeled += u64::from(found[1]);
            if found[0] == 0 {
                break;
            }
        }
        self.resolve[(passes % 2) as usize]
            .draw(cx.recorder, &[clear_color(&cx.frame.image, [0.0; 4])]);
        Ok(FrameStats {
            fragments: total.map(|t| t.total),
            max_layers: total.map(|t| t.most),
            lost: total.map_or(0, |t| t.total - peeled),
            tiles: 1,
            geometry_passes: passes,
            fullscreen_passes: passes + 3,
            bytes_per_pixel: single::BYTES_PER_PIXEL + 2.0 * 16.0,
        })
    }
}
