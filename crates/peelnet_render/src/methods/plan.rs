//! Methods with a fixed list of passes: geometry passes into blended targets and storage of so many values a pixel, then one resolve.
//!
//! A method states its targets, its storage and its passes; what is allocated, bound, drawn and reported follows from that alone.
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
    fn start(self) -> [f64; 4] {
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
        let max = component(F::One, F::One, O::Max);
        let transmit = component(F::Zero, F::OneMinusSrc, O::Add);
        let transmit_alpha = component(F::Zero, F::OneMinusSrcAlpha, O::Add);
        let over = component(F::One, F::OneMinusSrcAlpha, O::Add);
        let (color, alpha) = match self {
            Self::Add => (add, add),
            Self::Over => (over, transmit_alpha),
            Self::Transmit => (transmit, transmit),
            Self::AddTransmit => (add, transmit_alpha),
            Self::MaxAdd => (max, add),
            Self::Max | Self::MaxBytes => (max, max),
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

/// `Σ C w` and `Σ α w`.
pub(super) const SUMS: Target = Target::half("sums", 4, Blend::Add);

/// `T_∞`.
pub(super) const TRANSMITTANCE: Target = Target::half("transmittance", 1, Blend::Transmit);

/// `T_∞` of red, green and blue.
pub(super) const TINTED: Target = Target::half("tinted transmittance", 4, Blend::Transmit);

/// The sums of a pixel's nearest and farthest fragment, where they stand apart from the others'.
pub(super) const ENDS: Target = Target::half("ends", 4, Blend::Add);

impl Target {
    /// Of 16 bits a channel by default, or of 8 where it blends bytes.
    pub const fn half(label: &'static str, channels: u32, blend: Blend) -> Self {
        Self {
            label,
            channels,
            full: false,
            blend,
        }
    }

    /// Of 32 bits a channel by default.
    pub const fn full(label: &'static str, channels: u32, blend: Blend) -> Self {
        Self {
            full: true,
            ..Self::half(label, channels, blend)
        }
    }

    const fn format(&self) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as F;
        match (self.blend, self.channels, self.full) {
            (Blend::MaxBytes, 1, _) => F::R8Unorm,
            (Blend::MaxBytes, 2, _) => F::Rg8Unorm,
            (Blend::MaxBytes, _, _) => F::Rgba8Unorm,
            (_, 1, false) => F::R16Float,
            (_, 2, false) => F::Rg16Float,
            (_, _, false) => F::Rgba16Float,
            (_, 1, true) => F::R32Float,
            (_, 2, true) => F::Rg32Float,
            (_, _, true) => F::Rgba32Float,
        }
    }

    fn state(&self) -> wgpu::ColorTargetState {
        wgpu::ColorTargetState {
            format: self.format(),
            blend: Some(self.blend.state()),
            write_mask: wgpu::ColorWrites::ALL,
        }
    }

    fn texture(&self, b: &Build<'_>) -> Result<wgpu::TextureView, RenderError> {
        if self.full {
            b.gpu.need(
                wgpu::Features::FLOAT32_BLENDABLE,
                "float32-blendable",
                &b.spec.to_string(),
                "use targets=f16",
            )?;
        }
        let none = wgpu::TextureUsages::empty();
        let texture = b
            .gpu
            .texture(self.label, self.format(), b.frame.size, 1, none);
        Ok(texture?)
    }
}

/// What passes read and write.
#[derive(Clone, Debug)]
enum Resource {
    Target(Target),
    /// A buffer, zero at the start of every frame: bytes of each pixel, and of the frame besides.
    Storage(&'static str, u32, u64),
    /// What something else writes.
    Made(Made),
}

/// A resource made ready.
#[derive(Clone, Debug)]
enum Made {
    Texture(wgpu::TextureView),
    /// A texture of unsigned integers.
    Integers(wgpu::TextureView),
    Storage(wgpu::Buffer),
}

/// A target, storage or texture of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Handle(usize);

/// What a pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Draws {
    Surfaces,
    /// Boxes around transparent parts instead of their surfaces.
    Boxes,
    /// Surfaces onto the output itself, blended as the output is.
    Output,
    /// Nothing: a compute shader with so many threads, in workgroups of 64.
    Threads(u64),
    /// Finished pixels.
    Pixels,
}

/// One pass: its shader, what it reads and what it writes. Its bindings are what it reads, then the storage that it writes, in bind
/// group 1; behind the frame's size as `vec4u` in group 0 of a compute shader, and behind `C_0` in group 0 of the resolve.
#[derive(Debug)]
pub(crate) struct Pass {
    shader: &'static str,
    label: &'static str,
    draws: Draws,
    features: Vec<&'static str>,
    parameters: Option<String>,
    reads: Vec<Handle>,
    writes: Vec<Handle>,
}

impl Pass {
    /// Times are listed under this label instead of the shader's name.
    pub fn label(&mut self, label: &'static str) -> &mut Self {
        self.label = label;
        self
    }

    /// Draws boxes around transparent parts instead of their surfaces.
    pub fn boxes(&mut self) -> &mut Self {
        self.draws = Draws::Boxes;
        self
    }

    /// Blends onto the output itself instead of targets of its own; there is no resolve then.
    pub fn onto_output(&mut self) -> &mut Self {
        self.draws = Draws::Output;
        self
    }

    pub fn reads(&mut self, all: impl IntoIterator<Item = Handle>) -> &mut Self {
        self.reads.extend(all);
        self
    }

    pub fn writes(&mut self, all: impl IntoIterator<Item = Handle>) -> &mut Self {
        self.writes.extend(all);
        self
    }

    /// Compile-time features of the shader.
    pub fn features(&mut self, all: impl IntoIterator<Item = &'static str>) -> &mut Self {
        self.features.extend(all);
        self
    }

    /// The text of the pass's own module `parameters`.
    pub fn parameters(&mut self, text: String) -> &mut Self {
        self.parameters = Some(text);
        self
    }
}

/// What a method allocates, and its passes in their order; the last is the resolve.
#[derive(Debug)]
pub(crate) struct Plan {
    resources: Vec<Resource>,
    passes: Vec<Pass>,
    /// The text of the module `parameters` of all passes.
    pub parameters: String,
    /// The exported text of a learned method's network.
    pub network: String,
    /// In which order surfaces are drawn.
    pub order: Order,
}

impl Plan {
    pub const fn new() -> Self {
        Self {
            resources: Vec::new(),
            passes: Vec::new(),
            parameters: String::new(),
            network: String::new(),
            order: Order::Scene,
        }
    }

    fn resource(&mut self, resource: Resource) -> Handle {
        self.resources.push(resource);
        Handle(self.resources.len() - 1)
    }

    pub fn target(&mut self, target: Target) -> Handle {
        self.resource(Resource::Target(target))
    }

    pub fn targets(&mut self, all: impl IntoIterator<Item = Target>) -> Vec<Handle> {
        all.into_iter().map(|target| self.target(target)).collect()
    }

    /// A buffer of so many bytes a pixel.
    pub fn storage(&mut self, label: &'static str, bytes_per_pixel: u32) -> Handle {
        self.resource(Resource::Storage(label, bytes_per_pixel, 0))
    }

    /// A buffer of so many bytes.
    pub fn storage_of_frame(&mut self, label: &'static str, bytes: u64) -> Handle {
        self.resource(Resource::Storage(label, 0, bytes))
    }

    /// A texture of colours that something else writes.
    pub fn texture(&mut self, view: &wgpu::TextureView) -> Handle {
        self.resource(Resource::Made(Made::Texture(view.clone())))
    }

    /// A texture of unsigned integers that something else writes.
    pub fn integers(&mut self, view: &wgpu::TextureView) -> Handle {
        self.resource(Resource::Made(Made::Integers(view.clone())))
    }

    fn pass(&mut self, shader: &'static str, label: &'static str, draws: Draws) -> &mut Pass {
        let place = self.passes.len();
        self.passes.push(Pass {
            shader,
            label,
            draws,
            features: Vec::new(),
            parameters: None,
            reads: Vec::new(),
            writes: Vec::new(),
        });
        &mut self.passes[place]
    }

    /// A pass over the transparent surfaces. Times are listed under the last part of the shader's name.
    pub fn geometry(&mut self, shader: &'static str) -> &mut Pass {
        let label = shader.rsplit("::").next().unwrap_or(shader);
        self.pass(shader, label, Draws::Surfaces)
    }

    /// A compute shader.
    pub fn compute(&mut self, shader: &'static str, threads: u64) -> &mut Pass {
        self.pass(shader, shader, Draws::Threads(threads))
    }

    /// The pass that writes finished pixels: the last.
    pub fn resolve(
        &mut self,
        shader: &'static str,
        reads: impl IntoIterator<Item = Handle>,
    ) -> &mut Pass {
        self.pass(shader, shader, Draws::Pixels).reads(reads)
    }

    /// Where light takes a colour, the pass before the resolve also writes what fragments cover of each channel into one more target, and
    /// the resolve reads that.
    pub fn tint(&mut self, b: &Build<'_>) {
        if !b.scene.tinted {
            return;
        }
        let tint = self.target(TINTED);
        if let [.., gather, resolve] = self.passes.as_mut_slice() {
            gather.features(["tinted"]).writes([tint]);
            resolve.features(["tinted"]).reads([tint]);
        }
    }

    /// Shows the sums instead: the first target, and that of the pixel's ends where they stand apart.
    fn show_sums(&mut self) {
        let is_ends = |r: &Resource| matches!(r, Resource::Target(t) if t.label == ENDS.label);
        let ends = self.resources.iter().position(is_ends).map(Handle);
        self.passes.pop();
        self.resolve("methods::sums::resolve", [Handle(0)])
            .reads(ends)
            .features(ends.map(|_| "separate_ends"));
    }

    /// Makes the plan ready, with 16- or 32-bit targets as the method's `targets` says.
    pub fn build(mut self, b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
        if b.sums && self.passes.last().is_some_and(|p| p.draws == Draws::Pixels) {
            self.show_sums();
        }
        let pixels = u64::from(b.frame.pixels());
        let (mut pixel_bytes, mut frame_bytes) = (0, 0);
        let (mut made, mut cleared) = (Vec::new(), Vec::new());
        for resource in &mut self.resources {
            made.push(match resource {
                Resource::Target(target) => {
                    if let Some(precision) = b.spec.targets() {
                        target.full = precision == Precision::Full;
                    }
                    pixel_bytes += target.format().block_copy_size(None).unwrap_or_default();
                    Made::Texture(target.texture(b)?)
                }
                Resource::Storage(label, of_pixel, of_frame) => {
                    pixel_bytes += *of_pixel;
                    frame_bytes += *of_frame;
                    let bytes = pixels * u64::from(*of_pixel) + *of_frame;
                    cleared.push(b.gpu.storage(label, bytes)?);
                    Made::Storage(cleared[cleared.len() - 1].clone())
                }
                Resource::Made(made) => made.clone(),
            });
        }
        let passes = self
            .passes
            .iter()
            .map(|pass| self.build_pass(b, pass, &made));
        let passes: Vec<PlannedPass> = passes.collect::<Result<_, _>>()?;
        let is_bare = |p: &PlannedPass| p.targets.is_empty() && matches!(p.work, Work::Surfaces(_));
        let attachment = match passes.iter().any(is_bare) {
            true => Some(unwritten_texture(b.gpu, b.frame)?),
            false => None,
        };
        pixel_bytes += u32::from(attachment.is_some());
        let sorted = Sorted::new(b.gpu, b.scene, self.order)?;
        frame_bytes += sorted.as_ref().map_or(0, Sorted::bytes);
        Ok(Box::new(Planned {
            passes,
            cleared,
            attachment,
            sorted,
            bytes_per_pixel: f64::from(pixel_bytes) + frame_bytes as f64 / pixels as f64,
        }))
    }

    /// The targets that a pass writes.
    fn written<'p>(
        &'p self,
        pass: &'p Pass,
        made: &'p [Made],
    ) -> Vec<(&'p Target, &'p wgpu::TextureView)> {
        let of = |h: &Handle| match (&self.resources[h.0], &made[h.0]) {
            (Resource::Target(target), Made::Texture(view)) => Some((target, view)),
            _ => None,
        };
        pass.writes.iter().filter_map(of).collect()
    }

    fn build_pass(
        &self,
        b: &Build<'_>,
        pass: &Pass,
        made: &[Made],
    ) -> Result<PlannedPass, RenderError> {
        let (gpu, shader, mut features) = (b.gpu, pass.shader, pass.features.clone());
        let parameters = pass.parameters.as_ref().unwrap_or(&self.parameters);
        let modules = [
            ("parameters", parameters),
            ("learned::weight", &self.network),
        ];
        let modules: Vec<_> = modules
            .into_iter()
            .filter(|(_, text)| !text.is_empty())
            .map(|(name, text)| (name, text.as_str()))
            .collect();
        let [width, height] = b.frame.size;
        let size = [width, height, 0, 0];
        let size = || gpu.upload("frame size", &size, wgpu::BufferUsages::UNIFORM);
        let size = matches!(pass.draws, Draws::Threads(_)).then(size);
        let mut entries: Vec<_> = size.iter().map(Bind::Uniform).collect();
        if pass.draws == Draws::Pixels && !b.sums {
            entries.push(Bind::Texture(&b.frame.background));
        }
        entries.extend(pass.reads.iter().map(|h| match &made[h.0] {
            Made::Texture(view) => Bind::Texture(view),
            Made::Integers(view) => Bind::Uint(view),
            Made::Storage(buffer) => Bind::Read(buffer),
        }));
        entries.extend(pass.writes.iter().filter_map(|h| match &made[h.0] {
            Made::Storage(buffer) => Some(Bind::Write(buffer)),
            _ => None,
        }));
        let bind = |stages| gpu.bind(pass.label, stages, &entries);
        let (targets, mut group) = (self.written(pass, made), None);
        let work = match pass.draws {
            Draws::Threads(threads) => {
                let bound = group.insert(bind(wgpu::ShaderStages::COMPUTE));
                let wgsl = peelnet_shaders::link(shader, &features, &modules)?;
                let groups = groups_2d(u32::try_from(threads).unwrap_or(u32::MAX));
                Work::Threads(gpu.compute(shader, &wgsl, bound), groups)
            }
            Draws::Pixels => {
                let is_full = |r: &Resource| matches!(r, Resource::Target(t) if t.label == SUMS.label && t.full);
                let has_full_sums = !b.sums && self.resources.iter().any(is_full);
                features.extend(has_full_sums.then_some("full_sums"));
                let output = b.frame.output;
                let resolve =
                    FullscreenPass::resolve(gpu, shader, &features, &modules, &entries, output);
                Work::Pixels(resolve?)
            }
            Draws::Surfaces | Draws::Boxes | Draws::Output => {
                group = (!entries.is_empty()).then(|| bind(wgpu::ShaderStages::FRAGMENT));
                let mut states: Vec<_> = targets.iter().map(|(t, _)| Some(t.state())).collect();
                let output = b.frame.output;
                let samples = match pass.draws {
                    Draws::Output => output.samples(),
                    _ => 1,
                };
                if pass.draws == Draws::Output {
                    states.push(Some(output.state()));
                } else if states.is_empty() {
                    states.push(unwritten());
                }
                let geometry = GeometryPass {
                    label: pass.label,
                    shader,
                    features: &features,
                    extra: &modules,
                    group: group.as_ref(),
                    targets: &states,
                    samples,
                    ..GeometryPass::NONE
                };
                let half = Surfaces::Transparent;
                let surfaces = || b.scene.pipelines(gpu, b.frame, half, &geometry);
                match pass.draws {
                    Draws::Boxes => Work::Boxes(BoxPass::new(gpu, b.scene, b.frame, &geometry)?),
                    Draws::Output => Work::Output(surfaces()?),
                    _ => Work::Surfaces(surfaces()?),
                }
            }
        };
        let starts = targets
            .into_iter()
            .map(|(t, view)| (view.clone(), t.blend.start()));
        Ok(PlannedPass {
            label: pass.label,
            targets: starts.collect(),
            group,
            work,
        })
    }
}

/// A plan made ready.
#[derive(Debug)]
struct Planned {
    passes: Vec<PlannedPass>,
    /// Storage, cleared at the start of every frame.
    cleared: Vec<wgpu::Buffer>,
    /// Of passes that write storage alone.
    attachment: Option<wgpu::TextureView>,
    sorted: Option<Sorted>,
    bytes_per_pixel: f64,
}

#[derive(Debug)]
struct PlannedPass {
    label: &'static str,
    /// With what they are cleared to.
    targets: Vec<(wgpu::TextureView, [f64; 4])>,
    group: Option<Bound>,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Surfaces(GeometryPipelines),
    Output(GeometryPipelines),
    Boxes(BoxPass),
    Threads(wgpu::ComputePipeline, [u32; 2]),
    Pixels(FullscreenPass),
}

impl Planned {
    fn count(&self, counts: impl Fn(&Work) -> bool) -> u32 {
        self.passes.iter().filter(|p| counts(&p.work)).count() as u32
    }

    fn draw_geometry(&self, cx: &mut DrawContext<'_, '_>, p: &PlannedPass) {
        let targets = p.targets.iter();
        let mut colors: Vec<_> = targets.map(|(v, start)| clear_color(v, *start)).collect();
        match &p.work {
            Work::Output(_) => colors.push(cx.output()),
            _ if colors.is_empty() => {
                colors.extend(self.attachment.as_ref().map(unwritten_attachment))
            }
            _ => {}
        }
        if let Work::Boxes(boxes) = &p.work {
            boxes.update(cx.recorder, cx.scene);
        }
        let mut pass = cx.recorder.render(p.label, &colors, None);
        if let Some(group) = &p.group {
            pass.set_bind_group(1, &group.group, &[]);
        }
        match (&p.work, &self.sorted) {
            (Work::Boxes(boxes), _) => boxes.draw(&mut pass, cx.frame),
            (Work::Surfaces(pipelines) | Work::Output(pipelines), Some(sorted)) => {
                sorted.draw(&mut pass, cx.scene, cx.frame, pipelines);
            }
            (Work::Surfaces(pipelines) | Work::Output(pipelines), None) => {
                let half = Surfaces::Transparent;
                cx.scene.draw(&mut pass, cx.frame, half, pipelines);
            }
            (Work::Threads(..) | Work::Pixels(_), _) => {}
        }
    }
}

impl Compositor for Planned {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(sorted) = &mut self.sorted {
            sorted.sort(cx.recorder, cx.scene, cx.camera);
        }
        for buffer in &self.cleared {
            cx.recorder.encoder().clear_buffer(buffer, 0, None);
        }
        for p in &self.passes {
            match (&p.work, &p.group) {
                (Work::Pixels(resolve), _) => cx.resolve(resolve),
                (Work::Threads(pipeline, [x, y]), Some(group)) => {
                    let mut pass = cx.recorder.compute(p.label);
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, &group.group, &[]);
                    pass.dispatch_workgroups(*x, *y, 1);
                }
                _ => self.draw_geometry(cx, p),
            }
        }
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: self.count(|w| matches!(w, Work::Surfaces(_) | Work::Output(_))),
            fullscreen_passes: self.count(|w| matches!(w, Work::Threads(..) | Work::Pixels(_))),
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
