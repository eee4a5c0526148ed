//! `dual-peel`: two layers a pass, one from the front (under) and one from the back (over), until nothing is left
//! (Bavoil & Myers 2008).

use super::{
    compositor::{Build, Compositor, DrawContext, Fit, FrameStats, Learning},
    depth_peel::PASSES,
    method::{Method, Promises},
    parameter::{Parameter, Precision, Word},
    peeling::Passes,
    spec::MethodSpec,
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::over;
use peelnet_gpu::{bind::Bind, wgpu};
use peelnet_raster::{
    dual::{self, DualPeel},
    frame::{attachment, clear_color},
    fullscreen::FullscreenPass,
};
use std::ops::Range;

/// Precision of the colours that layers are blended into; peeled depths have 32 bits always.
const COLORS: Word = Word {
    name: "colors",
    about: "f32 (default) or f16: what layers are blended into",
    words: &["f32", "f16"],
};

fn colors(spec: &MethodSpec) -> Precision {
    if COLORS.of(spec) == "f16" {
        Precision::Half
    } else {
        Precision::Full
    }
}

const COINCIDENT: Flaw = Flaw::new(
    Property::Order,
    &["coplanar"],
    "coincident fragments are blended into one layer, so that they must be drawn in the order of their numbers",
);

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(PASSES), Parameter::Word(COLORS)],
    promises: |s| Promises {
        exact: PASSES.given(s).is_none() && colors(s) == Precision::Full,
        sums: colors(s),
        sorted: PASSES.given(s).is_none(),
        peels: true,
        ..Promises::EXACT
    },
    curve: &["", ":passes=2", ":passes=4"],
    twin: Some(|s, p| {
        let mut reached = over::sorted(p.fragments);
        // One layer a pass from either end.
        let n = reached.len();
        let front = n.min(PASSES.given(s).unwrap_or(u64::MAX) as usize);
        let back = front.min(n - front);
        reached.drain(front..n - back);
        Some(over::composite(&reached, p.background))
    }),
    flaws: &[COINCIDENT.when(|s| PASSES.given(s).is_none())],
    ..Method::new("dual-peel", "exact: both ends, two layers a pass", build)
};

#[derive(Debug)]
struct Dual {
    peel: DualPeel,
    fronts: wgpu::TextureView,
    backs: wgpu::TextureView,
    /// By parity of the pass.
    blend: [FullscreenPass; 2],
    resolve: FullscreenPass,
    passes: Passes,
    /// Bytes a pixel of fronts and backs.
    blended_bytes: f64,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    use wgpu::BlendFactor::{DstAlpha, One, OneMinusSrcAlpha, Zero};
    let (gpu, frame) = (b.gpu, b.frame);
    let (format, bytes) = match colors(b.spec) {
        Precision::Half => (wgpu::TextureFormat::Rgba16Float, 8.0),
        Precision::Full => (wgpu::TextureFormat::Rgba32Float, 16.0),
    };
    let texture =
        |label: &str| gpu.texture(label, format, frame.size, 1, wgpu::TextureUsages::empty());
    let (fronts, backs) = (texture("fronts")?, texture("backs")?);
    let passes = Passes::new(gpu, 2, PASSES.given(b.spec))?;
    let peel = DualPeel::new(gpu, b.scene, frame, &[], Some(&passes.found))?;
    let component = |src_factor, dst_factor| wgpu::BlendComponent {
        src_factor,
        dst_factor,
        operation: wgpu::BlendOperation::Add,
    };
    let target = |color| {
        Some(wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState {
                color,
                alpha: component(Zero, OneMinusSrcAlpha),
            }),
            write_mask: wgpu::ColorWrites::ALL,
        })
    };
    // Under-blending for the front, over-blending for the back; alpha is the transmittance of each stack.
    let targets = [
        target(component(DstAlpha, One)),
        target(component(One, OneMinusSrcAlpha)),
    ];
    let blend = |from: usize| {
        FullscreenPass::new(
            gpu,
            "methods::dual_peel::blend",
            &[],
            &[],
            &[
                Bind::Texture(&peel.ranges[from]),
                Bind::Texture(&peel.ranges[1 - from]),
                Bind::Texture(&peel.front),
                Bind::Texture(&peel.back),
                Bind::Write(&passes.found),
            ],
            &targets,
        )
    };
    let resolve = FullscreenPass::resolve(
        gpu,
        "methods::dual_peel::resolve",
        &[],
        &[],
        &[
            Bind::Texture(&frame.background),
            Bind::Texture(&fronts),
            Bind::Texture(&backs),
        ],
        frame.output,
    )?;
    Ok(Box::new(Dual {
        blend: [blend(0)?, blend(1)?],
        peel,
        fronts,
        backs,
        resolve,
        passes,
        blended_bytes: 2.0 * bytes,
    }))
}

impl Compositor for Dual {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let passes = self.passes.begin(cx)?;
        if cx.only_count {
            return Ok(FrameStats::default());
        }
        self.peel.init(cx.recorder, cx.scene, cx.frame);
        let start = [0.0, 0.0, 0.0, 1.0];
        drop(cx.recorder.render(
            "clear",
            &[
                clear_color(&self.fronts, start),
                clear_color(&self.backs, start),
            ],
            None,
        ));
        for number in 0..passes {
            self.passes.before(cx);
            self.peel
                .peel(cx.recorder, cx.scene, cx.frame, number, cx.counting);
            self.blend[(number % 2) as usize].draw(
                cx.recorder,
                &[
                    attachment(&self.fronts, wgpu::LoadOp::Load),
                    attachment(&self.backs, wgpu::LoadOp::Load),
                ],
            );
            self.passes.after(cx, number);
        }
        cx.resolve(&self.resolve);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: passes + 1,
            fullscreen_passes: passes + 2,
            bytes_per_pixel: dual::BYTES_PER_PIXEL + self.blended_bytes,
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
