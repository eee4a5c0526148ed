//! A method and its picture.

use crate::{
    stage::{Stage, one_line},
    task::Task,
};
use peelnet_gpu::{
    GpuError,
    record::{PassTime, Timer},
    wgpu,
};
use peelnet_model::{Model, Recipe};
use peelnet_render::{
    FrameStats, FrameStatus, LayerView, LearnedWeight, MethodOptions, MethodSpec, Prepared, Target,
    milliseconds,
};
use peelnet_scene::Camera;
use std::path::PathBuf;

/// Format of pictures: what engines draw transparency onto before they map tones.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A network that was read from a file.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    pub path: PathBuf,
    pub model: Model,
    pub weight: LearnedWeight,
}

impl Network {
    /// Reads a model file and writes its shader text.
    ///
    /// # Errors
    /// What is wrong with the file; one line.
    pub fn from_bytes(path: PathBuf, bytes: &[u8]) -> Result<Self, String> {
        let model = Model::from_bytes(bytes, &path).map_err(|e| one_line(&e))?;
        let wgsl = peelnet_export::wgsl(&model).map_err(|e| one_line(&e))?;
        Ok(Self {
            weight: LearnedWeight {
                recipe: model.meta.recipe,
                wgsl,
            },
            path,
            model,
        })
    }

    /// Whether a method draws with it.
    pub fn is_of(&self, spec: &MethodSpec) -> bool {
        self.weight.recipe.method == spec.name()
    }
}

/// The network that ships for a method, or the one from a file that fits it.
pub(crate) fn model_of(spec: &MethodSpec, network: Option<&Network>) -> Option<Model> {
    if let Some(network) = network.filter(|n| n.is_of(spec)) {
        return Some(network.model.clone());
    }
    Model::shipped(Recipe::of_method(spec.name())?).ok()
}

/// What a picture shows.
#[derive(Clone, Debug, PartialEq)]
struct Shown {
    version: u64,
    camera: Camera,
    size: [u32; 2],
}

/// A method made ready, its target, and what is known of its last frame.
#[derive(Debug)]
pub(crate) struct Slot {
    spec: MethodSpec,
    layers: Option<LayerView>,
    network: Option<Network>,
    prepared: Option<(u64, Prepared)>,
    target: Option<wgpu::TextureView>,
    shown: Option<Shown>,
    status: FrameStatus,
    timing: Option<Task<Result<Vec<PassTime>, GpuError>>>,
    /// GPU times of the passes of the last frame that is known of, in their order.
    pub times: Vec<PassTime>,
    /// Why there is no new picture.
    pub failure: Option<String>,
    /// Frames drawn.
    pub frames: u64,
    /// Clock time that making the method ready took, pipelines included: the pause when it is chosen, milliseconds.
    pub ready_ms: f64,
}

impl Slot {
    pub const fn new(spec: MethodSpec) -> Self {
        Self {
            spec,
            layers: None,
            network: None,
            prepared: None,
            target: None,
            shown: None,
            status: FrameStatus::Unknown,
            timing: None,
            times: Vec::new(),
            failure: None,
            frames: 0,
            ready_ms: 0.0,
        }
    }

    pub const fn spec(&self) -> &MethodSpec {
        &self.spec
    }

    pub const fn network(&self) -> Option<&Network> {
        self.network.as_ref()
    }

    /// The network from a file, where the method draws with it.
    pub fn learned(&self) -> Option<&LearnedWeight> {
        let network = self.network.as_ref().filter(|n| n.is_of(&self.spec));
        network.map(|n| &n.weight)
    }

    /// Another method from the next frame on.
    pub fn set_spec(&mut self, spec: MethodSpec) {
        if spec != self.spec {
            self.spec = spec;
            self.forget();
        }
    }

    /// A network from a file, or the shipped ones.
    pub fn set_network(&mut self, network: Option<Network>) {
        self.network = network;
        self.forget();
    }

    /// Makes the method ready anew, at the next frame.
    pub fn forget(&mut self) {
        self.prepared = None;
        self.shown = None;
        self.status = FrameStatus::Unknown;
        self.failure = None;
        self.timing = None;
        self.times.clear();
    }

    /// What the method reports of its frames.
    pub fn stats(&self) -> FrameStats {
        let prepared = self.prepared.as_ref();
        prepared.map(|(_, p)| p.stats()).unwrap_or_default()
    }

    pub const fn status(&self) -> FrameStatus {
        self.status
    }

    /// The picture; `None` before the first.
    pub const fn picture(&self) -> Option<&wgpu::TextureView> {
        self.target.as_ref()
    }

    /// GPU time of the last frame that is known of, milliseconds.
    pub fn gpu_ms(&self) -> Option<f64> {
        milliseconds(&self.times)
    }

    /// Records a frame, unless the picture shows it already; whether it did. A failure is kept until something changes.
    pub fn draw(
        &mut self,
        stage: &Stage,
        encoder: &mut wgpu::CommandEncoder,
        camera: &Camera,
        size: [u32; 2],
        always: bool,
    ) -> bool {
        let shown = Shown {
            version: stage.version(),
            camera: *camera,
            size,
        };
        if self.layers != stage.layers() {
            self.layers = stage.layers();
            self.forget();
        }
        if self.shown.as_ref() == Some(&shown) {
            let is_done = self.failure.is_some() || self.status == FrameStatus::Whole;
            if is_done && !always {
                return false;
            }
        }
        self.failure = self.encode(stage, encoder, camera, size).err();
        self.shown = Some(shown);
        self.failure.is_none()
    }

    fn encode(
        &mut self,
        stage: &Stage,
        encoder: &mut wgpu::CommandEncoder,
        camera: &Camera,
        size: [u32; 2],
    ) -> Result<(), String> {
        let renderer = stage.renderer();
        let of = |view: &wgpu::TextureView| [view.texture().width(), view.texture().height()];
        let target = match self.target.take().filter(|view| of(view) == size) {
            Some(target) => target,
            None => {
                let usage = wgpu::TextureUsages::empty();
                let made = stage.gpu.texture("picture", PICTURE, size, 1, usage);
                made.map_err(|e| one_line(&e))?
            }
        };
        let target = &*self.target.insert(target);
        let id = stage.renderer_number();
        let prepared = match self.prepared.take().filter(|(of, _)| *of == id) {
            Some(prepared) => prepared,
            None => {
                let begin = web_time::Instant::now();
                let made = match self.layers {
                    Some(view) => renderer.layers(view, size),
                    None => {
                        let network = self.network.as_ref().filter(|n| n.is_of(&self.spec));
                        let options = MethodOptions::sized(size).with(network.map(|n| &n.weight));
                        renderer.method(&self.spec, options)
                    }
                };
                self.ready_ms = begin.elapsed().as_secs_f64() * 1e3;
                (id, made.map_err(|e| one_line(&e))?)
            }
        };
        let (_, prepared) = self.prepared.insert(prepared);
        let target = Target::cleared(target);
        let drawn = if self.timing.is_none() {
            let mut timer = Timer::new(&stage.gpu);
            let drawn = renderer.draw_timed(encoder, prepared, camera, &target, Some(&mut timer));
            let times = timer.finish(&stage.gpu, encoder);
            self.timing = Some(Task::new(times.read()));
            drawn
        } else {
            renderer.draw(encoder, prepared, camera, &target)
        };
        self.status = drawn.map_err(|e| one_line(&e))?;
        self.frames += 1;
        Ok(())
    }

    /// Takes the times that came back.
    pub fn poll(&mut self, ui: &egui::Context) {
        if let Some(timing) = &mut self.timing
            && let Some(times) = timing.poll(ui)
        {
            self.timing = None;
            if let Ok(times) = times {
                self.times = times;
            }
        }
    }
}
