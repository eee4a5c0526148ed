//! The driver of every method with a fixed number of passes: geometry passes into blended targets and storage of so many
//! values a pixel, then one resolve.
//!
//! A method states its targets, its storage, its passes and its resolve; their bindings, bytes and passes follow from that.
//! All but the painter's methods give the same image whatever the order of drawing.

use super::{
    compositor::{Build, Compositor, DrawContext, FrameStats},
    parameter::Precision,
};
use crate::error::RenderError;
use peelnet_core::guards::HALF_MAX;
use peelnet_gpu::{
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_raster::{
    BoxPass, GeometryPass, GeometryPipelines, Order, Sorted, Surfaces,
    count::{groups_2d, unwritten, unwritten_attachment, unwritten_texture},
    frame::clear_color,
    fullscreen::FullscreenPass,
};

/// How a target blends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blend {
    /// `dst + src`, from 0.
    Add,
    /// `dst · (1 − src)`, from 1.
    Transmit,
    /// `dst + src` of red, green and blue, from 0; `dst · (1 − src.a)` of alpha, from 1.
    AddTransmit,
    /// `src + dst · (1 − src.a)` of premultiplied colour, from 0; `dst · (1 − src.a)` of alpha, from 1.
    Over,
    /// `max(dst, src)` of red, green and blue, from the smallest half; `dst + src` of alpha, from 0.
    MaxAdd,
    /// `max(dst, src)`, from the smallest half.
    Max,
    /// `max(dst, src)` of 8-bit channels, 0 … 1, from 0.
    MaxBytes,
}

impl Blend {
    /// What a target is cleared to.
    pub(crate) fn start(self) -> [f64; 4] {
        let least = -f64::from(HALF_MAX);
        match self {
            Self::Add | Self::MaxBytes => [0.0; 4],
            Self::Max => [least; 4],
            Self::Over | Self::AddTransmit => [0.0, 0.0, 0.0, 1.0],
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
            Self::Over => (
                component(F::One, F::OneMinusSrcAlpha, O::Add),
                component(F::Zero, F::OneMinusSrcAlpha, O::Add),
            ),
            Self::Transmit => (transmit, transmit),
            Self::AddTransmit => (add, component(F::Zero, F::OneMinusSrcAlpha, O::Add)),
            Self::MaxAdd => (component(F::One, F::One, O::Max), add),
            Self::Max | Self::MaxBytes => {
                let max = component(F::One, F::One, O::Max);
                (max, max)
            }
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
    /// Whether it has 32 bits a channel unless `targets` says otherwise.
    pub full: bool,
    pub blend: Blend,
}

/// A buffer, zero at the start of every frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Storage {
    pub label: &'static str,
    /// Of each pixel.
    pub bytes: u32,
    /// Of the frame, besides those of its pixels.
    pub of_frame: u64,
}

/// A compute shader between two geometry passes. Bindings: the frame's size as `vec4u`, and the storage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernel<'a> {
    /// The geometry pass that it follows.
    pub after: usize,
    pub shader: &'a str,
    pub extra: &'a [(&'a str, &'a str)],
    /// The storage that it rewrites.
    pub storage: usize,
    /// Workgroups have 64 of them.
    pub threads: u64,
}

/// One geometry pass: its shader and what it writes and reads. In bind group 1: targets (of earlier passes) that it reads,
/// storage that it reads, storage that it writes.
#[derive(Debug)]
pub(crate) struct Gather<'a> {
    pub label: &'static str,
    pub shader: &'static str,
    pub features: &'a [&'a str],
    pub extra: &'a [(&'a str, &'a str)],
    pub writes: &'a [usize],
    pub reads: &'a [usize],
    pub loads: &'a [usize],
    pub stores: &'a [usize],
    /// Draws boxes around transparent parts instead of their surfaces.
    pub boxes: bool,
}

impl Gather<'_> {
    /// What most passes leave out.
    pub(crate) const NONE: Gather<'static> = Gather {
        label: "gather",
        shader: "",
        features: &[],
        extra: &[],
        writes: &[],
        reads: &[],
        loads: &[],
        stores: &[],
        boxes: false,
    };
}

/// A method with a fixed number of passes.
#[derive(Debug)]
pub(crate) struct Plan<'a> {
    pub targets: &'a [Target],
    pub storage: &'a [Storage],
    pub passes: &'a [Gather<'a>],
    /// What is computed between two of them.
    pub kernel: Option<Kernel<'a>>,
    /// In which order surfaces are drawn.
    pub order: Order,
    pub resolve: &'static str,
    /// Compile-time features of the resolve.
    pub resolve_features: &'a [&'a str],
    /// Modules of the resolve that are not in the repository.
    pub resolve_extra: &'a [(&'a str, &'a str)],
    /// Targets that the resolve reads, after `C_0`, and storage after those.
    pub resolve_reads: &'a [usize],
    pub resolve_loads: &'a [usize],
    /// The pass that, where light takes a colour, also writes what fragments cover of each channel, into one more target, its last; the
    /// resolve reads that behind all others.
    pub tinted_by: Option<usize>,
}

/// The sums of a pixel's nearest and farthest fragment, where they stand apart from the others'.
pub(super) const ENDS: &str = "ends";

/// `T_∞` of red, green and blue.
pub(super) const TINTED: Target = Target {
    label: "tinted transmittance",
    channels: 4,
    full: false,
    blend: Blend::Transmit,
};

impl Plan<'_> {
    /// What most methods leave out.
    pub(crate) const NONE: Plan<'static> = Plan {
        targets: &[],
        storage: &[],
        passes: &[],
        kernel: None,
        order: Order::Scene,
        resolve: "",
        resolve_features: &[],
        resolve_extra: &[],
        resolve_reads: &[],
        resolve_loads: &[],
        tinted_by: None,
    };
}

#[derive(Debug)]
struct BuiltPass {
    label: &'static str,
    drawn: Drawn,
    group: Option<Bound>,
    writes: Vec<usize>,
}

/// What a pass draws.
#[derive(Debug)]
enum Drawn {
    Surfaces(GeometryPipelines),
    Boxes(BoxPass),
}

#[derive(Debug)]
struct BuiltKernel {
    label: String,
    after: usize,
    pipeline: wgpu::ComputePipeline,
    group: Bound,
    groups: [u32; 2],
}

#[derive(Debug)]
struct Commutative {
    targets: Vec<(wgpu::TextureView, Blend)>,
    storage: Vec<wgpu::Buffer>,
    // Of passes that write storage alone.
    attachment: Option<wgpu::TextureView>,
    sorted: Option<Sorted>,
    passes: Vec<BuiltPass>,
    kernel: Option<BuiltKernel>,
    resolve: FullscreenPass,
    bytes_per_pixel: f64,
}

impl Target {
    pub(crate) fn format(&self, full: bool) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as F;
        if self.blend == Blend::MaxBytes {
            return match self.channels {
                1 => F::R8Unorm,
                2 => F::Rg8Unorm,
                _ => F::Rgba8Unorm,
            };
        }
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
        let of_channel = match (self.blend, full) {
            (Blend::MaxBytes, _) => 1,
            (_, false) => 2,
            (_, true) => 4,
        };
        self.channels * of_channel
    }

    pub(crate) fn state(&self, full: bool) -> wgpu::ColorTargetState {
        wgpu::ColorTargetState {
            format: self.format(full),
            blend: Some(self.blend.state()),
            write_mask: wgpu::ColorWrites::ALL,
        }
    }
}

/// Makes a plan ready, with 16- or 32-bit targets as the method's `targets` says.
pub(super) fn build(b: &Build<'_>, plan: &Plan<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let tinting = plan.tinted_by.filter(|_| b.scene.tinted);
    let mut all_targets = plan.targets.to_vec();
    all_targets.extend(tinting.map(|_| TINTED));
    let asked = b.spec.targets();
    let is_full = |t: &Target| asked.map_or(t.full, |p| p == Precision::Full);
    if all_targets.iter().any(is_full) {
        b.gpu.need(
            wgpu::Features::FLOAT32_BLENDABLE,
            "float32-blendable",
            &b.spec.to_string(),
            "use targets=f16",
        )?;
    }
    let mut targets = Vec::new();
    for t in &all_targets {
        let view = b.gpu.texture(
            t.label,
            t.format(is_full(t)),
            b.frame.size,
            1,
            wgpu::TextureUsages::empty(),
        )?;
        targets.push((view, t.blend));
    }
    let pixels = u64::from(b.frame.pixels());
    let storage = plan
        .storage
        .iter()
        .map(|s| {
            let bytes = pixels * u64::from(s.bytes) + s.of_frame;
            b.gpu.storage(s.label, bytes)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let bare = plan.passes.iter().any(|p| p.writes.is_empty());
    let attachment = bare
        .then(|| unwritten_texture(b.gpu, b.frame))
        .transpose()?;
    let states: Vec<_> = all_targets.iter().map(|t| t.state(is_full(t))).collect();
    let mut passes = Vec::new();
    for (number, gather) in plan.passes.iter().enumerate() {
        let tinted = (tinting == Some(number)).then_some(plan.targets.len());
        passes.push(build_pass(b, gather, &targets, &storage, &states, tinted)?);
    }
    let kernel = plan.kernel.map(|k| build_kernel(b, &k, &storage));
    let full_sums = all_targets
        .iter()
        .any(|t| t.label == super::weighted::SUMS.label && is_full(t));
    let tinted = tinting.map(|_| &targets[plan.targets.len()].0);
    let resolve = if b.sums {
        build_sums(b, plan, &targets)?
    } else {
        build_resolve(b, plan, &targets, &storage, tinted, full_sums)?
    };
    let blended: u32 = all_targets.iter().map(|t| t.bytes(is_full(t))).sum();
    let stored: u32 = plan.storage.iter().map(|s| s.bytes).sum();
    let sorted = Sorted::new(b.gpu, b.scene, plan.order)?;
    let of_frame: u64 = plan.storage.iter().map(|s| s.of_frame).sum();
    let of_frame = of_frame + sorted.as_ref().map_or(0, Sorted::bytes);
    Ok(Box::new(Commutative {
        targets,
        storage,
        attachment,
        sorted,
        passes,
        kernel: kernel.transpose()?,
        resolve,
        bytes_per_pixel: f64::from(blended + stored + u32::from(bare))
            + of_frame as f64 / pixels as f64,
    }))
}

/// Makes what is computed between two passes ready.
fn build_kernel(
    b: &Build<'_>,
    kernel: &Kernel<'_>,
    storage: &[wgpu::Buffer],
) -> Result<BuiltKernel, RenderError> {
    let [width, height] = b.frame.size;
    let usage = wgpu::BufferUsages::UNIFORM;
    let size = b.gpu.upload("frame size", &[width, height, 0, 0], usage);
    let entries = [Bind::Uniform(&size), Bind::Write(&storage[kernel.storage])];
    let stages = wgpu::ShaderStages::COMPUTE;
    let group = b.gpu.bind(kernel.shader, stages, &entries);
    let wgsl = peelnet_shaders::link(kernel.shader, &[], kernel.extra)?;
    Ok(BuiltKernel {
        label: kernel.shader.to_owned(),
        after: kernel.after,
        pipeline: b.gpu.compute(kernel.shader, &wgsl, &group),
        group,
        groups: groups_2d(u32::try_from(kernel.threads).unwrap_or(u32::MAX)),
    })
}

/// Makes the resolve ready. `tinted` is the target of what fragments cover where transmission is coloured.
fn build_resolve(
    b: &Build<'_>,
    plan: &Plan<'_>,
    targets: &[(wgpu::TextureView, Blend)],
    storage: &[wgpu::Buffer],
    tinted: Option<&wgpu::TextureView>,
    full_sums: bool,
) -> Result<FullscreenPass, RenderError> {
    let reads = plan
        .resolve_reads
        .iter()
        .map(|&i| Bind::Texture(&targets[i].0));
    let loads = plan.resolve_loads.iter().map(|&i| Bind::Read(&storage[i]));
    let entries: Vec<_> = [Bind::Texture(&b.frame.background)]
        .into_iter()
        .chain(reads)
        .chain(tinted.map(Bind::Texture))
        .chain(loads)
        .collect();
    let mut features = plan.resolve_features.to_vec();
    features.extend(tinted.map(|_| "tinted"));
    features.extend(full_sums.then_some("full_sums"));
    let (gpu, extra, output) = (b.gpu, plan.resolve_extra, b.frame.output);
    let pass = FullscreenPass::resolve(gpu, plan.resolve, &features, extra, &entries, output)?;
    Ok(pass)
}

/// Makes a pass ready that shows the sums instead: the first target, and that of the pixel's ends where they stand apart.
fn build_sums(
    b: &Build<'_>,
    plan: &Plan<'_>,
    targets: &[(wgpu::TextureView, Blend)],
) -> Result<FullscreenPass, RenderError> {
    let ends = plan.targets.iter().position(|t| t.label == ENDS);
    let mut entries = vec![Bind::Texture(&targets[0].0)];
    entries.extend(ends.map(|i| Bind::Texture(&targets[i].0)));
    let features: &[&str] = if ends.is_some() {
        &["separate_ends"]
    } else {
        &[]
    };
    let (gpu, output) = (b.gpu, b.frame.output);
    let pass = FullscreenPass::resolve(
        gpu,
        "methods::sums::resolve",
        features,
        &[],
        &entries,
        output,
    )?;
    Ok(pass)
}

/// Makes one geometry pass ready. `tinted` is the target that it also writes where transmission is coloured.
fn build_pass(
    b: &Build<'_>,
    gather: &Gather<'_>,
    targets: &[(wgpu::TextureView, Blend)],
    storage: &[wgpu::Buffer],
    states: &[wgpu::ColorTargetState],
    tinted: Option<usize>,
) -> Result<BuiltPass, RenderError> {
    let mut features = gather.features.to_vec();
    features.extend(tinted.map(|_| "tinted"));
    let writes: Vec<_> = gather.writes.iter().copied().chain(tinted).collect();
    let textures = gather.reads.iter().map(|&i| Bind::Texture(&targets[i].0));
    let entries: Vec<_> = textures
        .chain(gather.loads.iter().map(|&i| Bind::Read(&storage[i])))
        .chain(gather.stores.iter().map(|&i| Bind::Write(&storage[i])))
        .collect();
    let group = (!entries.is_empty()).then(|| {
        b.gpu
            .bind(gather.label, wgpu::ShaderStages::FRAGMENT, &entries)
    });
    let mut written: Vec<_> = writes.iter().map(|&i| Some(states[i].clone())).collect();
    if written.is_empty() {
        written.push(unwritten());
    }
    let pass = GeometryPass {
        label: gather.label,
        shader: gather.shader,
        features: &features,
        extra: gather.extra,
        group: group.as_ref(),
        targets: &written,
        ..GeometryPass::NONE
    };
    let drawn = if gather.boxes {
        Drawn::Boxes(BoxPass::new(b.gpu, b.scene, b.frame, &pass)?)
    } else {
        let pipelines = b
            .scene
            .pipelines(b.gpu, b.frame, Surfaces::Transparent, &pass);
        Drawn::Surfaces(pipelines?)
    };
    Ok(BuiltPass {
        label: gather.label,
        drawn,
        group,
        writes,
    })
}

impl BuiltPass {
    const fn draws_surfaces(&self) -> bool {
        matches!(self.drawn, Drawn::Surfaces(_))
    }
}

impl Compositor for Commutative {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(sorted) = &mut self.sorted {
            sorted.sort(cx.recorder, cx.scene, cx.camera);
        }
        for buffer in &self.storage {
            cx.recorder.encoder().clear_buffer(buffer, 0, None);
        }
        for (number, p) in self.passes.iter().enumerate() {
            let mut colors: Vec<_> = p
                .writes
                .iter()
                .map(|&i| {
                    let (view, blend) = &self.targets[i];
                    clear_color(view, blend.start())
                })
                .collect();
            if let (true, Some(view)) = (colors.is_empty(), &self.attachment) {
                colors.push(unwritten_attachment(view));
            }
            if let Drawn::Boxes(boxes) = &p.drawn {
                boxes.update(cx.recorder, cx.scene);
            }
            let mut pass = cx.recorder.render(p.label, &colors, None);
            if let Some(group) = &p.group {
                pass.set_bind_group(1, &group.group, &[]);
            }
            match (&p.drawn, &self.sorted) {
                (Drawn::Boxes(boxes), _) => boxes.draw(&mut pass, cx.frame),
                (Drawn::Surfaces(of_pass), Some(sorted)) => {
                    sorted.draw(&mut pass, cx.scene, cx.frame, of_pass);
                }
                (Drawn::Surfaces(of_pass), None) => {
                    let half = Surfaces::Transparent;
                    cx.scene.draw(&mut pass, cx.frame, half, of_pass);
                }
            }
            drop(pass);
            if let Some(kernel) = self.kernel.as_ref().filter(|k| k.after == number) {
                let mut pass = cx.recorder.compute(&kernel.label);
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, &kernel.group.group, &[]);
                pass.dispatch_workgroups(kernel.groups[0], kernel.groups[1], 1);
            }
        }
        cx.resolve(&self.resolve);
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: self.passes.iter().filter(|p| p.draws_surfaces()).count() as u32,
            fullscreen_passes: 1 + u32::from(self.kernel.is_some()),
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
