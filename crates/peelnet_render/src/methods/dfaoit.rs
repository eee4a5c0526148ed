//! `dfaoit`: up to two fragments exact, the colour of more from a network (Tsopouridis, Vasilakis & Fudos 2024), drawn with the exported
//! text itself. Passes are those of the authors' shaders for portable hardware: two peels, and one pass of sums.

use super::{
    commutative::{Blend, Target},
    compositor::{Build, Compositor, DrawContext, FrameStats},
    depth_peel::COINCIDENT,
    method::{Method, Promises},
    parameter::{Precision, TARGETS},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::dfaoit;
use peelnet_gpu::{
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_model::Inputs;
use peelnet_raster::{
    GeometryPass, GeometryPipelines, Surfaces,
    frame::clear_color,
    fullscreen::FullscreenPass,
    single::{self, SinglePeel},
};

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    learned: true,
    // The colour is the network's, not a mean.
    promises: |_| Promises {
        normalised: false,
        ..Promises::NORMALISED
    },
    twin: Some(|_, p| {
        let model = p.model?;
        let Inputs::Layers(features) = model.meta.recipe.inputs else {
            return None;
        };
        let network = |known: &dfaoit::Layers| {
            let color = model.answers(features, known);
            [0, 1, 2].map(|k| color[k] as f32)
        };
        Some(dfaoit::composite(p.fragments, p.background, network))
    }),
    flaws: &[
        COINCIDENT,
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "the network's own error: it predicts the nearest layers' colour with that of the others (Tsopouridis et al. 2024)",
        ),
    ],
    ..Method::new(
        "dfaoit",
        "Tsopouridis et al. 2024: up to two layers exact, the colour of more from a network",
        build,
    )
};

/// Layers that are composited exactly.
const FRONT: u32 = dfaoit::FRONT as u32;

/// Sums over the fragments behind the front, over all fragments, and the number of those behind.
const SUMS: [Target; 3] = {
    const fn target(label: &'static str, channels: u32, blend: Blend) -> Target {
        Target {
            label,
            channels,
            full: false,
            blend,
        }
    }
    [
        target("behind", 4, Blend::Add),
        target("all", 4, Blend::AddTransmit),
        target("count", 1, Blend::Add),
    ]
};

#[derive(Debug)]
struct Dfaoit {
    peel: SinglePeel,
    /// What is composited so far, in turn.
    front: [wgpu::TextureView; 2],
    under: [FullscreenPass; 2],
    second: Bound,
    gather: GeometryPipelines,
    sums: [wgpu::TextureView; 3],
    resolve: FullscreenPass,
    bytes_per_pixel: f64,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (gpu, frame) = (b.gpu, b.frame);
    let learned = b.learned_weight()?;
    let full = b.spec.targets() == Some(Precision::Full);
    if full {
        gpu.need(
            wgpu::Features::FLOAT32_BLENDABLE,
            "float32-blendable",
            &b.spec.to_string(),
            "use targets=f16",
        )?;
    }
    let peel = SinglePeel::new(gpu, b.scene, frame, &[])?;
    let texture =
        |label, format| gpu.texture(label, format, frame.size, 1, wgpu::TextureUsages::empty());
    let format = wgpu::TextureFormat::Rgba32Float;
    let front = [texture("front", format)?, texture("front", format)?];
    let [behind, all, count] = SUMS.map(|t| texture(t.label, t.format(full)));
    let sums = [behind?, all?, count?];
    let found = gpu.storage("found", 8)?;
    let image = [Some(format.into())];
    let under = |from: usize| {
        FullscreenPass::new(
            gpu,
            "methods::depth_peel::under",
            &[],
            &[],
            &[
                Bind::Texture(&front[from]),
                Bind::Texture(&peel.layer),
                Bind::Uint(&peel.keys[1 - from]),
                Bind::Write(&found),
            ],
            &image,
        )
    };
    // Two peels later the last key lies in the first texture again.
    let second = gpu.bind(
        "second key",
        wgpu::ShaderStages::FRAGMENT,
        &[Bind::Uint(&peel.keys[0])],
    );
    let extra = [("learned::weight", learned.wgsl.as_str())];
    let gather = b.scene.pipelines(
        gpu,
        frame,
        Surfaces::Transparent,
        &GeometryPass {
            label: "gather",
            shader: "methods::dfaoit::gather",
            extra: &extra,
            group: Some(&second),
            targets: &SUMS.map(|t| Some(t.state(full))),
            ..GeometryPass::NONE
        },
    )?;
    let resolve = FullscreenPass::resolve(
        gpu,
        "methods::dfaoit::resolve",
        &[],
        &extra,
        &[
            Bind::Texture(&frame.background),
            Bind::Texture(&front[0]),
            Bind::Texture(&sums[0]),
            Bind::Texture(&sums[1]),
            Bind::Texture(&sums[2]),
        ],
        frame.output,
    )?;
    let bytes: u32 = SUMS.iter().map(|t| t.bytes(full)).sum();
    Ok(Box::new(Dfaoit {
        under: [under(0)?, under(1)?],
        peel,
        front,
        second,
        gather,
        sums,
        resolve,
        bytes_per_pixel: single::BYTES_PER_PIXEL + 2.0 * 16.0 + f64::from(bytes),
    }))
}

impl Compositor for Dfaoit {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        self.peel.init(cx.recorder);
        drop(cx.recorder.render(
            "clear",
            &[clear_color(&self.front[0], [0.0, 0.0, 0.0, 1.0])],
            None,
        ));
        for layer in 0..FRONT {
            let from = (layer % 2) as usize;
            self.peel.peel(cx.recorder, cx.scene, cx.frame, layer);
            self.under[from].draw(cx.recorder, &[clear_color(&self.front[1 - from], [0.0; 4])]);
        }
        {
            let colors = [0, 1, 2].map(|i| clear_color(&self.sums[i], SUMS[i].blend.start()));
            let mut pass = cx.recorder.render("gather", &colors, None);
            pass.set_bind_group(1, &self.second.group, &[]);
            cx.scene
                .draw(&mut pass, cx.frame, Surfaces::Transparent, &self.gather);
        }
        cx.resolve(&self.resolve);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: FRONT + 1,
            fullscreen_passes: FRONT + 3,
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
