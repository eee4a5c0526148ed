//! Draws a scene with every transparency method.
//!
//! How a frame is drawn: [`Renderer::new`] puts the scene's triangles on the GPU once, in world space and in one
//! buffer. [`Renderer::prepare`] makes a method ready for a frame size: its targets and pipelines. Each
//! [`Renderer::draw`] first draws opaque objects over the background colour, which gives `C_0` and a depth buffer, then
//! lets the method composite all transparent fragments over `C_0`: in one unordered pass ([`methods`] that commute),
//! by peeling, or by storing and sorting ([`passes`]). Everything is linear light in 32-bit floats; [`Image`]
//! encodes for display.
//!
//! Transparent passes have no fixed-function depth test. One shader function compares with the opaque depth, because
//! storage writes of a fragment shader happen before that test; it exists only in scenes that have opaque objects.

mod error;
pub mod flaw;
mod image;
mod maps;
pub mod methods;
pub mod passes;
pub mod scene;

pub use error::RenderError;
pub use flaw::{Flaw, Property};
pub use image::Image;
pub use methods::{FrameStats, METHODS, Method, MethodSpec, Role, layers::LayerView};

use methods::{Build, Compositor, DrawContext};
use peelnet_gpu::{
    Gpu,
    record::{PassTime, Recorder},
};
use peelnet_scene::{Camera, Scene};
use scene::{FrameTargets, GeometryPipelines, PixelSample, SceneBuffers};
use std::time::Instant;

/// The exported text that a learned method draws with.
#[derive(Clone, Debug)]
pub struct LearnedWeight {
    /// What the network was trained as.
    pub recipe: peelnet_model::Recipe,
    /// WGSL with `peelnet_features` and `peelnet_weight`.
    pub wgsl: String,
}

/// A finished frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear colour and coverage.
    pub image: Image,
    /// GPU time of every pass, where the adapter measures it.
    pub times: Vec<PassTime>,
    /// What the method reports.
    pub stats: FrameStats,
    /// Clock time from the first command to the last result, read-back of the image not included.
    pub wall_micros: f64,
}

/// A scene on a device.
#[derive(Debug)]
pub struct Renderer<'g> {
    gpu: &'g Gpu,
    scene: SceneBuffers,
}

/// A method made ready for one scene and frame size.
#[derive(Debug)]
pub struct Prepared {
    frame: FrameTargets,
    opaque: Option<GeometryPipelines>,
    compositor: Box<dyn Compositor>,
}

impl<'g> Renderer<'g> {
    /// Uploads a scene.
    ///
    /// # Errors
    /// A scene larger than the adapter's largest buffer.
    pub fn new(gpu: &'g Gpu, scene: &Scene) -> Result<Self, RenderError> {
        Ok(Self {
            gpu,
            scene: SceneBuffers::new(gpu, scene)?,
        })
    }

    /// What a transparent pass binds of the scene.
    pub fn bindings(&self) -> Vec<&'static str> {
        self.scene.bindings()
    }

    /// What the vertex shader reads of a corner.
    pub fn corner_attributes(&self) -> Vec<&'static str> {
        self.scene.corner_attributes()
    }

    /// Hands transparent surfaces to the GPU in another order from now on.
    pub fn submit(&mut self, order: scene::Submission) {
        self.scene.submit(order);
    }

    /// The warp that methods take a view's depths through.
    pub fn depth_warp(&self, camera: &Camera) -> peelnet_core::absorbance::DepthWarp {
        self.scene.depth_warp(camera)
    }

    /// Makes a method ready for frames of `size` (width, height).
    ///
    /// # Errors
    /// A knob's value, a missing model, a missing feature of the adapter, or a frame beyond its limits.
    pub fn prepare(
        &self,
        spec: &MethodSpec,
        size: [u32; 2],
        learned: Option<&LearnedWeight>,
    ) -> Result<Prepared, RenderError> {
        let frame = self.scene.targets(self.gpu, size)?;
        let compositor = methods::build(&Build {
            gpu: self.gpu,
            scene: &self.scene,
            frame: &frame,
            spec,
            learned,
        })?;
        self.finish(frame, compositor)
    }

    /// Makes the view of layers ready, of a scene that [`Scene::layer_view`] has made.
    ///
    /// # Errors
    /// A frame beyond the adapter's limits.
    pub fn prepare_layers(&self, view: LayerView, size: [u32; 2]) -> Result<Prepared, RenderError> {
        let frame = self.scene.targets(self.gpu, size)?;
        let compositor = methods::layers::build(self.gpu, &self.scene, &frame, view)?;
        self.finish(frame, compositor)
    }

    fn finish(
        &self,
        frame: FrameTargets,
        compositor: Box<dyn Compositor>,
    ) -> Result<Prepared, RenderError> {
        let opaque = self.scene.opaque_pipelines(self.gpu, &frame)?;
        self.gpu.check()?;
        Ok(Prepared {
            frame,
            opaque,
            compositor,
        })
    }

    /// Draws a view, counts what its statistics need, and reads the image back.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub fn draw(&self, prepared: &mut Prepared, camera: &Camera) -> Result<Frame, RenderError> {
        self.record(prepared, camera, true)
            .and_then(|(stats, times, wall_micros)| {
                let [width, height] = prepared.frame.size;
                Ok(Frame {
                    image: Image {
                        width,
                        height,
                        pixels: self.gpu.read_rgba32f(&prepared.frame.image)?,
                    },
                    times,
                    stats,
                    wall_micros,
                })
            })
    }

    /// Draws a view for its time alone: nothing is counted or read back. Returns the time of each pass and the clock time.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub fn time(
        &self,
        prepared: &mut Prepared,
        camera: &Camera,
    ) -> Result<(Vec<PassTime>, f64), RenderError> {
        self.record(prepared, camera, false)
            .map(|(_, times, wall)| (times, wall))
    }

    fn record(
        &self,
        prepared: &mut Prepared,
        camera: &Camera,
        counting: bool,
    ) -> Result<(FrameStats, Vec<PassTime>, f64), RenderError> {
        let start = Instant::now();
        self.scene
            .set_view(self.gpu, camera, &prepared.frame, PixelSample::ALL);
        let mut recorder = Recorder::new(self.gpu, true);
        self.scene
            .draw_background(&mut recorder, &prepared.frame, prepared.opaque.as_ref());
        let stats = prepared.compositor.draw(&mut DrawContext {
            recorder: &mut recorder,
            scene: &self.scene,
            camera,
            frame: &prepared.frame,
            counting,
        })?;
        let times = recorder.finish()?;
        Ok((stats, times, start.elapsed().as_secs_f64() * 1e6))
    }
}
