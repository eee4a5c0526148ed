//! A method and its picture.

use crate::{
    stage::{Stage, View, next_number},
    task::{Fallible, Task, one_line},
};
use peelnet_model::{Model, Recipe};
use peelnet_render::gpu::{
    GpuError,
    record::{PassTime, Timer},
    wgpu,
};
use peelnet_render::{
    Frame, FrameStats, FrameStatus, LearnedWeight, MethodOptions, MethodSpec, Prepared,
    RenderError, Renderer, Target, milliseconds,
};
use peelnet_scene::Camera;
use std::{path::PathBuf, rc::Rc};

/// Format of pictures: what engines draw transparency onto before they map tones.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

#[derive(Clone)]
pub(crate) struct Network {
    /// The file that it is in; none of one that was trained here and is not exported.
    pub path: Option<PathBuf>,
    pub model: Model,
    pub weight: LearnedWeight,
    /// Another number whenever a file is read or an epoch ends.
    pub number: u64,
}

impl Network {
    pub fn from_model(path: Option<PathBuf>, model: Model) -> Fallible<Self> {
        let weight = LearnedWeight {
            recipe: model.meta.recipe,
            wgsl: peelnet_export::wgsl(&model)?,
        };
        Ok(Self {
            path,
            model,
            weight,
            number: next_number(),
        })
    }
}

/// A method made ready, its target, and what is known of its last frame.
pub(crate) struct Slot {
    pub spec: MethodSpec,
    /// From a file; the method may be another one's.
    pub network: Option<Network>,
    prepared: Option<(u64, Prepared)>,
    /// While it is made ready anew.
    stats: FrameStats,
    pub picture: Option<wgpu::TextureView>,
    shown: Option<View>,
    pub status: FrameStatus,
    timing: Option<Task<Result<Vec<PassTime>, GpuError>>>,
    /// GPU times of the passes of the last frame that is known of, in their order.
    pub times: Vec<PassTime>,
    /// Why there is no new picture.
    pub failure: Option<String>,
    pub frames: u64,
    /// Clock time that making the method ready took, pipelines included: the pause when it is chosen, milliseconds.
    pub ready_ms: f64,
}

impl Slot {
    pub fn new(spec: MethodSpec) -> Self {
        Self {
            spec,
            network: None,
            prepared: None,
            stats: FrameStats::default(),
            picture: None,
            shown: None,
            status: FrameStatus::Unknown,
            timing: None,
            times: Vec::new(),
            failure: None,
            frames: 0,
            ready_ms: 0.0,
        }
    }

    /// The network from a file, where the method draws with it.
    pub fn own_network(&self) -> Option<&Network> {
        let network = self.network.as_ref();
        network.filter(|n| n.weight.recipe.method == self.spec.name())
    }

    /// The network that the method draws with: from a file, or the one that ships.
    pub fn model(&self) -> Option<Model> {
        match self.own_network() {
            Some(network) => Some(network.model.clone()),
            None => Model::shipped(Recipe::for_method(self.spec.name())?).ok(),
        }
    }

    fn options(&self, size: [u32; 2]) -> MethodOptions {
        MethodOptions::sized(size).with(self.own_network().map(|n| &n.weight))
    }

    /// The same method for images that are drawn beside the window's frames.
    pub fn shot(&self, stage: &Stage, size: [u32; 2]) -> Shot {
        Shot {
            renderer: Rc::clone(&stage.renderer),
            spec: self.spec.clone(),
            options: self.options(size),
        }
    }

    pub fn set_spec(&mut self, spec: MethodSpec) {
        if spec != self.spec {
            self.spec = spec;
            self.forget();
        }
    }

    pub fn set_network(&mut self, network: Option<Network>) {
        let was_own = self.own_network().is_some();
        self.network = network;
        if was_own || self.own_network().is_some() {
            // Times and passes stay until others are known: of the same method they hardly differ.
            self.stats = self.stats();
            self.renew();
        }
    }

    /// Makes the method ready anew, at the next frame; nothing is known of it before.
    pub fn forget(&mut self) {
        self.renew();
        self.stats = FrameStats::default();
        self.timing = None;
        self.times.clear();
    }

    fn renew(&mut self) {
        self.prepared = None;
        self.shown = None;
        self.status = FrameStatus::Unknown;
        self.failure = None;
    }

    pub fn stats(&self) -> FrameStats {
        let prepared = self.prepared.as_ref();
        prepared.map_or(self.stats, |(_, p)| p.stats())
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
        view: View,
        always: bool,
    ) -> bool {
        if self.shown == Some(view) {
            let is_done = self.failure.is_some() || self.status == FrameStatus::Whole;
            if is_done && !always {
                return false;
            }
        }
        let encoded = self.encode(stage, encoder, &view);
        self.failure = encoded.err().map(|e| one_line(&*e));
        self.shown = Some(view);
        self.failure.is_none()
    }

    fn encode(
        &mut self,
        stage: &Stage,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
    ) -> Fallible<()> {
        let renderer = &stage.renderer;
        let target = match self.picture.take().filter(|p| size_of(p) == view.size) {
            Some(target) => target,
            None => {
                let usage = wgpu::TextureUsages::empty();
                (stage.gpu).texture("picture", PICTURE, view.size, 1, usage)?
            }
        };
        self.picture = Some(target.clone());
        let id = stage.renderer_number;
        let prepared = match self.prepared.take().filter(|(of, _)| *of == id) {
            Some(prepared) => prepared,
            None => {
                let begin = web_time::Instant::now();
                let made = match stage.shown.layers {
                    Some(layers) => renderer.layers(layers, view.size),
                    None => renderer.method(&self.spec, self.options(view.size)),
                };
                self.ready_ms = begin.elapsed().as_secs_f64() * 1e3;
                (id, made?)
            }
        };
        let (_, prepared) = self.prepared.insert(prepared);
        let target = Target::cleared(&target);
        let mut timer = self.timing.is_none().then(|| Timer::new(&stage.gpu));
        let drawn = renderer.draw_timed(encoder, prepared, &view.camera, &target, timer.as_mut());
        if let Some(timer) = timer {
            let times = timer.finish(&stage.gpu, encoder);
            self.timing = Some(Task::new(times));
        }
        self.status = drawn?;
        self.frames += 1;
        Ok(())
    }

    pub fn poll(&mut self, ui: &egui::Context) {
        if let Some(Ok(times)) = Task::finish(&mut self.timing, ui) {
            self.times = times;
        }
    }
}

pub(crate) fn size_of(view: &wgpu::TextureView) -> [u32; 2] {
    [view.texture().width(), view.texture().height()]
}

/// A method on a renderer, for images of its own.
pub(crate) struct Shot {
    pub renderer: Rc<Renderer>,
    pub spec: MethodSpec,
    pub options: MethodOptions,
}

impl Shot {
    pub async fn frame(&self, camera: &Camera) -> Result<Frame, RenderError> {
        let mut prepared = self.renderer.method(&self.spec, self.options.clone())?;
        self.renderer.image_async(&mut prepared, camera).await
    }
}
