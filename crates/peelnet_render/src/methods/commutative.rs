//! The driver of every commutative method: geometry passes into blended targets, then one resolve.
//!
//! A method states its targets, its passes and its resolve; their bindings, bytes and passes follow from that.

use super::{Build, Compositor, DrawContext, FrameStats};
use crate::{
    RenderError,
    passes::fullscreen::FullscreenPass,
    scene::{GeometryPass, GeometryPipelines, Surfaces, clear_color},
};
use peelnet_core::guards::HALF_MAX;
use peelnet_gpu::{
    bind::{Bind, Bound},
    wgpu,
};

/// How a target blends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blend {
    /// `dst + src`, from 0.
    Add,
    /// `dst · (1 − src)`, from 1.
    Transmit,
    /// `max(dst, src)` of red, green and blue, from the smallest half; `dst + src` of alpha, from 0.
    MaxAdd,
}

impl Blend {
    /// What a target is cleared to.
    fn start(self) -> [f64; 4] {
        let least = -f64::from(HALF_MAX);
        match self {
            Self::Add => [0.0; 4],
            Self::Transmit => [1.0; 4],
            Self::MaxAdd => [least, least, least, 0.0],
        }
    }

    fn state(self) -> wgpu::BlendState {
        use wgpu::{BlendFactor as F, BlendOperation as O};
        let component = |src_factor, dst_factor, operation| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation,
        };
        let add = component(F::One, F::One, O::Add);
        let transmit = component(F::Zero, F::OneMinusSrc, O::Add);
        let (color, alpha) = match self {
            Self::Add => (add, add),
            Self::Transmit => (transmit, transmit),
            Self::MaxAdd => (component(F::One, F::One, O::Max), add),
        };
        wgpu::BlendState { color, alpha }
    }
}

/// One accumulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub label: &'static str,
    /// 1, 2 or 4.
    pub channels: u32,
    /// Whether it has 32 bits a channel unless the method's knob says otherwise.
    pub full: bool,
    pub blend: Blend,
}

/// One geometry pass: its shader, the targets it writes and those (of earlier passes) it reads.
#[derive(Debug)]
pub(crate) struct Gather<'a> {
    pub label: &'static str,
    pub shader: &'static str,
    pub features: &'a [&'a str],
    pub extra: &'a [(&'a str, &'a str)],
    pub writes: &'a [usize],
    pub reads: &'a [usize],
}

/// A commutative method.
#[derive(Debug)]
pub(crate) struct Plan<'a> {
    pub targets: &'a [Target],
    pub passes: &'a [Gather<'a>],
    pub resolve: &'static str,
    /// Compile-time features of the resolve.
    pub resolve_features: &'a [&'a str],
    /// Targets that the resolve reads, after `C_0`.
    pub resolve_reads: &'a [usize],
}

#[derive(Debug)]
struct BuiltPass {
    label: &'static str,
    pipelines: GeometryPipelines,
    reads: Option<Bound>,
    writes: Vec<usize>,
}

#[derive(Debug)]
struct Commutative {
    targets: Vec<(wgpu::TextureView, Blend)>,
    passes: Vec<BuiltPass>,
    resolve: FullscreenPass,
    bytes_per_pixel: f64,
}

impl Target {
    pub(crate) fn format(&self, full: bool) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as F;
        match (self.channels, full) {
            (1, false) => F::R16Float,
            (2, false) => F::Rg16Float,
            (_, false) => F::Rgba16Float,
            (1, true) => F::R32Float,
            (2, true) => F::Rg32Float,
            (_, true) => F::Rgba32Float,
        }
    }

    /// Bytes a pixel.
    pub(crate) const fn bytes(&self, full: bool) -> u32 {
        self.channels * if full { 4 } else { 2 }
    }

    pub(crate) fn state(&self, full: bool) -> wgpu::ColorTargetState {
        wgpu::ColorTargetState {
            format: self.format(full),
            blend: Some(self.blend.state()),
            write_mask: wgpu::ColorWrites::ALL,
        }
    }
}

/// Makes a plan ready, with 16- or 32-bit targets as the method's knob says.
pub(super) fn build(b: &Build<'_>, plan: &Plan<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let knob = b.spec.full_precision()?;
    let is_full = |t: &Target| knob.unwrap_or(t.full);
    if plan.targets.iter().any(is_full) {
        b.gpu.need(
            wgpu::Features::FLOAT32_BLENDABLE,
            "float32-blendable",
            &b.spec.to_string(),
            "use targets=f16",
        )?;
    }
    let mut targets = Vec::new();
    for t in plan.targets {
        let view = b.gpu.texture(
            t.label,
            t.format(is_full(t)),
            b.frame.size,
            wgpu::TextureUsages::empty(),
        )?;
        targets.push((view, t.blend));
    }
    let mut passes = Vec::new();
    for gather in plan.passes {
        let reads = (!gather.reads.is_empty()).then(|| {
            let entries: Vec<_> = gather
                .reads
                .iter()
                .map(|&i| Bind::Texture(&targets[i].0))
                .collect();
            b.gpu
                .bind(gather.label, wgpu::ShaderStages::FRAGMENT, &entries)
        });
        let states: Vec<_> = gather
            .writes
            .iter()
            .map(|&i| Some(plan.targets[i].state(is_full(&plan.targets[i]))))
            .collect();
        let pipelines = b.scene.pipelines(
            b.gpu,
            b.frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: gather.label,
                shader: gather.shader,
                features: gather.features,
                extra: gather.extra,
                group: reads.as_ref().map(|r| &r.layout),
                targets: &states,
                depth: None,
            },
        )?;
        passes.push(BuiltPass {
            label: gather.label,
            pipelines,
            reads,
            writes: gather.writes.to_vec(),
        });
    }
    let mut entries = vec![Bind::Texture(&b.frame.background)];
    entries.extend(
        plan.resolve_reads
            .iter()
            .map(|&i| Bind::Texture(&targets[i].0)),
    );
    let resolve = FullscreenPass::new(
        b.gpu,
        plan.resolve,
        plan.resolve_features,
        &[],
        &entries,
        &[Some(wgpu::TextureFormat::Rgba32Float.into())],
    )?;
    let bytes_per_pixel = plan
        .targets
        .iter()
        .map(|t| t.bytes(is_full(t)))
        .sum::<u32>()
        .into();
    Ok(Box::new(Commutative {
        targets,
        passes,
        resolve,
        bytes_per_pixel,
    }))
}

impl Compositor for Commutative {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        for p in &self.passes {
            let colors: Vec<_> = p
                .writes
                .iter()
                .map(|&i| {
                    let (view, blend) = &self.targets[i];
                    clear_color(view, blend.start())
                })
                .collect();
            let mut pass = cx.recorder.render(p.label, &colors, None);
            if let Some(reads) = &p.reads {
                pass.set_bind_group(1, &reads.group, &[]);
            }
            cx.scene
                .draw(&mut pass, cx.frame, Surfaces::Transparent, &p.pipelines);
        }
        self.resolve
            .draw(cx.recorder, &[clear_color(&cx.frame.image, [0.0; 4])]);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: self.passes.len() as u32,
            fullscreen_passes: 1,
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
