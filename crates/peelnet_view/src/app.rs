//! The application: what is open, what is shown, and one frame of it.

use crate::{
    compare::{Compare, Mode},
    display::{Display, Show, View},
    eye::{self},
    front::Front,
    inspect::Inspector,
    messages::Messages,
    motion::Motion,
    numbers::{EXACT, Judge, Key, LayerCounter},
    output::Output,
    panels,
    script::Script,
    slot::{Network, Slot},
    stage::{Source, Stage},
    watch::Watch,
};
use eframe::egui_wgpu::RenderState;
use egui::Context;
use peelnet_gpu::{Gpu, wgpu};
use peelnet_render::MethodSpec;
use peelnet_scene::{Camera, Scene};
use std::path::PathBuf;

/// How long the view rests before errors are measured, seconds.
const REST: f64 = 0.15;
/// Scenes that are remembered.
const MOST_RECENT: usize = 10;

/// What the window begins with.
#[derive(Clone, Debug)]
pub struct Start {
    /// A scene file, a mesh file, or the name of a shipped scene.
    pub scene: PathBuf,
    /// The same scene where it is loaded already, at `time`.
    pub loaded: Option<Scene>,
    /// The method.
    pub method: MethodSpec,
    /// A network for it, read again whenever its file changes.
    pub model: Option<PathBuf>,
    /// The number of the scene's view.
    pub view: usize,
    /// Eye, target and field of view in place of the view's own, see [`crate::camera_numbers`].
    pub camera: Option<Vec<f32>>,
    /// The time of the scene's timeline.
    pub time: Option<f32>,
    /// How pictures are compared at first.
    pub compare: Mode,
    /// What the method is compared with; by default the exact one.
    pub against: Option<MethodSpec>,
    /// Whether the picture alone is shown, without panels.
    pub bare: bool,
    /// What a script asks for.
    pub script: Option<Script>,
}

impl Start {
    /// A scene with a method, view 0.
    pub fn new(scene: impl Into<PathBuf>, method: MethodSpec) -> Self {
        Self {
            scene: scene.into(),
            loaded: None,
            method,
            model: None,
            view: 0,
            camera: None,
            time: None,
            compare: Mode::One,
            against: None,
            bare: false,
            script: None,
        }
    }
}

/// The viewer.
#[derive(Debug)]
pub struct App {
    pub(crate) gpu: Gpu,
    pub(crate) stage: Option<Stage>,
    pub(crate) camera: Camera,
    /// The scene's view that the camera still is.
    pub(crate) view: Option<usize>,
    pub(crate) first: Slot,
    pub(crate) second: Slot,
    pub(crate) compare: Compare,
    pub(crate) judge: Judge,
    pub(crate) counter: LayerCounter,
    pub(crate) inspector: Inspector,
    pub(crate) front: Front,
    pub(crate) output: Output,
    pub(crate) messages: Messages,
    pub(crate) motion: Motion,
    pub(crate) watch: Watch,
    pub(crate) recent: Vec<PathBuf>,
    pub(crate) panels: panels::State,
    /// Size of the picture, pixels.
    pub(crate) size: [u32; 2],
    pub(crate) script: Option<Script>,
    display: Display,
    displayed: Option<(View, [u64; 2], [u32; 2])>,
    /// When the view last changed, and what it was: seconds of the window's clock.
    rest: Option<(Key, f64)>,
    /// Clock time of the last frames' work on the CPU, milliseconds.
    pub(crate) cpu_ms: f64,
    #[cfg(target_arch = "wasm32")]
    pub(crate) page: crate::web::InPage,
}

impl App {
    /// Opens a scene; what does not open is a message in the window.
    pub fn new(gpu: &Gpu, mut start: Start, recent: Vec<PathBuf>) -> Self {
        let source = Source::Named(std::mem::take(&mut start.scene));
        Self::of_source(gpu, start, source, recent)
    }

    /// The same with the scene of a source, whatever `start` names.
    pub(crate) fn of_source(gpu: &Gpu, start: Start, source: Source, recent: Vec<PathBuf>) -> Self {
        let mut app = Self::empty(gpu, &start, recent);
        app.compare.mode = start.compare;
        match start.loaded {
            Some(scene) => app.take(Stage::of_scene(gpu, source, scene)),
            None => app.open(source, start.time),
        }
        app.show_view(start.view);
        if let Some([px, py, pz, tx, ty, tz, angle @ ..]) = start.camera.as_deref() {
            let (position, target) = ([*px, *py, *pz].into(), [*tx, *ty, *tz].into());
            let angle = angle.first().copied();
            app.move_eye(|camera, _| {
                (camera.position, camera.target) = (position, target);
                camera.fov_y_degrees = angle.unwrap_or(camera.fov_y_degrees);
            });
        }
        if let Some(path) = start.model {
            app.open_network(path);
        }
        app
    }

    /// Without a scene.
    pub(crate) fn empty(gpu: &Gpu, start: &Start, recent: Vec<PathBuf>) -> Self {
        let exact: Option<MethodSpec> = EXACT.parse().ok();
        Self {
            gpu: gpu.clone(),
            stage: None,
            camera: Camera {
                position: glam::Vec3::Z,
                target: glam::Vec3::ZERO,
                up: glam::Vec3::Y,
                fov_y_degrees: 45.0,
                near: 0.1,
                far: 10.0,
            },
            view: None,
            second: {
                let against = start.against.clone().or(exact);
                Slot::new(against.unwrap_or_else(|| start.method.clone()))
            },
            first: Slot::new(start.method.clone()),
            compare: Compare::default(),
            judge: Judge::default(),
            counter: LayerCounter::default(),
            inspector: Inspector::default(),
            front: Front::default(),
            output: Output::default(),
            messages: Messages::default(),
            motion: Motion::default(),
            watch: Watch::default(),
            recent,
            panels: panels::State::new(start.bare),
            size: [0; 2],
            script: start.script.clone(),
            display: Display::new(gpu),
            displayed: None,
            rest: None,
            cpu_ms: 0.0,
            #[cfg(target_arch = "wasm32")]
            page: crate::web::InPage::default(),
        }
    }

    /// Replaces the scene; the one that is shown stays where the new one does not open.
    pub(crate) fn open(&mut self, source: Source, time: Option<f32>) {
        self.take(Stage::open(&self.gpu, source, time));
    }

    fn take(&mut self, opened: Result<Stage, String>) {
        match opened {
            Ok(stage) => self.replace(stage),
            Err(e) => self.messages.error(e),
        }
    }

    fn replace(&mut self, stage: Stage) {
        self.cancel();
        for warning in &stage.scene().warnings {
            self.messages.warn(warning.clone());
        }
        let (Source::Named(path) | Source::Dropped(path, _)) = &stage.source;
        self.recent.retain(|p| p != path);
        self.recent.insert(0, path.clone());
        self.recent.truncate(MOST_RECENT);
        #[cfg(target_arch = "wasm32")]
        self.keep_dropped(&stage.source);
        self.first.forget();
        self.second.forget();
        self.inspector.pixel = None;
        self.motion.stop();
        self.stage = Some(stage);
        self.show_view(0);
    }

    /// Looks through one of the scene's cameras.
    pub(crate) fn show_view(&mut self, number: usize) {
        let Some(stage) = &self.stage else {
            return;
        };
        match stage.scene().views.get(number) {
            Some(camera) => {
                self.camera = *camera;
                self.view = Some(number);
            }
            None => self.messages.error(format!(
                "{} has {} views, numbered from 0: there is no view {number}",
                stage.source.name(),
                stage.scene().views.len()
            )),
        }
    }

    /// Moves the camera, and puts its planes around the scene.
    pub(crate) fn move_eye(&mut self, change: impl FnOnce(&mut Camera, eye::Sphere)) {
        if let Some(stage) = &self.stage {
            change(&mut self.camera, stage.all);
            eye::set_planes(&mut self.camera, stage.all);
            self.view = None;
        }
    }

    /// Draws with a network from a file, by its method, and reads the file again when it changes.
    pub(crate) fn open_network(&mut self, path: PathBuf) {
        let read = std::fs::read(&path)
            .map_err(|e| format!("{}: cannot be read: {e}", peelnet_files::shown(&path)));
        match read.and_then(|bytes| Network::from_bytes(path.clone(), &bytes)) {
            Ok(network) => {
                self.take_network(network);
                self.watch.follow(path);
            }
            Err(e) => self.messages.error(e),
        }
    }

    pub(crate) fn take_network(&mut self, network: Network) {
        if !network.is_of(self.first.spec())
            && let Ok(spec) = network.weight.recipe.method.parse()
        {
            self.first.set_spec(spec);
        }
        self.judge.cancel();
        self.judge.last = None;
        self.first.set_network(Some(network));
    }

    /// Changes the scene; a failure is a message.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Stage) -> Result<(), String>) {
        // Measurements hold the scene: what they measure is not there any more.
        self.cancel();
        if let Some(stage) = &mut self.stage
            && let Err(e) = change(stage)
        {
            self.messages.error(e);
        }
    }

    fn cancel(&mut self) {
        self.judge.cancel();
        self.counter.cancel();
        self.inspector.cancel();
        self.front.cancel();
        self.output.cancel();
    }

    /// What identifies the picture.
    pub(crate) fn key(&self) -> Option<Key> {
        let stage = self.stage.as_ref()?;
        Some(Key::of(stage, &self.first, &self.camera, self.size))
    }

    fn poll(&mut self, ui: &Context) {
        // Callbacks of finished GPU work run here, on systems where nothing else calls them.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        if let Err(e) = self.gpu.check() {
            #[cfg(target_arch = "wasm32")]
            if self.begin_again(&e) {
                return;
            }
            self.messages.error(crate::stage::one_line(&e));
        }
        self.first.poll(ui);
        self.second.poll(ui);
        self.judge.poll(ui);
        self.counter.poll(ui);
        self.inspector.poll(ui);
        self.front.poll(ui);
        self.output.poll(ui);
        if let Some(path) = self.watch.changed(ui) {
            self.open_network(path);
        }
    }

    /// Draws what is shown in a picture of this size, where anything changed; the texture that egui shows.
    pub(crate) fn draw(
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
        let always = self.script.as_ref().is_some_and(Script::draws_always);
        let stage = self.stage.as_ref()?;
        let mode = self.compare.mode_at(ui);
        let half = [size[0].div_ceil(2), size[1]];
        let own = if mode == Mode::Beside { half } else { size };
        let mut encoder = self.gpu.encoder();
        let mut drawn = self
            .first
            .draw(stage, &mut encoder, &self.camera, own, always);
        if mode.needs_second() {
            drawn |= self
                .second
                .draw(stage, &mut encoder, &self.camera, own, always);
        }
        if mode == Mode::Layers {
            self.counter.want(stage, &self.camera, size);
        }
        for slot in [&self.first, &self.second] {
            if let Some(failure) = &slot.failure {
                self.messages.error(format!("{}: {failure}", slot.spec()));
            }
        }
        let map = match &self.counter.map {
            Some(Ok(map)) if mode == Mode::Layers => Some(map),
            Some(Err(e)) if mode == Mode::Layers => {
                self.messages.error(e.clone());
                None
            }
            _ => None,
        };
        let (show, scale) = match (mode, map) {
            (Mode::Layers, Some(map)) => (Show::Layers, map.most.max(1.0)),
            (mode, _) => (mode.show(), self.compare.scale),
        };
        let first = map.map_or_else(|| self.first.picture(), |map| Some(&map.texture))?;
        let second = self.second.picture().unwrap_or(first);
        let divider = if mode == Mode::Beside {
            half[0]
        } else {
            (self.compare.divider * size[0] as f32).round() as u32
        };
        let view = View {
            show: show as u32,
            divider,
            scale,
            pad: 0,
        };
        let state = (view, [self.first.frames, self.second.frames], size);
        if !drawn && mode != Mode::Layers && self.displayed == Some(state) {
            return self.display.texture();
        }
        let pictures = [first, second];
        let done = self
            .display
            .draw(&self.gpu, egui, &mut encoder, size, pictures, view);
        if let Err(e) = done {
            self.messages.error(crate::stage::one_line(&e));
        }
        self.gpu.queue.submit([encoder.finish()]);
        #[cfg(target_arch = "wasm32")]
        self.page.drew(&self.gpu, ui);
        self.displayed = Some(state);
        let unfinished = |slot: &Slot| {
            slot.failure.is_none() && slot.status() != peelnet_render::FrameStatus::Whole
        };
        if unfinished(&self.first) || (mode.needs_second() && unfinished(&self.second)) {
            ui.request_repaint();
        }
        self.display.texture()
    }

    /// Measures what is shown once it rests.
    fn measure(&mut self, ui: &Context) {
        let Some(key) = self.key().filter(|_| self.size != [0; 2]) else {
            return;
        };
        let now = ui.input(|i| i.time);
        match &self.rest {
            Some((of, since)) if *of == key => {
                if now - since >= REST {
                    if let Some(stage) = self.stage.as_ref().filter(|s| s.layers().is_none()) {
                        if self.panels.measures {
                            self.judge.want(stage, &self.first, key.clone());
                        }
                        self.inspector.want(stage, &self.first, key, self.size);
                    }
                } else {
                    ui.request_repaint_after(std::time::Duration::from_secs_f64(REST));
                }
            }
            _ => {
                self.rest = Some((key, now));
                ui.request_repaint_after(std::time::Duration::from_secs_f64(REST));
            }
        }
    }
}

impl App {
    /// One frame of the window.
    pub(crate) fn frame(&mut self, ui: &mut egui::Ui, egui: &RenderState) {
        let begin = web_time::Instant::now();
        let ctx = ui.ctx().clone();
        self.poll(&ctx);
        self.take_dropped(&ctx);
        self.take_keys(&ctx);
        self.advance(&ctx);
        panels::show(self, ui, egui);
        self.measure(&ctx);
        #[cfg(target_arch = "wasm32")]
        self.show_address(&ctx);
        // A slow average, so that the number can be read.
        let now = begin.elapsed().as_secs_f64() * 1e3;
        self.cpu_ms += 0.1 * (now - self.cpu_ms);
        if let Some(mut script) = self.script.take() {
            script.advance(&ctx, &self.first, now);
            self.script = Some(script);
        }
    }

    /// What the window shows as the picture.
    #[cfg(test)]
    pub(crate) const fn displayed(&self) -> &Display {
        &self.display
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
        crate::memory::save(storage, &self.recent);
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
