//! [`Renderer`]: a scene on a device, drawn into a caller's target, into an image, or for its time alone.

use crate::{
    error::RenderError,
    frame::{Frame, PROFILED, Profile},
    image::Image,
    kind::Kind,
    methods::{
        compositor::{Compositor, DrawContext, Fit, FrameStats, Learning},
        layers::LayerView,
        spec::MethodSpec,
    },
    samples::{self, Drawn, Mean},
    target::{FrameStatus, LearnedWeight, MethodOptions, Target},
};
use peelnet_core::absorbance::DepthWarp;
use peelnet_gpu::{
    Gpu,
    readback::Download,
    record::{Recorder, Timer},
    wgpu,
};
use peelnet_raster::{
    FrameTargets, GeometryPipelines, PixelSample, SamplePoint, SceneBuffers, Submission,
    frame::Output,
};
use peelnet_scene::{Camera, Light, Material, Scene};
use std::collections::VecDeque;
use web_time::Instant;

/// Times that a frame is drawn until it has room for all of its fragments. Two do for a frame in one tile.
const MOST_TRIES: u32 = 8;

/// Frames whose counts may be on their way at one time.
const FRAMES_IN_FLIGHT: usize = 3;

/// A method made ready for one renderer. It keeps its targets and counts from frame to frame; another size, target format or depth buffer
/// makes targets anew, and takes pipelines from the device's cache.
#[derive(Debug)]
pub struct Prepared {
    kind: Kind,
    options: MethodOptions,
    ready: Option<Ready>,
    /// The target of profiles.
    canvas: Option<wgpu::TextureView>,
    /// The mean of the samples of profiles.
    mean: Option<Mean>,
    /// Counts on their way, with the version of the capacities that their frames had.
    pending: VecDeque<(u64, Vec<Download>)>,
    status: FrameStatus,
}

#[derive(Debug)]
struct Ready {
    generation: u64,
    callers_depth: Option<wgpu::TextureView>,
    frame: FrameTargets,
    opaque: Option<GeometryPipelines>,
    compositor: Box<dyn Compositor>,
}

impl Prepared {
    /// Size of [`Renderer::image`]s from now on, width and height in pixels.
    pub const fn resize(&mut self, size: [u32; 2]) {
        self.options.size = size;
    }

    /// Size of [`Renderer::image`]s.
    pub const fn size(&self) -> [u32; 2] {
        self.options.size
    }

    /// Samples a pixel of [`Renderer::image`]s.
    pub const fn samples(&self) -> u32 {
        self.options.samples
    }

    /// Where the repetitions of a frame sample its pixels.
    fn points(&self) -> Vec<SamplePoint> {
        match self.options.samples {
            4 => SamplePoint::of_four(self.options.size).to_vec(),
            _ => vec![SamplePoint::MIDDLE],
        }
    }
}

/// A scene on a device. Objects, materials and lights change in place, for all frames submitted later.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    scene: SceneBuffers,
}

impl Renderer {
    /// Uploads a scene.
    ///
    /// # Errors
    /// A scene larger than the adapter's largest buffer.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        Ok(Self {
            scene: SceneBuffers::new(gpu, scene)?,
            gpu: gpu.clone(),
        })
    }

    /// The device.
    pub const fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The scene as it stands after all changes.
    pub const fn scene(&self) -> &Scene {
        self.scene.scene()
    }

    /// Names of the bindings of the scene that a transparent pass has.
    pub fn bindings(&self) -> Vec<&'static str> {
        self.scene.bindings()
    }

    /// Names of the attributes of a vertex that the vertex shader reads.
    pub fn vertex_attributes(&self) -> Vec<&'static str> {
        self.scene.vertex_attributes()
    }

    /// Submits transparent surfaces to the GPU in another order from now on.
    pub fn submit(&mut self, order: Submission) {
        self.scene.submit(order);
    }

    /// The warp that methods take a view's depths through.
    pub fn depth_warp(&self, camera: &Camera) -> DepthWarp {
        self.scene.depth_warp(camera)
    }

    /// Moves an object: its vertices are uploaded again, nothing else.
    ///
    /// # Errors
    /// An object that the scene does not have.
    pub fn set_transform(
        &mut self,
        object: usize,
        world_from_object: glam::Mat4,
    ) -> Result<(), RenderError> {
        Ok(self
            .scene
            .set_transform(&self.gpu, object, world_from_object)?)
    }

    /// Gives a part of an object another material. Other values are one small write; a material that needs other shader features or
    /// textures links and compiles what is not in the caches yet.
    ///
    /// # Errors
    /// An object or part that the scene does not have, or a texture beyond the adapter's limits.
    pub fn set_material(
        &mut self,
        object: usize,
        part: usize,
        material: Material,
    ) -> Result<(), RenderError> {
        Ok(self.scene.set_material(&self.gpu, object, part, material)?)
    }

    /// Replaces all lights.
    ///
    /// # Errors
    /// A texture beyond the adapter's limits, of materials that were unlit so far.
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), RenderError> {
        Ok(self.scene.set_lights(&self.gpu, lights)?)
    }

    /// Makes a method ready for images of the size in `options`.
    ///
    /// # Errors
    /// A missing model, a missing feature of the adapter, or a frame beyond its limits.
    pub fn method(
        &self,
        spec: &MethodSpec,
        mut options: MethodOptions,
    ) -> Result<Prepared, RenderError> {
        let shipped = || LearnedWeight::shipped(spec);
        options.learned = options.learned.or_else(shipped);
        self.made(Kind::Method(spec.clone()), options)
    }

    /// Makes the view of layers ready, of a scene that [`Scene::layer_view`] made.
    ///
    /// # Errors
    /// A frame beyond the adapter's limits.
    pub fn layers(&self, view: LayerView, size: [u32; 2]) -> Result<Prepared, RenderError> {
        self.made(Kind::Layers(view), MethodOptions::sized(size))
    }

    /// Makes an image ready that tells, instead of a colour, which transparent surfaces a pixel shows: see [`crate::methods::surfaces`].
    ///
    /// # Errors
    /// A frame beyond the adapter's limits.
    pub fn surfaces(&self, size: [u32; 2], samples: u32) -> Result<Prepared, RenderError> {
        let options = MethodOptions::sized(size).sampled(samples);
        self.made(Kind::Surfaces, options)
    }

    fn made(&self, kind: Kind, options: MethodOptions) -> Result<Prepared, RenderError> {
        if !matches!(options.samples, 1 | 4) {
            return Err(RenderError::Samples(options.samples));
        }
        let mut method = Prepared {
            kind,
            options,
            ready: None,
            canvas: None,
            mean: None,
            pending: VecDeque::new(),
            status: FrameStatus::Unknown,
        };
        let size = method.size();
        self.ready(&mut method, size, Output::Image, None)?;
        self.gpu.check()?;
        Ok(method)
    }

    /// The method's targets and pipelines for a frame, made anew where anything that they depend on changed.
    fn ready<'m>(
        &self,
        method: &'m mut Prepared,
        size: [u32; 2],
        output: Output,
        depth: Option<&wgpu::TextureView>,
    ) -> Result<&'m mut Ready, RenderError> {
        let generation = self.scene.generation();
        let fits = |r: &Ready| {
            (r.generation, r.frame.size, r.frame.output) == (generation, size, output)
                && r.callers_depth.as_ref() == depth
        };
        // Old targets go before new ones come.
        let ready = match method.ready.take().filter(fits) {
            Some(ready) => ready,
            None => {
                method.pending.clear();
                method.status = FrameStatus::Unknown;
                self.make_ready(method, size, output, depth)?
            }
        };
        Ok(method.ready.insert(ready))
    }

    fn make_ready(
        &self,
        method: &Prepared,
        size: [u32; 2],
        output: Output,
        depth: Option<&wgpu::TextureView>,
    ) -> Result<Ready, RenderError> {
        let frame = self.scene.targets(&self.gpu, size, output, depth)?;
        let options = &method.options;
        let compositor = method.kind.build(&self.gpu, &self.scene, &frame, options)?;
        Ok(Ready {
            generation: self.scene.generation(),
            callers_depth: depth.cloned(),
            opaque: self.scene.opaque_pipelines(&self.gpu, &frame)?,
            frame,
            compositor,
        })
    }

    /// Encodes a frame onto a target of the caller's: it does not submit, wait or read back.
    ///
    /// Methods that need counts (S-buffer, linked lists, peeling) have the room that the last frame needed whose counts came back; the status
    /// says whether that frame was whole. A still image is whole in the second frame after the first one's counts came back; a frame of more
    /// fragments than one storage binding holds takes one frame more.
    ///
    /// # Errors
    /// A target that cannot be drawn onto, a lost device, or a frame beyond the adapter's limits.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        method: &mut Prepared,
        camera: &Camera,
        target: &Target<'_>,
    ) -> Result<FrameStatus, RenderError> {
        if method.samples() > 1 {
            return Err(RenderError::Target(
                "the method is ready for images of 4 samples a pixel, which repeat the frame; make it ready with 1 sample".into(),
            ));
        }
        let (size, output) = self.output(target)?;
        self.ready(method, size, output, target.depth)?;
        // Callbacks of finished frames run here where nothing else polls the device.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.learn(method)?;
        let Some(ready) = &mut method.ready else {
            return Ok(FrameStatus::Unknown);
        };
        let mut recorder = Recorder::new(&self.gpu, encoder, None);
        let view = (camera, SamplePoint::MIDDLE);
        self.encode(ready, &mut recorder, view, Some(target), true, false)?;
        let feedback = ready.compositor.feedback();
        if feedback.is_empty() {
            method.status = FrameStatus::Whole;
        } else if method.pending.len() < FRAMES_IN_FLIGHT {
            let downloads = self.downloads(encoder, feedback);
            let version = ready.compositor.version();
            method.pending.push_back((version, downloads));
        }
        Ok(method.status)
    }

    /// How pipelines write to a target.
    fn output(&self, target: &Target<'_>) -> Result<([u32; 2], Output), RenderError> {
        let texture = target.color.texture();
        let size = [texture.width(), texture.height()];
        let format = texture.format();
        // What WebGPU guarantees of the format with the device's features: some adapters would blend more.
        let flags = format
            .guaranteed_format_features(self.gpu.device.features())
            .flags;
        if !self.scene.tinted && !flags.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
            return Err(RenderError::Target(format!(
                "its format {format:?} cannot be blended on this device; use Rgba16Float, Rgba8Unorm or another that can"
            )));
        }
        if let Some(depth) = target.depth {
            let depth = depth.texture();
            if [depth.width(), depth.height()] != size
                || depth.sample_count() != texture.sample_count()
            {
                return Err(RenderError::Target(
                    "its depth has another size or sample count".into(),
                ));
            }
            if !depth.format().is_depth_stencil_format() || depth.format().has_stencil_aspect() {
                return Err(RenderError::Target(format!(
                    "its depth is {:?}; use a format of depth alone",
                    depth.format()
                )));
            }
        }
        // Coloured transmission cannot be blended: the resolve needs what lies behind, and that is ours only after a clear.
        if self.scene.tinted && (!target.clear || target.depth.is_some()) {
            return Err(RenderError::Target(
                "this scene's transmission is coloured, which needs the background: clear the target, and let the scene hold \
                 the opaque surfaces"
                    .into(),
            ));
        }
        Ok((
            size,
            Output::Target {
                format,
                samples: texture.sample_count(),
                over: !self.scene.tinted,
            },
        ))
    }

    /// Takes the counts that came back, and makes room for what they say.
    fn learn(&self, method: &mut Prepared) -> Result<(), RenderError> {
        let Some(ready) = &mut method.ready else {
            return Ok(());
        };
        while let Some((version, downloads)) = method.pending.front() {
            if !downloads.iter().all(Download::is_ready) {
                break;
            }
            // Of a frame with other capacities: it says nothing of those there are now.
            if *version == ready.compositor.version() {
                let words = downloads.iter().map(Download::take);
                let words = words.collect::<Result<Vec<Vec<u32>>, _>>()?;
                let cx = Learning {
                    gpu: &self.gpu,
                    scene: &self.scene,
                    frame: &ready.frame,
                    exact: false,
                };
                let fit = ready
                    .compositor
                    .learn(&cx, &words, &mut FrameStats::default())?;
                method.status = match fit {
                    Fit::TooSmall => FrameStatus::Grown,
                    Fit::Whole | Fit::Loose => FrameStatus::Whole,
                };
            }
            method.pending.pop_front();
        }
        Ok(())
    }

    fn downloads(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        feedback: Vec<(wgpu::Buffer, std::ops::Range<u64>)>,
    ) -> Vec<Download> {
        let all = feedback.into_iter();
        all.map(|(buffer, range)| Download::record(&self.gpu, encoder, &buffer, range))
            .collect()
    }

    /// Records all passes of a frame.
    fn encode(
        &self,
        ready: &mut Ready,
        recorder: &mut Recorder<'_>,
        (camera, point): (&Camera, SamplePoint),
        target: Option<&Target<'_>>,
        counting: bool,
        only_count: bool,
    ) -> Result<FrameStats, RenderError> {
        let frame = &ready.frame;
        self.scene
            .set_view(recorder, camera, frame, PixelSample::ALL, point);
        let color = target.map(|t| t.color);
        self.scene.draw_background(
            recorder,
            frame,
            ready.opaque.as_ref(),
            color,
            target.is_none_or(|t| t.clear),
        );
        ready.compositor.draw(&mut DrawContext {
            recorder,
            scene: &self.scene,
            camera,
            point,
            frame,
            target: color,
            counting,
            only_count,
        })
    }

    /// Draws until the frame has room for all of its fragments (and, for times, no more than it needs): onto a target, or into an image
    /// of its own.
    async fn drawn(
        &self,
        method: &mut Prepared,
        view: (&Camera, SamplePoint),
        counting: bool,
        target: Option<&Target<'_>>,
    ) -> Result<Drawn, RenderError> {
        let (size, output) = match target {
            Some(target) => self.output(target)?,
            None => (method.size(), Output::Image),
        };
        method.pending.clear();
        let ready = self.ready(method, size, output, None)?;
        // Passes of tries that were too small: the frame took them too.
        let mut wasted = 0;
        for _ in 0..MOST_TRIES {
            let only_count = !ready.compositor.is_ready();
            let start = Instant::now();
            let mut encoder = self.gpu.encoder();
            let mut timer = Timer::new(&self.gpu);
            let mut recorder = Recorder::new(&self.gpu, &mut encoder, Some(&mut timer));
            let mut stats =
                self.encode(ready, &mut recorder, view, target, counting, only_count)?;
            let downloads = self.downloads(&mut encoder, ready.compositor.feedback());
            let times = timer.finish(&self.gpu, &mut encoder);
            self.gpu.queue.submit([encoder.finish()]);
            self.gpu.submitted_async().await;
            let times = times.read().await?;
            let mut words: Vec<Vec<u32>> = Vec::with_capacity(downloads.len());
            for download in &downloads {
                download.await;
                words.push(download.take()?);
            }
            self.gpu.check()?;
            let wall_micros = start.elapsed().as_secs_f64() * 1e6;
            let fit = ready.compositor.learn(
                &Learning {
                    gpu: &self.gpu,
                    scene: &self.scene,
                    frame: &ready.frame,
                    exact: true,
                },
                &words,
                &mut stats,
            )?;
            if !only_count && (fit == Fit::Whole || (counting && fit == Fit::Loose)) {
                stats.geometry_passes += wasted;
                return Ok(Drawn {
                    stats,
                    times,
                    wall_micros,
                });
            }
            wasted += stats.geometry_passes;
        }
        Err(RenderError::NeverWhole(MOST_TRIES))
    }

    /// Draws a view, counts what its statistics need, and reads the image back. Of several samples a pixel the frame is drawn once for each,
    /// through another place in every pixel, and the images are averaged: any method can, at so many times the time and no more memory.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub async fn image_async(
        &self,
        method: &mut Prepared,
        camera: &Camera,
    ) -> Result<Frame, RenderError> {
        let [width, height] = method.size();
        let mut pixels: Vec<[f32; 4]> = Vec::new();
        let mut sum = Drawn::default();
        let points = method.points();
        for &point in &points {
            sum.add(self.drawn(method, (camera, point), true, None).await?);
            let view = method.ready.as_ref().and_then(|r| r.frame.image());
            let read = match view {
                Some(view) => self.gpu.read_rgba32f_async(view).await?,
                None => Vec::new(),
            };
            pixels = samples::sum(pixels, read);
        }
        let share = 1.0 / points.len() as f32;
        pixels
            .as_flattened_mut()
            .iter_mut()
            .for_each(|c| *c *= share);
        Ok(Frame {
            image: Image {
                width,
                height,
                pixels,
            },
            times: sum.times,
            stats: sum.stats,
            wall_micros: sum.wall_micros,
        })
    }

    /// The same as [`Self::image_async`], waiting for the device. Not in a browser.
    ///
    /// # Errors
    /// See [`Self::image_async`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn image(&self, method: &mut Prepared, camera: &Camera) -> Result<Frame, RenderError> {
        self.gpu.block_on(self.image_async(method, camera))
    }

    /// Draws a view for its time alone, as an engine would: onto a target of 16-bit floats, over what is drawn there. Nothing is counted
    /// or read back but what the method itself needs.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub async fn profile_async(
        &self,
        method: &mut Prepared,
        camera: &Camera,
    ) -> Result<Profile, RenderError> {
        let size = method.size();
        let texture = |v: &wgpu::TextureView| [v.texture().width(), v.texture().height()];
        let canvas = match method.canvas.take().filter(|v| texture(v) == size) {
            Some(canvas) => canvas,
            None => {
                let none = wgpu::TextureUsages::empty();
                self.gpu.texture("canvas", PROFILED, size, 1, none)?
            }
        };
        let target = Target::cleared(&canvas);
        let points = method.points();
        let mut sum = Drawn::default();
        for (k, &point) in points.iter().enumerate() {
            let drawn = self.drawn(method, (camera, point), false, Some(&target));
            sum.add(drawn.await?);
            if points.len() > 1 {
                let mean = match method.mean.take().filter(|m| m.is_of(&canvas)) {
                    Some(mean) => mean,
                    None => Mean::new(&self.gpu, &canvas)?,
                };
                sum.add(mean.take(&self.gpu, k == 0).await?);
                method.mean = Some(mean);
            }
        }
        method.canvas = Some(canvas);
        if points.len() > 1 {
            sum.stats.bytes_per_pixel += samples::MEAN_BYTES;
        }
        Ok(Profile {
            times: sum.times,
            stats: sum.stats,
            wall_micros: sum.wall_micros,
        })
    }

    /// The same as [`Self::profile_async`], waiting for the device. Not in a browser.
    ///
    /// # Errors
    /// See [`Self::profile_async`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn profile(&self, method: &mut Prepared, camera: &Camera) -> Result<Profile, RenderError> {
        self.gpu.block_on(self.profile_async(method, camera))
    }
}
