//! `dfaoit`: the two nearest fragments exact, the colour of the rest from a network (Tsopouridis, Vasilakos & Fudos 2024),
//! drawn with the exported text itself.

use super::{
    commutative::{Blend, Target},
    compositor::{Build, Compositor, DrawContext, FrameStats},
    depth_peel::COINCIDENT,
    method::{Method, Promises},
    parameter::{Precision, TARGETS},
    weighted::SUMS,
};
use crate::error::RenderError;
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
    // The tail's colour is the network's, not a mean.
    promises: |_| Promises {
        normalised: false,
        ..Promises::NORMALISED
    },
    twin: Some(|_, p| {
        let model = p.model?;
        let Inputs::Tail(features) = model.meta.recipe.inputs else {
            return None;
        };
        let tail = |known: &dfaoit::Tail| {
            let color = model.answers(features, known);
            [0, 1, 2].map(|k| color[k] as f32)
        };
        Some(dfaoit::composite(p.fragments, p.background, tail))
    }),
    flaws: &[COINCIDENT],
    ..Method::new(
        "dfaoit",
        "Tsopouridis et al. 2024: two layers exact, the colour of the rest from a network",
        build,
    )
};

/// Layers that are composited exactly.
const FRONT: u32 = 2;

#[derive(Debug)]
struct Dfaoit {
    peel: SinglePeel,
    /// What is composited so far, in turn.
    front: [wgpu::TextureView; 2],
    under: [FullscreenPass; 2],
    second: Bound,
    tail: GeometryPipelines,
    sums: [wgpu::TextureView; 2],
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
    let targets = [
        SUMS,
        Target {
            label: "tail absorbance",
            channels: 2,
            full: false,
            blend: Blend::Add,
        },
    ];
    let texture =
        |label, format| gpu.texture(label, format, frame.size, 1, wgpu::TextureUsages::empty());
    let format = wgpu::TextureFormat::Rgba32Float;
    let front = [texture("front", format)?, texture("front", format)?];
    let sums = [
        texture(targets[0].label, targets[0].format(full))?,
        texture(targets[1].label, targets[1].format(full))?,
    ];
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
    let tail = b.scene.pipelines(
        gpu,
        frame,
        Surfaces::Transparent,
        &GeometryPass {
            label: "tail",
            shader: "methods::dfaoit::tail",
            extra: &extra,
            group: Some(&second),
            targets: &targets.map(|t| Some(t.state(full))),
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
        ],
        frame.output,
    )?;
    let bytes = targets
        .map(|t| f64::from(t.bytes(full)))
        .iter()
        .sum::<f64>();
    Ok(Box::new(Dfaoit {
        under: [under(0)?, under(1)?],
        peel,
        front,
        second,
        tail,
        sums,
        resolve,
        bytes_per_pixel: single::BYTES_PER_PIXEL + 2.0 * 16.0 + bytes,
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
            let colors = [0, 1].map(|i| clear_color(&self.sums[i], [0.0; 4]));
            let mut pass = cx.recorder.render("tail", &colors, None);
            pass.set_bind_group(1, &self.second.group, &[]);
            cx.scene
                .draw(&mut pass, cx.frame, Surfaces::Transparent, &self.tail);
        }
        let output = cx.output();
        self.resolve.draw(cx.recorder, &[output]);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: FRONT + 1,
            fullscreen_passes: FRONT + 3,
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
