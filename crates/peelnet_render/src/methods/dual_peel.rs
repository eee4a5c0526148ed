//! `dual-peel`: two layers a pass, one from the front (under) and one from the back (over), until nothing is left
//! (Bavoil & Myers 2008).

use super::{
    peeling::{self, PASSES, Peel, Peeling},
    prelude::*,
};
use peelnet_core::methods::over;
use peelnet_gpu::{bind::Bind, wgpu};
use peelnet_raster::{
    dual::{self, DualPeel},
    frame::{attachment, clear_color},
    fullscreen::FullscreenPass,
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

const COINCIDENT: Flaw = Flaw::new(
    Property::Order,
    "coplanar",
    "coincident fragments are blended into one layer, so that they must be drawn in the order of their numbers",
);

pub(super) const METHOD: Method = Method {
    parameters: &[PASSES, COLORS],
    promises: |s| Promises {
        exact: PASSES.count(s).is_none() && colors(s) == Precision::Full,
        sums: colors(s),
        sorted: PASSES.count(s).is_none(),
        peels: true,
        ..Promises::EXACT
    },
    curve: &["", ":passes=2", ":passes=4"],
    twin: Some(|s, p| {
        let mut reached = over::sorted(p.fragments);
        // One layer a pass from either end.
        let n = reached.len();
        let front = n.min(PASSES.count(s).unwrap_or(u64::MAX) as usize);
        let back = front.min(n - front);
        reached.drain(front..n - back);
        Some(over::composite(&reached, p.background))
    }),
    flaws: &[COINCIDENT.when(|s| PASSES.count(s).is_none())],
    ..Method::own("dual-peel", "exact: both ends, two layers a pass", build)
};

#[derive(Debug)]
struct Dual {
    peel: DualPeel,
    fronts: wgpu::TextureView,
    backs: wgpu::TextureView,
    /// By parity of the pass.
    blend: [FullscreenPass; 2],
    resolve: FullscreenPass,
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
    let none = wgpu::TextureUsages::empty();
    let texture = |label: &str| gpu.texture(label, format, frame.size, 1, none);
    let (fronts, backs) = (texture("fronts")?, texture("backs")?);
    let found = peeling::found(gpu)?;
    let peel = DualPeel::new(gpu, b.scene, frame, &[], Some(&found))?;
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
        let entries = [
            Bind::Texture(&peel.ranges[from]),
            Bind::Texture(&peel.ranges[1 - from]),
            Bind::Texture(&peel.front),
            Bind::Texture(&peel.back),
            Bind::Write(&found),
        ];
        FullscreenPass::new(
            gpu,
            "methods::dual_peel::blend",
            &[],
            &[],
            &entries,
            &targets,
        )
    };
    let entries = [&frame.background, &fronts, &backs].map(Bind::Texture);
    let shader = "methods::dual_peel::resolve";
    let dual = Dual {
        blend: [blend(0)?, blend(1)?],
        resolve: FullscreenPass::resolve(gpu, shader, &[], &[], &entries, frame.output)?,
        peel,
        fronts,
        backs,
        blended_bytes: 2.0 * bytes,
    };
    Peeling::boxed(b, found, dual)
}

impl Peel for Dual {
    const LAYERS: u32 = 2;

    fn begin(&self, cx: &mut DrawContext<'_, '_>) {
        self.peel.init(cx.recorder, cx.scene, cx.frame);
        let start = [0.0, 0.0, 0.0, 1.0];
        let clear = [&self.fronts, &self.backs].map(|view| clear_color(view, start));
        drop(cx.recorder.render("clear", &clear, None));
    }

    fn pass(&self, cx: &mut DrawContext<'_, '_>, number: u32) {
        self.peel
            .peel(cx.recorder, cx.scene, cx.frame, number, cx.counting);
        let loaded = |view| attachment(view, wgpu::LoadOp::Load);
        let targets = [loaded(&self.fronts), loaded(&self.backs)];
        self.blend[(number % 2) as usize].draw(cx.recorder, &targets);
    }

    fn resolve(&self, _: u32) -> &FullscreenPass {
        &self.resolve
    }

    fn besides(&self) -> (u32, u32, f64) {
        (1, 2, dual::BYTES_PER_PIXEL + self.blended_bytes)
    }
}
