//! `dual-peel`: two layers a pass, one from the front (under) and one from the back (over), until nothing is left
//! (Bavoil & Myers 2008).

use super::{
    Build, Compositor, DrawContext, FrameStats, Method, Parameter, Promises, depth_peel::PASSES,
};
use crate::{
    Flaw, Property, RenderError,
    passes::{
        count::{CountPass, FragmentCount},
        dual::{self, DualPeel},
        fullscreen::FullscreenPass,
    },
    scene::{attachment, clear_color},
};
use peelnet_core::methods::over;
use peelnet_gpu::{bind::Bind, wgpu};

const fn coplanar(property: Property) -> Flaw {
    let reason = "keeps one coincident fragment at either end and counts the rest as lost (Bavoil & Myers 2008)";
    Flaw::new(property, &["coplanar"], reason).when(|s| PASSES.given(s).is_none())
}

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(PASSES)],
    promises: |s| Promises {
        exact: PASSES.given(s).is_none(),
        sorted: PASSES.given(s).is_none(),
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
    flaws: &[
        coplanar(Property::Background),
        coplanar(Property::Exact),
        coplanar(Property::Hull),
    ],
    ..Method::new(
        "dual-peel",
        "exact but for coplanar fragments: both ends, two layers a pass",
        build,
    )
};

#[derive(Debug)]
struct Dual {
    peel: DualPeel,
    fronts: wgpu::TextureView,
    backs: wgpu::TextureView,
    /// By parity of the pass, without and with counting.
    blend: [[FullscreenPass; 2]; 2],
    resolve: FullscreenPass,
    found: wgpu::Buffer,
    count: Option<CountPass>,
    max_passes: u64,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    use wgpu::BlendFactor::{DstAlpha, One, OneMinusSrcAlpha, Zero};
    let (gpu, frame) = (b.gpu, b.frame);
    let peel = DualPeel::new(gpu, b.scene, frame, &[])?;
    let format = wgpu::TextureFormat::Rgba32Float;
    let texture =
        |label: &str| gpu.texture(label, format, frame.size, wgpu::TextureUsages::empty());
    let (fronts, backs) = (texture("fronts")?, texture("backs")?);
    let found = gpu.storage("found", 8)?;
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
    let blend = |features: &[&str], from: usize| {
        FullscreenPass::new(
            gpu,
            "methods::dual_peel::blend",
            features,
            &[],
            &[
                Bind::Texture(&peel.ranges[from]),
                Bind::Texture(&peel.ranges[1 - from]),
                Bind::Texture(&peel.front),
                Bind::Texture(&peel.back),
                Bind::Write(&found),
            ],
            &targets,
        )
    };
    let resolve = FullscreenPass::new(
        gpu,
        "methods::dual_peel::resolve",
        &[],
        &[],
        &[
            Bind::Texture(&frame.background),
            Bind::Texture(&fronts),
            Bind::Texture(&backs),
        ],
        &[Some(format.into())],
    )?;
    Ok(Box::new(Dual {
        blend: [
            [blend(&[], 0)?, blend(&[], 1)?],
            [blend(&["counted"], 0)?, blend(&["counted"], 1)?],
        ],
        peel,
        fronts,
        backs,
        resolve,
        found,
        count: None,
        max_passes: PASSES.given(b.spec).unwrap_or(u64::MAX),
    }))
}

/// Counts the frame's fragments where statistics are asked for.
pub(super) fn count(
    pass: &mut Option<CountPass>,
    cx: &mut DrawContext<'_, '_>,
) -> Result<Option<FragmentCount>, RenderError> {
    if !cx.counting {
        return Ok(None);
    }
    let counter = match pass {
        Some(counter) => counter,
        None => pass.insert(CountPass::new(cx.recorder.gpu(), cx.scene, cx.frame, &[])?),
    };
    counter.run(cx.recorder, cx.scene, cx.frame).map(Some)
}

impl Compositor for Dual {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let gpu = cx.recorder.gpu();
        let total = count(&mut self.count, cx)?;
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
        let (mut passes, mut peeled) = (0u32, 0u64);
        while u64::from(passes) < self.max_passes {
            cx.recorder.encoder().clear_buffer(&self.found, 0, None);
            self.peel.peel(cx.recorder, cx.scene, cx.frame, passes);
            self.blend[usize::from(cx.counting)][(passes % 2) as usize].draw(
                cx.recorder,
                &[
                    attachment(&self.fronts, wgpu::LoadOp::Load),
                    attachment(&self.backs, wgpu::LoadOp::Load),
                ],
            );
            cx.recorder.submit();
            passes += 1;
            let found: Vec<u32> = gpu.read(&self.found, 0..8)?;
            peeled += u64::from(found[1]);
            if found[0] == 0 {
                break;
            }
        }
        self.resolve
            .draw(cx.recorder, &[clear_color(&cx.frame.image, [0.0; 4])]);
        Ok(FrameStats {
            fragments: total.map(|t| t.total),
            max_layers: total.map(|t| t.most),
            lost: total.map_or(0, |t| t.total - peeled),
            tiles: 1,
            geometry_passes: passes + 1,
            fullscreen_passes: passes + 2,
            bytes_per_pixel: dual::BYTES_PER_PIXEL + 2.0 * 16.0,
        })
    }
}
