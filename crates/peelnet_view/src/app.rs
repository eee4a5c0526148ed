//! The application: what is open, what is shown, and one frame of it.

use crate::{
    compare::{Compare, Mode},
    display::{self, Display},
    eye,
    front::Front,
    inspect::Inspector,
    memory,
    messages::Messages,
    numbers::{EXACT, ErrorJob, Key, LayerCounter},
    panels::state::State,
    saving::Output,
    script::Script,
    slot::{Network, Slot},
    stage::{Source, Stage},
    task::{Fallible, one_line},
    training::Training,
    watch::Watch,
};
use eframe::egui_wgpu::{RenderState, WgpuConfiguration, WgpuSetup, WgpuSetupExisting};
use egui::Context;
use glam::Vec3;
use peelnet_model::{Model, Recipe};
use peelnet_render::gpu::{Gpu, wgpu};
use peelnet_render::{FrameStatus, MethodSpec};
use peelnet_scene::{Blending, Camera, Scene};
use std::{path::PathBuf, time::Duration};

/// How long the view rests before errors are measured, seconds.
const REST: f64 = 0.15;
const MOST_RECENT: usize = 10;

/// What the window begins with.
#[derive(Clone, Debug)]
pub struct Start {
    /// A scene file, a mesh file, or the name of a shipped scene.
    pub scene: PathBuf,
    /// The same scene where it is loaded already, at `time`.
    pub loaded: Option<Scene>,
    pub method: MethodSpec,
    pub model: Option<PathBuf>,
    pub view: usize,
    /// Eye, target and field of view in place of the view's own, see [`crate::camera_numbers`].
    pub camera: Option<Vec<f32>>,
    pub time: Option<f32>,
    /// Folders in which mesh files may name others, see [`Scene::load_with`].
    pub files_from: Vec<PathBuf>,
    /// How pictures are compared at first.
    pub compare: Mode,
    /// What the method is compared with; by default the exact one.
    pub against: Option<MethodSpec>,
    /// Whether the picture alone is shown, without panels.
    pub bare: bool,
    /// A dataset to look into, and to train on; not in a page.
    pub dataset: Option<PathBuf>,
    /// Trains this at once, on the dataset or else on the scene; not in a page.
    pub train: Option<Recipe>,
    pub script: Option<Script>,
}

impl Start {
    pub fn new(scene: impl Into<PathBuf>, method: MethodSpec) -> Self {
        Self {
            scene: scene.into(),
            loaded: None,
            method,
            model: None,
            view: 0,
            camera: None,
            time: None,
            files_from: Vec::new(),
            compare: Mode::One,
            against: None,
            bare: false,
            dataset: None,
            train: None,
            script: None,
        }
    }
}

pub(crate) fn configuration(gpu: &Gpu) -> WgpuConfiguration {
    WgpuConfiguration {
        wgpu_setup: WgpuSetup::Existing(WgpuSetupExisting {
            instance: gpu.instance.clone(),
            adapter: gpu.adapter.clone(),
            device: gpu.device.clone(),
            queue: gpu.queue.clone(),
        }),
        ..Default::default()
    }
}

pub(crate) struct App {
    pub gpu: Gpu,
    pub stage: Option<Stage>,
    pub camera: Camera,
    /// The scene's view that the camera still is.
    pub view: Option<usize>,
    pub first: Slot,
    pub second: Slot,
    pub compare: Compare,
    pub errors: ErrorJob,
    pub counter: LayerCounter,
    pub inspector: Inspector,
    pub front: Front,
    pub output: Output,
    pub training: Training,
    #[cfg(not(target_arch = "wasm32"))]
    pub dataset: Option<crate::dataset::Looked>,
    /// Begins with the next frame.
    train: Option<Recipe>,
    pub messages: Messages,
    pub watch: Watch,
    pub recent: Vec<PathBuf>,
    files_from: Vec<PathBuf>,
    pub panels: State,
    pub size: [u32; 2],
    script: Option<Script>,
    pub display: Display,
    displayed: Option<(display::View, [u64; 2], [u32; 2])>,
    /// When the view last changed, and what it was: seconds of the window's clock.
    rest: Option<(Key, f64)>,
    /// Clock time of the last frames' work on the CPU, milliseconds.
    pub cpu_ms: f64,
    #[cfg(target_arch = "wasm32")]
    pub page: crate::web::in_page::InPage,
}

impl App {
    /// Opens a scene from a source, whatever `start` names; what does not open is a message in the window.
    pub fn new(gpu: &Gpu, start: Start, source: Source, recent: Vec<PathBuf>) -> Self {
        let against = start.against.or_else(|| EXACT.parse().ok());
        let mut app = Self {
            gpu: gpu.clone(),
            stage: None,
            camera: Camera {
                position: Vec3::Z,
                target: Vec3::ZERO,
                up: Vec3::Y,
                fov_y_degrees: 45.0,
                near: 0.1,
                far: 10.0,
            },
            view: None,
            second: Slot::new(against.unwrap_or_else(|| start.method.clone())),
            first: Slot::new(start.method),
            compare: Compare {
                mode: start.compare,
                divider: 0.5,
                scale: 16.0,
            },
            errors: ErrorJob::default(),
            counter: LayerCounter::default(),
            inspector: Inspector::default(),
            front: Front::default(),
            output: Output::default(),
            training: Training::default(),
            #[cfg(not(target_arch = "wasm32"))]
            dataset: None,
            train: start.train,
            messages: Messages::default(),
            watch: Watch::default(),
            recent,
            files_from: start.files_from,
            panels: State::new(start.bare),
            size: [0; 2],
            script: start.script,
            display: Display::new(gpu),
            displayed: None,
            rest: None,
            cpu_ms: 0.0,
            #[cfg(target_arch = "wasm32")]
            page: crate::web::in_page::InPage::default(),
        };
        match start.loaded {
            Some(scene) => app.take(Stage::of_scene(gpu, app.allowing(source), scene)),
            None => app.open(source, start.time),
        }
        app.show_view(start.view);
        if let Some(numbers) = start.camera.filter(|numbers| numbers.len() >= 6) {
            app.move_eye(|camera, _| {
                camera.position = Vec3::from_slice(&numbers);
                camera.target = Vec3::from_slice(&numbers[3..]);
                camera.fov_y_degrees = *numbers.get(6).unwrap_or(&camera.fov_y_degrees);
            });
        }
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(path) = start.dataset {
            app.open_dataset(&path);
        }
        if let Some(path) = start.model {
            app.open_network(Source::named(path));
        }
        app
    }

    /// Replaces the scene; the one that is shown stays where the new one does not open.
    pub fn open(&mut self, source: Source, time: Option<f32>) {
        self.take(Stage::open(&self.gpu, self.allowing(source), time));
    }

    fn allowing(&self, source: Source) -> Source {
        Source {
            files_from: self.files_from.clone(),
            ..source
        }
    }

    fn take(&mut self, opened: Fallible<Stage>) {
        let Some(stage) = self.messages.unless_error(opened) else {
            return;
        };
        self.cancel();
        self.training.abandon();
        for warning in &stage.scene.warnings {
            self.messages.warn(warning.clone());
        }
        let path = &stage.source.path;
        self.recent.retain(|p| p != path);
        self.recent.insert(0, path.clone());
        self.recent.truncate(MOST_RECENT);
        #[cfg(target_arch = "wasm32")]
        self.keep_dropped(&stage.source);
        self.first.forget();
        self.second.forget();
        self.inspector.pixel = None;
        (self.panels.plays, self.panels.turns) = (false, false);
        self.stage = Some(stage);
        self.show_view(0);
    }

    pub fn show_view(&mut self, number: usize) {
        let Some(stage) = &self.stage else { return };
        match stage.scene.views.get(number) {
            Some(camera) => (self.camera, self.view) = (*camera, Some(number)),
            None => self.messages.error(format!(
                "{} has {} views, numbered from 0: there is no view {number}",
                stage.source.name(),
                stage.scene.views.len()
            )),
        }
    }

    /// Moves the camera, and puts its planes around the scene.
    pub fn move_eye(&mut self, change: impl FnOnce(&mut Camera, eye::Sphere)) {
        if let Some(stage) = &self.stage {
            change(&mut self.camera, stage.all);
            eye::set_planes(&mut self.camera, stage.all);
            self.view = None;
        }
    }

    /// Draws with a network, by its method, and reads its file again when it changes.
    pub fn open_network(&mut self, source: Source) {
        let bytes = source.bytes();
        let model = bytes.and_then(|bytes| Ok(Model::from_bytes(&bytes, &source.path)?));
        let network = model.and_then(|m| Network::from_model(Some(source.path.clone()), m));
        let Some(network) = self.messages.unless_error(network) else {
            return;
        };
        let method = network.weight.recipe.method;
        if method != self.first.spec.name()
            && let Ok(spec) = method.parse()
        {
            self.first.set_spec(spec);
        }
        self.errors.cancel();
        self.training.abandon();
        self.first.set_network(Some(network));
        self.watch
            .follow(Some(source.path).filter(|_| source.dropped.is_none()));
    }

    pub fn edit(&mut self, change: impl FnOnce(&mut Stage) -> Fallible<()>) {
        // Measurements hold the scene: what they measure is not there any more.
        self.cancel();
        if let Some(stage) = &mut self.stage {
            self.messages.unless_error(change(stage));
        }
    }

    fn cancel(&mut self) {
        self.errors.cancel();
        self.counter.cancel();
        self.inspector.job.cancel();
        self.front.job.cancel();
        self.output.job.cancel();
    }

    /// What identifies the picture.
    pub fn key(&self) -> Option<Key> {
        Some(Key {
            view: self.stage.as_ref()?.view(self.camera, self.size),
            method: self.first.spec.to_string(),
            network: self.first.own_network().map(|n| n.number),
        })
    }

    fn poll(&mut self, ui: &Context) {
        // Callbacks of finished GPU work run here, on systems where nothing else calls them.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        if let Err(e) = self.gpu.check() {
            #[cfg(target_arch = "wasm32")]
            if self.begin_again(&e) {
                return;
            }
            self.messages.error(one_line(&e));
        }
        self.first.poll(ui);
        self.second.poll(ui);
        self.errors.poll(ui);
        self.counter.poll(ui);
        self.inspector.job.poll(ui);
        self.front.job.poll(ui);
        self.output.job.poll(ui);
        if let Some(path) = self.watch.changed(ui) {
            self.open_network(Source::named(path));
        }
        if let Some(recipe) = self.train.take() {
            self.begin_training(ui, Some(recipe));
        }
        self.poll_training(ui);
        #[cfg(not(target_arch = "wasm32"))]
        self.poll_dataset(ui);
    }

    /// Draws what is shown in a picture of this size, where anything changed; the texture that egui shows.
    pub fn draw(
        &mut self,
        egui: &RenderState,
        ui: &Context,
        size: [u32; 2],
    ) -> Option<egui::TextureId> {
        self.size = size;
        #[cfg(target_arch = "wasm32")]
        if self.page.is_drawing(ui) {
            return self.display.texture();
        }
        let waits = self.awaits_training();
        let always = (self.script.as_ref()).is_some_and(|script| script.draws_always(waits));
        let stage = self.stage.as_ref()?;
        let mode = self.compare.mode_at(ui);
        let half = [size[0].div_ceil(2), size[1]];
        let own = if mode == Mode::Beside { half } else { size };
        let view = stage.view(self.camera, own);
        let mut encoder = self.gpu.encoder();
        let mut drawn = self.first.draw(stage, &mut encoder, view, always);
        if mode.needs_second() {
            drawn |= self.second.draw(stage, &mut encoder, view, always);
        }
        for slot in [&self.first, &self.second] {
            if let Some(failure) = &slot.failure {
                self.messages.error(format!("{}: {failure}", slot.spec));
            }
        }
        if mode == Mode::Layers {
            self.counter.want(stage, view);
            if let Some((_, Err(e))) = &self.counter.last {
                self.messages.error(e.clone());
            }
        }
        let map = self.counter.map().filter(|_| mode == Mode::Layers);
        let (show, scale) = match (mode, map) {
            (_, Some(map)) => (mode, map.most.max(1.0)),
            (Mode::Layers, None) => (Mode::One, self.compare.scale),
            _ => (mode, self.compare.scale),
        };
        let first = map.map_or(self.first.picture.as_ref(), |map| Some(&map.texture))?;
        let second = self.second.picture.as_ref().unwrap_or(first);
        let divider = if mode == Mode::Beside {
            half[0]
        } else {
            (self.compare.divider * size[0] as f32).round() as u32
        };
        let view = display::View {
            show: show as u32,
            divider,
            scale,
            is_encoded: u32::from(stage.scene.blending == Blending::Display),
        };
        let state = (view, [self.first.frames, self.second.frames], size);
        if !drawn && mode != Mode::Layers && self.displayed == Some(state) {
            return self.display.texture();
        }
        let pictures = [first, second];
        let (display, gpu) = (&mut self.display, &self.gpu);
        let done = display.draw(gpu, egui, &mut encoder, size, pictures, view);
        self.messages.unless_error(done);
        self.gpu.queue.submit([encoder.finish()]);
        #[cfg(target_arch = "wasm32")]
        self.page.drew(&self.gpu, ui);
        self.displayed = Some(state);
        let unfinished = |slot: &Slot| slot.failure.is_none() && slot.status != FrameStatus::Whole;
        if unfinished(&self.first) || (mode.needs_second() && unfinished(&self.second)) {
            ui.request_repaint();
        }
        self.display.texture()
    }

    fn measure(&mut self, ui: &Context) {
        let Some(key) = self.key().filter(|_| self.size != [0; 2]) else {
            return;
        };
        let now = ui.input(|i| i.time);
        let since = self.rest.as_ref().filter(|(of, _)| *of == key);
        let since = since.map(|(_, since)| *since);
        if since.is_none() {
            self.rest = Some((key.clone(), now));
        }
        if since.is_none_or(|since| now - since < REST) {
            ui.request_repaint_after(Duration::from_secs_f64(REST));
        } else if let Some(stage) = self.stage.as_ref().filter(|s| s.shown.layers.is_none()) {
            if self.panels.measures {
                self.errors.want(stage, &self.first, key.clone());
            }
            self.inspector.want(stage, &self.first, key);
        }
    }

    pub fn frame(&mut self, ui: &mut egui::Ui, egui: &RenderState) {
        let begin = web_time::Instant::now();
        let ctx = ui.ctx().clone();
        self.poll(&ctx);
        self.take_dropped(&ctx);
        self.take_keys(&ctx);
        self.advance(&ctx);
        self.show_panels(ui, egui);
        self.measure(&ctx);
        #[cfg(target_arch = "wasm32")]
        self.show_address(&ctx);
        // A slow average, so that the number can be read.
        let now = begin.elapsed().as_secs_f64() * 1e3;
        self.cpu_ms += 0.1 * (now - self.cpu_ms);
        let waits = self.awaits_training();
        #[cfg(not(target_arch = "wasm32"))]
        let waits = waits || self.awaits_dataset();
        if let Some(script) = &mut self.script {
            script.advance(&ctx, &self.first, &self.training, waits, now);
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        match frame.wgpu_render_state().cloned() {
            Some(egui) => self.frame(ui, &egui),
            None => {
                ui.label(
                    "This needs WebGPU, or Vulkan, Metal or Direct3D 12, and found none of them.",
                );
            }
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        storage.set_string(memory::RECENT, memory::text(&self.recent));
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
