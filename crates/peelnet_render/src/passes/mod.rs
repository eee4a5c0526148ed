//! Methods with a fixed list of passes: geometry passes into blended targets and storage of so many values a pixel, then one resolve.
//!
//! A method states its targets, its storage and its passes; what is allocated, bound, drawn and reported follows from that alone.
//! All but the painter's methods give the same image whatever the order of drawing.

pub(crate) mod compositor;
pub(crate) mod low_resolution;
pub(crate) mod peeling;
pub mod views;

use crate::RenderError;
use crate::geometry::{
    Blend, BoxPass, GeometryPass, GeometryPipelines, Order, Sorted,
    count::{unwritten_attachment, unwritten_texture},
    frame::clear_color,
    fullscreen::FullscreenPass,
};
use crate::gpu::{Kernel, bind::Bind, wgpu};
use crate::methods::parameter::Precision;
use compositor::{Build, Compositor, DrawContext, FrameStats, resolve};
use views::Shows;

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
pub(crate) const SUMS: Target = Target::half("sums", 4, Blend::Add);

/// `T_∞`.
pub(crate) const TRANSMITTANCE: Target = Target::half("transmittance", 1, Blend::Transmit);

/// `T_∞` of red, green and blue.
pub(crate) const TINTED: Target = Target::half("tinted transmittance", 4, Blend::Transmit);

/// The sums of a pixel's nearest and farthest fragment, where they stand apart from the others'.
pub(crate) const ENDS: Target = Target::half("ends", 4, Blend::Add);

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

    pub const fn format(&self) -> wgpu::TextureFormat {
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

    pub fn state(&self) -> wgpu::ColorTargetState {
        self.blend.state(self.format())
    }
}

#[derive(Clone, Debug)]
pub(crate) enum Resource {
    Target(Target, wgpu::TextureView),
    Texture(wgpu::TextureView),
    Storage(wgpu::Buffer),
    Uniform(wgpu::Buffer),
    /// Where the finished picture goes, blended as that is; there is no resolve then.
    Output,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Handle(usize);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Draws {
    Surfaces,
    /// Boxes around transparent parts instead of their surfaces.
    Boxes,
    /// Nothing: a compute shader with so many threads, in workgroups of 64.
    Threads(u64),
    /// Finished pixels.
    Pixels,
}

/// One pass: its shader, what it reads and what it writes. Its bindings are what it reads, then the storage that it writes, in bind
/// group 1; behind the frame's size as `vec4u` in group 0 of a compute shader, and behind `C_0` in group 0 of the resolve.
#[derive(Debug)]
pub(crate) struct Pass {
    shader: String,
    label: String,
    draws: Draws,
    features: Vec<&'static str>,
    parameters: Option<String>,
    reads: Vec<Handle>,
    writes: Vec<Handle>,
}

impl Pass {
    /// Times are listed under this label instead of the shader's name.
    pub fn label(&mut self, label: &str) -> &mut Self {
        self.label = label.into();
        self
    }

    /// Draws boxes around transparent parts instead of their surfaces.
    pub fn boxes(&mut self) -> &mut Self {
        self.draws = Draws::Boxes;
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
pub(crate) struct Passes<'b> {
    pub b: &'b Build<'b>,
    resources: Vec<Resource>,
    passes: Vec<Pass>,
    /// Storage, cleared at the start of every frame.
    cleared: Vec<wgpu::Buffer>,
    pixel_bytes: u32,
    pub frame_bytes: u64,
    /// The text of the module `parameters` of all passes.
    pub parameters: String,
    /// The exported text of a learned method's network.
    pub network: String,
    pub order: Order,
}

impl<'b> Passes<'b> {
    pub const fn new(b: &'b Build<'b>) -> Self {
        Self {
            b,
            resources: Vec::new(),
            passes: Vec::new(),
            cleared: Vec::new(),
            pixel_bytes: 0,
            frame_bytes: 0,
            parameters: String::new(),
            network: String::new(),
            order: Order::Scene,
        }
    }

    /// A resource that something else makes.
    pub fn resource(&mut self, resource: Resource) -> Handle {
        self.resources.push(resource);
        Handle(self.resources.len() - 1)
    }

    /// A target, of 16 or 32 bits as the method's `targets` says.
    pub fn target(&mut self, mut target: Target) -> Result<Handle, RenderError> {
        let (gpu, spec) = (&self.b.scene.gpu, self.b.spec);
        if let Some(precision) = spec.targets() {
            target.full = precision == Precision::Full;
        }
        if target.full {
            let (feature, hint) = (wgpu::Features::FLOAT32_BLENDABLE, "use targets=f16");
            gpu.need(feature, &spec.to_string(), hint)?;
        }
        let (format, none) = (target.format(), wgpu::TextureUsages::empty());
        let view = gpu.texture(target.label, format, self.b.frame.size, 1, none)?;
        self.pixel_bytes += format.block_copy_size(None).unwrap_or_default();
        Ok(self.resource(Resource::Target(target, view)))
    }

    pub fn targets(
        &mut self,
        all: impl IntoIterator<Item = Target>,
    ) -> Result<Vec<Handle>, RenderError> {
        all.into_iter().map(|target| self.target(target)).collect()
    }

    /// A buffer, zero at the start of every frame: so many bytes of each pixel, and of the frame besides.
    pub fn storage(&mut self, label: &str, pixel: u32, frame: u64) -> Result<Handle, RenderError> {
        self.pixel_bytes += pixel;
        self.frame_bytes += frame;
        let bytes = u64::from(self.b.frame.pixels()) * u64::from(pixel) + frame;
        let buffer = self.b.scene.gpu.storage(label, bytes)?;
        self.cleared.push(buffer.clone());
        Ok(self.resource(Resource::Storage(buffer)))
    }

    fn pass(&mut self, shader: &str, draws: Draws) -> &mut Pass {
        self.passes.push(Pass {
            shader: shader.into(),
            label: shader.into(),
            draws,
            features: Vec::new(),
            parameters: None,
            reads: Vec::new(),
            writes: Vec::new(),
        });
        let place = self.passes.len() - 1;
        &mut self.passes[place]
    }

    /// A pass over the transparent surfaces. Times are listed under the last part of the shader's name.
    pub fn geometry(&mut self, shader: &str) -> &mut Pass {
        let label = shader.rsplit("::").next().unwrap_or(shader);
        self.pass(shader, Draws::Surfaces).label(label)
    }

    pub fn compute(&mut self, shader: &str, threads: u64) -> &mut Pass {
        self.pass(shader, Draws::Threads(threads))
    }

    /// The pass that writes finished pixels: the last.
    pub fn resolve(&mut self, shader: &str, reads: impl IntoIterator<Item = Handle>) -> &mut Pass {
        self.pass(shader, Draws::Pixels).reads(reads)
    }

    /// Where light takes a colour, the pass before the resolve also writes what fragments cover of each channel into one more target, and
    /// the resolve reads that.
    pub fn tint(&mut self) -> Result<(), RenderError> {
        if !self.b.scene.tinted {
            return Ok(());
        }
        let tint = self.target(TINTED)?;
        if let [.., gather, resolve] = self.passes.as_mut_slice() {
            gather.features(["tinted"]).writes([tint]);
            resolve.features(["tinted"]).reads([tint]);
        }
        Ok(())
    }

    fn find(&self, is: impl Fn(&Target) -> bool) -> Option<Handle> {
        let mut all = self.resources.iter();
        let found = all.position(|r| matches!(r, Resource::Target(target, _) if is(target)));
        found.map(Handle)
    }

    /// Shows the sums instead of what is made of them: the first target, and that of the pixel's ends where they stand apart.
    fn show_sums(&mut self) {
        let Some(sums) = self.find(|_| true) else {
            return;
        };
        let ends = self.find(|target| target.label == ENDS.label);
        let is_resolve = |last: &mut Pass| last.draws == Draws::Pixels;
        if self.passes.pop_if(is_resolve).is_some() {
            self.resolve("passes::sums::resolve", [sums])
                .reads(ends)
                .features(ends.map(|_| "separate_ends"));
        }
    }

    pub fn build(mut self) -> Result<Box<dyn Compositor>, RenderError> {
        let b = self.b;
        if b.options.shows == Shows::Sums {
            self.show_sums();
        }
        let passes = self.passes.iter().map(|pass| self.build_pass(pass));
        let passes: Vec<PlannedPass> = passes.collect::<Result<_, _>>()?;
        let is_bare = |p: &PlannedPass| p.colors.is_empty() && matches!(p.work, Work::Surfaces(_));
        let attachment = match passes.iter().any(is_bare) {
            true => Some(unwritten_texture(&b.scene.gpu, b.frame)?),
            false => None,
        };
        let pixel_bytes = self.pixel_bytes + u32::from(attachment.is_some());
        let sorted = Sorted::new(b.scene, self.order)?;
        let frame_bytes = self.frame_bytes + sorted.as_ref().map_or(0, Sorted::bytes);
        Ok(Box::new(Planned {
            passes,
            cleared: self.cleared,
            attachment,
            sorted,
            bytes_per_pixel: f64::from(pixel_bytes)
                + frame_bytes as f64 / f64::from(b.frame.pixels()),
        }))
    }

    fn build_pass(&self, pass: &Pass) -> Result<PlannedPass, RenderError> {
        let (b, gpu, output) = (self.b, &self.b.scene.gpu, self.b.frame.output);
        let (shader, mut features) = (pass.shader.as_str(), pass.features.clone());
        let parameters = pass.parameters.as_ref().unwrap_or(&self.parameters);
        let modules = [
            ("parameters", parameters.as_str()),
            ("learned::weight", &self.network),
        ];
        let modules: Vec<_> = modules.into_iter().filter(|m| !m.1.is_empty()).collect();
        let [width, height] = b.frame.size;
        let size = [width, height, 0, 0];
        let size = gpu.upload("frame size", &size, wgpu::BufferUsages::UNIFORM);
        let mut entries = match pass.draws {
            Draws::Threads(_) => vec![Bind::Uniform(&size)],
            Draws::Pixels => vec![Bind::Texture(&b.frame.background)],
            Draws::Surfaces | Draws::Boxes => Vec::new(),
        };
        entries.extend(
            pass.reads
                .iter()
                .filter_map(|h| match &self.resources[h.0] {
                    Resource::Target(_, view) | Resource::Texture(view) => {
                        Some(Bind::Texture(view))
                    }
                    Resource::Storage(buffer) => Some(Bind::Read(buffer)),
                    Resource::Uniform(buffer) => Some(Bind::Uniform(buffer)),
                    Resource::Output => None,
                }),
        );
        let (mut colors, mut states, mut samples) = (Vec::new(), Vec::new(), 1);
        for written in &pass.writes {
            match &self.resources[written.0] {
                Resource::Target(target, view) => {
                    colors.push(Some((view.clone(), target.blend.start())));
                    states.push(Some(target.state()));
                }
                Resource::Output => {
                    colors.push(None);
                    states.push(Some(output.state()));
                    samples = output.samples();
                }
                Resource::Storage(buffer) => entries.push(Bind::Write(buffer)),
                Resource::Texture(_) | Resource::Uniform(_) => {}
            }
        }
        let work = match pass.draws {
            Draws::Threads(threads) => {
                let wgsl = crate::shaders::link(shader, &features, &modules)?;
                let threads = u32::try_from(threads).unwrap_or(u32::MAX);
                Work::Threads(Kernel::new(gpu, shader, &wgsl, &entries), threads)
            }
            Draws::Pixels => {
                let is_full = |target: &Target| target.label == SUMS.label && target.full;
                features.extend(self.find(is_full).map(|_| "full_sums"));
                let pass = resolve(gpu, b.frame, shader, &features, &modules, &entries);
                Work::Pixels(pass?)
            }
            Draws::Surfaces | Draws::Boxes => {
                let geometry = GeometryPass {
                    label: &pass.label,
                    shader,
                    features: &features,
                    extra: &modules,
                    entries: &entries,
                    targets: &states,
                    samples,
                    ..GeometryPass::NONE
                };
                if pass.draws == Draws::Boxes {
                    Work::Boxes(BoxPass::new(b.scene, b.frame, &geometry)?)
                } else {
                    Work::Surfaces(b.scene.pipelines(b.frame, &geometry)?)
                }
            }
        };
        Ok(PlannedPass {
            label: pass.label.clone(),
            colors,
            work,
        })
    }
}

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
    label: String,
    /// What it writes with what that is cleared to; `None` for the output.
    colors: Vec<Option<(wgpu::TextureView, [f64; 4])>>,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Surfaces(GeometryPipelines),
    Boxes(BoxPass),
    Threads(Kernel, u32),
    Pixels(FullscreenPass),
}

impl Planned {
    fn count(&self, counts: impl Fn(&Work) -> bool) -> u32 {
        self.passes.iter().filter(|p| counts(&p.work)).count() as u32
    }

    fn draw_geometry(&self, cx: &mut DrawContext<'_, '_>, p: &PlannedPass) {
        let colors = p.colors.iter().map(|color| match color {
            Some((view, start)) => clear_color(view, *start),
            None => cx.output(),
        });
        let mut colors: Vec<_> = colors.collect();
        if colors.is_empty() {
            colors.extend(self.attachment.as_ref().map(unwritten_attachment));
        }
        if let Work::Boxes(boxes) = &p.work {
            boxes.update(cx.recorder, cx.scene);
        }
        let mut pass = cx.recorder.render(&p.label, &colors, None);
        match (&p.work, &self.sorted) {
            (Work::Boxes(boxes), _) => boxes.draw(&mut pass, cx.frame),
            (Work::Surfaces(pipelines), Some(sorted)) => {
                sorted.draw(&mut pass, cx.scene, cx.frame, pipelines);
            }
            (Work::Surfaces(pipelines), None) => {
                cx.scene.draw(&mut pass, cx.frame, pipelines);
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
            match &p.work {
                Work::Pixels(resolve) => cx.resolve(resolve),
                Work::Threads(kernel, threads) => kernel.dispatch(cx.recorder, *threads),
                Work::Surfaces(_) | Work::Boxes(_) => self.draw_geometry(cx, p),
            }
        }
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: self.count(|w| matches!(w, Work::Surfaces(_))),
            fullscreen_passes: self.count(|w| matches!(w, Work::Threads(..) | Work::Pixels(_))),
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
