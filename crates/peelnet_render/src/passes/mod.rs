//! Methods with a fixed list of passes: geometry passes into blended targets and storage of so many values a pixel, then one resolve.
//!
//! A method states its targets, its storage and its passes by name; what is allocated, bound, drawn and reported follows from that alone.
//! A resource has the name of the variable by which shaders read or write it, so that nobody counts bindings.
//! All but the painter's methods give the same image whatever the order of drawing.

pub(crate) mod compositor;
pub(crate) mod low_resolution;
pub(crate) mod peeling;
mod planned;
pub mod views;

use crate::RenderError;
use crate::geometry::{
    Blend, BoxPass, GeometryPass, Needs, Order, Sorted,
    frame::{depth_state, unwritten_texture},
    fullscreen::{FullscreenPass, Onto},
};
use crate::gpu::{Gpu, Kernel, bind::Bind, wgpu};
use crate::methods::{MethodSpec, Precision};
use compositor::{Build, Compositor};
use peelnet_model::{Recipe, inputs::Surroundings};
use planned::{History, Planned, PlannedPass, Work};
use views::Shows;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// The variable of the shaders that read it.
    pub name: &'static str,
    /// 1, 2 or 4.
    pub channels: u32,
    /// Whether it has 32 bits a channel unless `targets` says otherwise.
    pub full: bool,
    pub blend: Blend,
    /// Pixels of the frame from one of its pixels to the next, both ways: of the frame's it holds the middle ones.
    pub every: u32,
}

/// `Σ C w` and `Σ α w`.
pub(crate) const SUMS: Target = Target::half("sums", 4, Blend::Add);

/// `T_∞`.
pub(crate) const TRANSMITTANCE: Target = Target::half("transmittances", 1, Blend::Transmit);

/// `T_∞` of red, green and blue.
pub(crate) const TINTED: Target = Target::half("tinted", 4, Blend::Transmit);

/// The sums of a pixel's nearest and farthest fragment, where they stand apart from the others'.
pub(crate) const ENDS: Target = Target::half("ends", 4, Blend::Add);

impl Target {
    /// Of 16 bits a channel by default, or of 8 where it blends bytes.
    pub const fn half(name: &'static str, channels: u32, blend: Blend) -> Self {
        Self {
            name,
            channels,
            full: false,
            blend,
            every: 1,
        }
    }

    /// Of 32 bits a channel by default.
    pub const fn full(name: &'static str, channels: u32, blend: Blend) -> Self {
        Self {
            full: true,
            ..Self::half(name, channels, blend)
        }
    }

    /// As an exported text's description has it.
    pub fn described(target: &peelnet_model::inputs::Target) -> Self {
        use peelnet_model::inputs::Blend as B;
        let (channels, kind) = match target.format.split_once(|c: char| c.is_ascii_digit()) {
            Some(("r", kind)) => (1, kind),
            Some(("rg", kind)) => (2, kind),
            other => (4, other.map_or("", |(_, kind)| kind)),
        };
        let blend = match (target.color, target.alpha, kind.ends_with("unorm")) {
            (B::Add, B::Add, true) => Blend::AddBytes,
            (B::Max, _, true) => Blend::MaxBytes,
            (B::Add, B::Max, _) => Blend::AddMax,
            (B::Max, B::Add, _) => Blend::MaxAdd,
            (B::Add, ..) => Blend::Add,
            (B::Max, ..) => Blend::Max,
            (B::Transmit, ..) => Blend::Transmit,
        };
        Self::half(target.name, channels, blend)
    }

    /// Of one pixel in so many, both ways.
    pub const fn every(self, every: u32) -> Self {
        Self { every, ..self }
    }

    pub const fn format(&self) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as F;
        match (self.blend, self.channels, self.full) {
            (Blend::MaxBytes | Blend::AddBytes, 1, _) => F::R8Unorm,
            (Blend::MaxBytes | Blend::AddBytes, 2, _) => F::Rg8Unorm,
            (Blend::MaxBytes | Blend::AddBytes, _, _) => F::Rgba8Unorm,
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

/// What passes read and write.
#[derive(Clone, Debug)]
enum Resource {
    Target(Target),
    /// The texture of a target that is read no more, for another of its format.
    Again(Handle, Target),
    /// Depth that passes over surfaces compare with.
    Depth,
    /// Bytes of each pixel, and of the frame besides; whether they are zero at the start of every frame.
    Storage {
        name: &'static str,
        pixel: u32,
        frame: u64,
        cleared: bool,
    },
    /// What something else allocates.
    Given(&'static str, Allocated),
}

/// A resource of [`Passes`].
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

/// One pass: its shader, what it reads and what it writes, targets in the order of the shader's locations. A compute shader may read the
/// frame's size as `frame`, a pass over pixels `C_0` as `background`, what reads small targets a sampler as `bilinear`.
#[derive(Debug)]
pub(crate) struct Pass {
    shader: String,
    label: String,
    draws: Draws,
    needs: Needs,
    features: Vec<&'static str>,
    parameters: Option<String>,
    reads: Vec<Handle>,
    writes: Vec<Handle>,
    depth: Option<Handle>,
    /// As [`Target::every`], of what it draws.
    every: u32,
    /// Draws it in the first frame and where the camera jumped only: what it writes stays for the frames that follow.
    pub after_cuts: bool,
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

    /// Draws one pixel in so many, both ways: the middle ones.
    pub fn every(&mut self, every: u32) -> &mut Self {
        self.every = every;
        self.features(["tiles"])
    }

    pub fn reads(&mut self, all: impl IntoIterator<Item = Handle>) -> &mut Self {
        self.reads.extend(all);
        self
    }

    pub fn writes(&mut self, all: impl IntoIterator<Item = Handle>) -> &mut Self {
        self.writes.extend(all);
        self
    }

    /// A depth that a pass over pixels writes, and before which the surfaces of others must lie: the rest is never shaded.
    pub fn depth(&mut self, depth: Option<Handle>) -> &mut Self {
        self.depth = depth;
        self
    }

    /// How it uses its depth: over pixels it is written, surfaces are compared with it.
    fn depth_state(&self, view: &wgpu::TextureView) -> wgpu::DepthStencilState {
        let writes = self.draws == Draws::Pixels;
        wgpu::DepthStencilState {
            depth_write_enabled: Some(writes),
            depth_compare: Some(match writes {
                true => wgpu::CompareFunction::Always,
                // Far away all window depths are 1, and nothing lies behind.
                false => wgpu::CompareFunction::LessEqual,
            }),
            ..depth_state(view.texture().format())
        }
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

/// What a method's passes depend on besides its name and parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions<'a> {
    pub spec: &'a MethodSpec,
    /// Of the network of a learned method.
    pub recipe: Option<Recipe>,
    /// Pixels of the frame.
    pub size: [u32; 2],
    /// Whether all colours of the scene are grey.
    pub grey: bool,
    /// Whether light takes a colour where it passes through a surface.
    pub tinted: bool,
    /// Whether it draws over a caller's target.
    pub over: bool,
}

/// What a method allocates, and its passes in their order; the last is the resolve. Nothing is allocated before [`Passes::build`].
#[derive(Debug)]
pub(crate) struct Passes<'a> {
    pub on: Conditions<'a>,
    resources: Vec<Resource>,
    passes: Vec<Pass>,
    /// The text of the module `parameters` of all passes.
    pub parameters: String,
    /// The exported text of a learned method's network.
    pub network: String,
    pub order: Order,
}

impl<'a> Passes<'a> {
    pub const fn new(on: Conditions<'a>) -> Self {
        Self {
            on,
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

    /// A resource that something else allocates.
    pub fn given(&mut self, name: &'static str, given: Allocated) -> Handle {
        self.resource(Resource::Given(name, given))
    }

    /// Where the finished picture goes.
    pub fn output(&mut self) -> Handle {
        self.given("output", Allocated::Output)
    }

    /// A target, of 16 or 32 bits as the method's `targets` says.
    pub fn target(&mut self, mut target: Target) -> Handle {
        if let Some(precision) = self.on.spec.targets() {
            target.full = precision == Precision::Full;
        }
        self.resource(Resource::Target(target))
    }

    pub fn targets(&mut self, all: impl IntoIterator<Item = Target>) -> Vec<Handle> {
        all.into_iter().map(|target| self.target(target)).collect()
    }

    /// A target in the texture of another, which nothing reads any more once this one is written.
    pub fn again(&mut self, other: Handle, target: Target) -> Handle {
        self.resource(Resource::Again(other, target))
    }

    /// A depth of 32 bits for [`Pass::depth`].
    pub fn depth(&mut self) -> Handle {
        self.resource(Resource::Depth)
    }

    /// Targets as an exported text's description has them.
    pub fn described<'t>(
        &mut self,
        all: impl IntoIterator<Item = &'t peelnet_model::inputs::Target>,
    ) -> Vec<Handle> {
        self.targets(all.into_iter().map(Target::described))
    }

    /// What surrounds a network, with the middle of what it may answer in its place.
    pub fn without_network(&mut self, surroundings: &Surroundings) {
        self.network = format!(
            "// The answer without a network.\nfn peelnet_network({}) -> f32 {{\n    return 0.5;\n}}\n",
            surroundings.parameters
        );
        for module in surroundings.modules {
            let text = crate::shaders::source(module);
            self.network
                .push_str(text.expect("modules of the repository"));
        }
    }

    /// A buffer, zero at the start of every frame: so many bytes of each pixel, and of the frame besides.
    pub fn storage(&mut self, name: &'static str, pixel: u32, frame: u64) -> Handle {
        self.resource(Resource::Storage {
            name,
            pixel,
            frame,
            cleared: true,
        })
    }

    /// A buffer of so many bytes that is not cleared.
    pub fn uncleared(&mut self, name: &'static str, frame: u64) -> Handle {
        self.resource(Resource::Storage {
            name,
            pixel: 0,
            frame,
            cleared: false,
        })
    }

    fn pass(&mut self, shader: &str, draws: Draws, needs: Needs) -> &mut Pass {
        self.passes.push(Pass {
            shader: shader.into(),
            label: shader.into(),
            draws,
            needs,
            features: Vec::new(),
            parameters: None,
            reads: Vec::new(),
            writes: Vec::new(),
            depth: None,
            every: 1,
            after_cuts: false,
        });
        let place = self.passes.len() - 1;
        &mut self.passes[place]
    }

    /// A pass over the transparent surfaces, of which it reads what it `needs`. Times are listed under the last part of the shader's name.
    pub fn geometry(&mut self, shader: &str, needs: Needs) -> &mut Pass {
        let label = shader.rsplit("::").next().unwrap_or(shader);
        self.pass(shader, Draws::Surfaces, needs).label(label)
    }

    pub fn compute(&mut self, shader: &str, threads: u64) -> &mut Pass {
        self.pass(shader, Draws::Threads(threads), Needs::DEPTH)
    }

    /// A pass over every pixel of what it writes.
    pub fn pixels(&mut self, shader: &str) -> &mut Pass {
        self.pass(shader, Draws::Pixels, Needs::DEPTH)
    }

    /// The pass that writes finished pixels: the last.
    pub fn resolve(&mut self, shader: &str, reads: impl IntoIterator<Item = Handle>) -> &mut Pass {
        let output = self.output();
        self.pixels(shader).reads(reads).writes([output])
    }

    /// Where light takes a colour, the pass before the resolve also writes what fragments cover of each channel into one more target, and
    /// the resolve reads that.
    pub fn tint(&mut self) {
        if !self.on.tinted {
            return;
        }
        let tint = self.target(TINTED);
        if let [.., gather, resolve] = self.passes.as_mut_slice() {
            gather.features(["tinted"]).writes([tint]);
            resolve.features(["tinted"]).reads([tint]);
        }
    }

    fn find(&self, name: &str) -> Option<(Handle, &Target)> {
        let all = self.resources.iter().enumerate();
        let mut targets = all.filter_map(|(k, resource)| match resource {
            Resource::Target(target) | Resource::Again(_, target) => Some((Handle(k), target)),
            _ => None,
        });
        targets.find(|(_, target)| target.name == name)
    }

    /// Shows the sums instead of what is made of them, and with them those of the pixel's ends where they stand apart.
    fn show_sums(&mut self) {
        let Some((sums, _)) = self.find(SUMS.name) else {
            return;
        };
        let ends = self.find(ENDS.name).map(|(ends, _)| ends);
        let is_resolve = |last: &mut Pass| last.draws == Draws::Pixels;
        if self.passes.pop_if(is_resolve).is_some() {
            self.resolve("passes::sums::resolve", [sums])
                .reads(ends)
                .features(ends.map(|_| "separate_ends"));
        }
    }

    /// The features of a pass's shader, but for those of materials.
    fn features(&self, pass: &Pass) -> Vec<&'static str> {
        let sums = self.find(SUMS.name);
        let is_full = pass.draws == Draws::Pixels && sums.is_some_and(|(_, target)| target.full);
        let full = is_full.then_some("full_sums");
        pass.features.iter().copied().chain(full).collect()
    }

    /// The modules that a pass's shader is linked with besides those of the repository.
    fn modules<'p>(&'p self, pass: &'p Pass) -> Vec<(&'p str, &'p str)> {
        let parameters = pass.parameters.as_ref().unwrap_or(&self.parameters);
        let modules = [
            ("parameters", parameters.as_str()),
            ("learned::weight", self.network.as_str()),
        ];
        modules.into_iter().filter(|m| !m.1.is_empty()).collect()
    }

    /// Bytes of a sample that a pass writes, as WebGPU counts them.
    fn sample_bytes(&self, pass: &Pass) -> u32 {
        let written = pass.writes.iter().map(|w| &self.resources[w.0]);
        let bytes = written.filter_map(|resource| match resource {
            Resource::Target(target) | Resource::Again(_, target) => {
                target.format().target_pixel_byte_cost()
            }
            _ => None,
        });
        bytes.sum()
    }

    /// Checks that the adapter writes as much of a sample at once as a pass does.
    fn check_sample(&self, gpu: &Gpu, pass: &Pass, spec: &MethodSpec) -> Result<(), RenderError> {
        gpu.check_limit(
            format!("{spec}: pass {}", pass.label),
            u64::from(self.sample_bytes(pass)),
            u64::from(gpu.limits.max_color_attachment_bytes_per_sample),
            "bytes a sample",
            "choose a method that keeps less of a pixel",
        )?;
        Ok(())
    }

    /// Allocates what the passes need and makes their pipelines.
    ///
    /// # Errors
    /// A target that this GPU cannot blend, what does not fit its memory, or a shader that lacks a name.
    pub fn build(mut self, b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
        if b.options.shows == Shows::Sums {
            self.show_sums();
        }
        let mut sizes = Sizes::default();
        let mut resources: Vec<Allocated> = Vec::with_capacity(self.resources.len());
        for resource in &self.resources {
            resources.push(resource.allocate(b, &mut sizes, &resources)?);
        }
        let passes = self.passes.iter();
        let passes: Vec<PlannedPass> = passes
            .map(|pass| self.build_pass(b, pass, &resources))
            .collect::<Result<_, _>>()?;
        let is_bare = |p: &PlannedPass| p.colors.is_empty() && matches!(p.work, Work::Surfaces(_));
        let attachment = match passes.iter().any(is_bare) {
            true => Some(unwritten_texture(&b.scene.gpu, b.frame)?),
            false => None,
        };
        let pixel_bytes = sizes.pixel + u32::from(attachment.is_some());
        let sorted = Sorted::new(b.scene, self.order)?;
        let frame_bytes = sizes.frame + sorted.as_ref().map_or(0, Sorted::bytes);
        Ok(Box::new(Planned {
            passes,
            history: History::default(),
            cleared: sizes.cleared,
            attachment,
            sorted,
            bytes_per_pixel: f64::from(pixel_bytes)
                + frame_bytes as f64 / f64::from(b.frame.pixels()),
        }))
    }

    fn build_pass(
        &self,
        b: &Build<'_>,
        pass: &Pass,
        resources: &[Allocated],
    ) -> Result<PlannedPass, RenderError> {
        let (gpu, output) = (&b.scene.gpu, b.frame.output);
        let (shader, features) = (pass.shader.as_str(), self.features(pass));
        let modules = self.modules(pass);
        let size = matches!(pass.draws, Draws::Threads(_)).then(|| {
            let [width, height] = b.frame.size;
            let usage = wgpu::BufferUsages::UNIFORM;
            gpu.upload("frame size", &[width, height, 0, 0], usage)
        });
        let sampler = pass
            .reads
            .iter()
            .any(|read| self.resources[read.0].is_small());
        let sampler = sampler.then(|| bilinear(gpu));
        let mut entries: Vec<(&str, Bind<'_>)> = match pass.draws {
            Draws::Pixels => vec![
                ("background", Bind::Texture(&b.frame.background)),
                ("camera", Bind::Uniform(&b.scene.camera)),
            ],
            Draws::Threads(_) | Draws::Surfaces | Draws::Boxes => Vec::new(),
        };
        entries.extend(size.iter().map(|size| ("frame", Bind::Uniform(size))));
        entries.extend(sampler.iter().map(|s| ("bilinear", Bind::Sampler(s))));
        for read in &pass.reads {
            let resource = &self.resources[read.0];
            let name = resource.name();
            entries.extend(match &resources[read.0] {
                Allocated::Texture(view) if resource.is_small() => Some((name, Bind::Image(view))),
                Allocated::Texture(view) => Some((name, Bind::Texture(view))),
                Allocated::Storage(buffer) => Some((name, Bind::Read(buffer))),
                Allocated::Uniform(buffer) => Some((name, Bind::Uniform(buffer))),
                Allocated::Output => None,
            });
        }
        let (mut colors, mut states, mut samples) = (Vec::new(), Vec::new(), 1);
        for written in &pass.writes {
            let resource = &self.resources[written.0];
            match (resource, &resources[written.0]) {
                (
                    Resource::Target(target) | Resource::Again(_, target),
                    Allocated::Texture(view),
                ) => {
                    colors.push(Some((view.clone(), target.blend.start())));
                    states.push(Some(target.state()));
                }
                (_, Allocated::Output) => {
                    colors.push(None);
                    states.push(Some(output.state()));
                    samples = output.samples();
                }
                (_, Allocated::Storage(buffer)) => {
                    entries.push((resource.name(), Bind::Write(buffer)));
                }
                _ => {}
            }
        }
        self.check_sample(gpu, pass, b.spec)?;
        let depth = pass.depth.and_then(|depth| resources[depth.0].texture());
        let state = depth.as_ref().map(|view| pass.depth_state(view));
        let work = match pass.draws {
            Draws::Threads(threads) => {
                let kernel = Kernel::link(gpu, shader, &features, &modules, &entries)?;
                Work::Threads(kernel, u32::try_from(threads).unwrap_or(u32::MAX))
            }
            Draws::Pixels => {
                let onto = Onto {
                    samples,
                    depth: state,
                };
                let pass =
                    FullscreenPass::new(gpu, shader, &features, &modules, &entries, &states, onto);
                Work::Pixels(pass?)
            }
            Draws::Surfaces | Draws::Boxes => {
                let geometry = GeometryPass {
                    label: &pass.label,
                    shader,
                    needs: pass.needs,
                    features: &features,
                    extra: &modules,
                    entries: &entries,
                    targets: &states,
                    depth: state,
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
            depth,
            every: pass.every,
            after_cuts: pass.after_cuts,
            work,
        })
    }
}

/// What small targets are read through.
fn bilinear(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("bilinear"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// A resource of a frame.
#[derive(Clone, Debug)]
pub(crate) enum Allocated {
    Texture(wgpu::TextureView),
    Storage(wgpu::Buffer),
    Uniform(wgpu::Buffer),
    /// Where the finished picture goes, blended as that is; there is no resolve then.
    Output,
}

impl Allocated {
    fn texture(&self) -> Option<wgpu::TextureView> {
        match self {
            Self::Texture(view) => Some(view.clone()),
            _ => None,
        }
    }
}

/// Bytes of a pixel, bytes of the frame besides, and storage to be cleared.
#[derive(Debug, Default)]
struct Sizes {
    pixel: u32,
    frame: u64,
    cleared: Vec<wgpu::Buffer>,
}

impl Resource {
    const fn name(&self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Target(Target { name, .. })
            | Self::Again(_, Target { name, .. })
            | Self::Storage { name, .. }
            | Self::Given(name, _) => name,
        }
    }

    /// Whether it is a target of fewer pixels than the frame: read between its texels.
    const fn is_small(&self) -> bool {
        matches!(self, Self::Target(target) if target.every > 1)
    }

    /// Allocates it, behind those `before`.
    fn allocate(
        &self,
        b: &Build<'_>,
        sizes: &mut Sizes,
        before: &[Allocated],
    ) -> Result<Allocated, RenderError> {
        let gpu = &b.scene.gpu;
        Ok(match self {
            Self::Again(other, _) => before[other.0].clone(),
            Self::Target(target) => {
                if target.full {
                    let (feature, hint) = (wgpu::Features::FLOAT32_BLENDABLE, "use targets=f16");
                    gpu.need(feature, &b.spec.to_string(), hint)?;
                }
                let (format, none) = (target.format(), wgpu::TextureUsages::empty());
                let bytes = format.block_copy_size(None).unwrap_or_default();
                let size = b.frame.size.map(|n| n.div_ceil(target.every));
                if target.every == 1 {
                    sizes.pixel += bytes;
                } else {
                    sizes.frame += u64::from(size[0]) * u64::from(size[1]) * u64::from(bytes);
                }
                Allocated::Texture(gpu.texture(target.name, format, size, 1, none)?)
            }
            Self::Depth => {
                let (format, none) = (
                    wgpu::TextureFormat::Depth32Float,
                    wgpu::TextureUsages::empty(),
                );
                sizes.pixel += format.block_copy_size(None).unwrap_or(4);
                Allocated::Texture(gpu.texture("depth", format, b.frame.size, 1, none)?)
            }
            Self::Storage {
                name,
                pixel,
                frame,
                cleared,
            } => {
                let bytes = u64::from(b.frame.pixels()) * u64::from(*pixel) + frame;
                let buffer = gpu.storage(name, bytes)?;
                sizes.pixel += pixel;
                sizes.frame += frame;
                if *cleared {
                    sizes.cleared.push(buffer.clone());
                }
                Allocated::Storage(buffer)
            }
            Self::Given(_, given) => given.clone(),
        })
    }
}

#[cfg(test)]
mod tests;
