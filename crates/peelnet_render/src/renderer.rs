//! [`Renderer`]: a scene on a device, drawn onto a caller's target. Images and times of whole frames are in `whole.rs`.

use crate::geometry::{FrameTargets, PixelSample, SamplePoint, SceneBuffers, frame::Output};
use crate::gpu::{
    Gpu,
    readback::Download,
    record::{Recorder, Timer},
    wgpu,
};
use crate::{
    RenderError,
    frame::Canvas,
    methods::{self, METHODS, spec::MethodSpec},
    passes::{
        compositor::{Build, Compositor, DrawContext, Fit, FrameStats},
        views::{LayerView, Shows},
    },
    target::{FrameStatus, LearnedWeight, MethodOptions, Target},
};
use peelnet_scene::{Camera, Scene};
use std::{
    collections::VecDeque,
    ops::{Deref, DerefMut},
};

/// Frames whose counts may be on their way at one time.
const FRAMES_IN_FLIGHT: usize = 3;

/// A method made ready for one renderer. It keeps its targets and counts from frame to frame; another size, target format or depth buffer
/// makes targets anew, and takes pipelines from the device's cache.
#[derive(Debug)]
pub struct Prepared {
    spec: MethodSpec,
    options: MethodOptions,
    pub(crate) ready: Option<Ready>,
    pub(crate) canvas: Option<Canvas>,
    /// Counts on their way, of frames that had the room there is now.
    pub(crate) pending: VecDeque<Download>,
    status: FrameStatus,
    /// Of the last frame that was encoded onto a caller's target.
    stats: FrameStats,
    /// Whether images are frames of a moving picture.
    is_moving: bool,
}

#[derive(Debug)]
pub(crate) struct Ready {
    generation: u64,
    callers_depth: Option<wgpu::TextureView>,
    pub(crate) frame: FrameTargets,
    pub(crate) compositor: Box<dyn Compositor>,
}

impl Prepared {
    /// Size of [`Renderer::image`]s from now on, width and height in pixels.
    pub const fn resize(&mut self, size: [u32; 2]) {
        self.options.size = size;
    }

    /// [`Renderer::image`]s are frames of a moving picture from now on: each is drawn once, as an engine would, and not until it has settled.
    pub const fn set_moving(&mut self) {
        self.is_moving = true;
    }

    /// Size of [`Renderer::image`]s.
    pub const fn size(&self) -> [u32; 2] {
        self.options.size
    }

    /// Samples a pixel of [`Renderer::image`]s.
    pub const fn samples(&self) -> u32 {
        self.options.samples
    }

    /// What the method reports of the last frame that [`Renderer::draw`] encoded: passes and memory; fragments where it needs their number.
    pub const fn stats(&self) -> FrameStats {
        self.stats
    }

    /// Takes the counts of a frame: see [`Compositor::learn`].
    pub(crate) fn learn(
        &mut self,
        scene: &SceneBuffers,
        exact: bool,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let Some(ready) = &mut self.ready else {
            return Ok(Fit::Whole);
        };
        let b = Build {
            scene,
            frame: &ready.frame,
            spec: &self.spec,
            options: &self.options,
        };
        ready.compositor.learn(&b, exact, words, stats)
    }

    /// Whether the frame drawn last would not change if it was drawn again.
    pub(crate) fn is_settled(&self) -> bool {
        let ready = self.ready.as_ref();
        self.is_moving || ready.is_none_or(|ready| ready.compositor.is_settled())
    }

    /// Where the repetitions of a frame sample its pixels.
    pub(crate) fn points(&self) -> Vec<SamplePoint> {
        match self.options.samples {
            4 => SamplePoint::of_four(self.options.size).to_vec(),
            _ => vec![SamplePoint::MIDDLE],
        }
    }
}

/// A scene on a device. Objects, materials and lights change in place, for all frames submitted later: see [`SceneBuffers`].
#[derive(Debug)]
pub struct Renderer {
    pub(crate) scene: SceneBuffers,
}

impl Deref for Renderer {
    type Target = SceneBuffers;

    fn deref(&self) -> &SceneBuffers {
        &self.scene
    }
}

impl DerefMut for Renderer {
    fn deref_mut(&mut self) -> &mut SceneBuffers {
        &mut self.scene
    }
}

impl Renderer {
    /// Uploads a scene.
    ///
    /// # Errors
    /// A scene larger than the adapter's largest buffer.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let scene = SceneBuffers::new(gpu, scene)?;
        Ok(Self { scene })
    }

    /// The device.
    pub const fn gpu(&self) -> &Gpu {
        &self.scene.gpu
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
        if !matches!(options.samples, 1 | 4) {
            return Err(RenderError::Refused(format!(
                "a pixel has 1 or 4 samples, not {}",
                options.samples
            )));
        }
        let shipped = || LearnedWeight::shipped(spec);
        options.learned = options.learned.or_else(shipped);
        let mut method = Prepared {
            spec: spec.clone(),
            options,
            ready: None,
            canvas: None,
            pending: VecDeque::new(),
            status: FrameStatus::Unknown,
            stats: FrameStats::default(),
            is_moving: false,
        };
        let size = method.size();
        self.ready(&mut method, size, Output::Image, None)?;
        self.gpu.check()?;
        Ok(method)
    }

    /// Makes the view of layers ready, of a scene that [`Scene::layer_view`] made.
    ///
    /// # Errors
    /// A frame beyond the adapter's limits.
    pub fn layers(&self, view: LayerView, size: [u32; 2]) -> Result<Prepared, RenderError> {
        self.exact(Shows::Layers(view), MethodOptions::sized(size))
    }

    /// Makes an image ready that tells, instead of a colour, which transparent surfaces a pixel shows: see [`crate::passes::views`].
    ///
    /// # Errors
    /// A frame beyond the adapter's limits.
    pub fn surfaces(&self, size: [u32; 2], samples: u32) -> Result<Prepared, RenderError> {
        self.exact(Shows::Surfaces, MethodOptions::sized(size).sampled(samples))
    }

    /// By the exact method, the first of all.
    fn exact(&self, shows: Shows, options: MethodOptions) -> Result<Prepared, RenderError> {
        let exact = MethodSpec::representative(&METHODS[0]);
        self.method(&exact, MethodOptions { shows, ..options })
    }

    /// Makes the method's targets and pipelines for a frame, anew where anything that they depend on changed.
    pub(crate) fn ready(
        &self,
        method: &mut Prepared,
        size: [u32; 2],
        output: Output,
        depth: Option<&wgpu::TextureView>,
    ) -> Result<(), RenderError> {
        let (scene, generation) = (&self.scene, self.scene.generation());
        let fits = |r: &Ready| {
            (r.generation, r.frame.size, r.frame.output) == (generation, size, output)
                && r.callers_depth.as_ref() == depth
        };
        if method.ready.as_ref().is_some_and(fits) {
            return Ok(());
        }
        // Old targets go before new ones come.
        method.ready = None;
        method.pending.clear();
        method.status = FrameStatus::Unknown;
        let frame = scene.targets(size, output, depth)?;
        let compositor = methods::build(&Build {
            scene,
            frame: &frame,
            spec: &method.spec,
            options: &method.options,
        })?;
        method.ready = Some(Ready {
            generation,
            callers_depth: depth.cloned(),
            frame,
            compositor,
        });
        Ok(())
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
        self.draw_timed(encoder, method, camera, target, None)
    }

    /// The same as [`Self::draw`], measuring every pass: [`Timer::finish`] records the copy of the times, which are there once the commands
    /// are done.
    pub fn draw_timed(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        method: &mut Prepared,
        camera: &Camera,
        target: &Target<'_>,
        timer: Option<&mut Timer>,
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
        let mut recorder = Recorder::new(&self.gpu, encoder, timer);
        let view = (camera, SamplePoint::MIDDLE);
        method.stats = self.encode(ready, &mut recorder, view, Some(target), true, false)?;
        let feedback = ready.compositor.feedback();
        if feedback.is_empty() {
            method.status = FrameStatus::Whole;
        } else if method.pending.len() < FRAMES_IN_FLIGHT {
            let download = Download::record(&self.gpu, encoder, &feedback);
            method.pending.push_back(download);
        }
        Ok(method.status)
    }

    /// How pipelines write to a target.
    pub(crate) fn output(&self, target: &Target<'_>) -> Result<([u32; 2], Output), RenderError> {
        let (texture, tinted) = (target.color.texture(), self.scene.tinted);
        let (format, samples) = (texture.format(), texture.sample_count());
        let size = [texture.width(), texture.height()];
        // What WebGPU guarantees of the format with the device's features: some adapters would blend more.
        let guaranteed = format.guaranteed_format_features(self.gpu.device.features());
        let blendable = wgpu::TextureFormatFeatureFlags::BLENDABLE;
        let depth = target.depth.map(wgpu::TextureView::texture);
        let fits =
            |d: &wgpu::Texture| ([d.width(), d.height()], d.sample_count()) == (size, samples);
        let depth_format = depth.map(wgpu::Texture::format);
        let is_depth_alone =
            |f: wgpu::TextureFormat| f.is_depth_stencil_format() && !f.has_stencil_aspect();
        let fault = if !tinted && !guaranteed.flags.contains(blendable) {
            format!(
                "its format {format:?} cannot be blended on this device; use Rgba16Float, Rgba8Unorm or another that can"
            )
        } else if !depth.is_none_or(fits) {
            "its depth has another size or sample count".into()
        } else if let Some(format) = depth_format.filter(|f| !is_depth_alone(*f)) {
            format!("its depth is {format:?}; use a format of depth alone")
        } else if tinted && (!target.clear || depth.is_some()) {
            // Coloured transmission cannot be blended: the resolve needs what lies behind, and that is ours only after a clear.
            "this scene's transmission is coloured, which needs the background: clear the target, and let the scene hold the opaque \
             surfaces"
                .into()
        } else {
            let output = Output::Target {
                format,
                samples,
                over: !tinted,
            };
            return Ok((size, output));
        };
        Err(RenderError::Target(fault))
    }

    /// Takes the counts that came back, and makes room for what they say.
    fn learn(&self, method: &mut Prepared) -> Result<(), RenderError> {
        while let Some(download) = method.pending.front_mut() {
            let Some(words) = download.try_read()? else {
                break;
            };
            method.pending.pop_front();
            let fit = method.learn(&self.scene, false, &words, &mut FrameStats::default())?;
            method.status = match fit {
                Fit::TooSmall => FrameStatus::Grown,
                Fit::Whole | Fit::Loose => FrameStatus::Whole,
            };
            if fit != Fit::Whole {
                // The frames behind it had another room: they say nothing of what there is now.
                method.pending.clear();
            }
        }
        Ok(())
    }

    pub(crate) fn encode(
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
        let clear = target.is_none_or(|t| t.clear);
        self.scene.draw_background(recorder, frame, color, clear);
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
}
