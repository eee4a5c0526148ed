//! The viewer in a web page: how it begins, and how it begins again after the browser took its graphics device away.

mod files;
mod handle;
mod shelf;

use crate::{
    address::Address,
    app::{App, Start},
    compare::Compare,
    memory,
    panels::State,
    slot::Network,
    stage::Source,
    task::{Task, repaints},
};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupExisting};
use egui::{FontData, FontDefinitions, FontFamily};
use files::Files;
pub(crate) use files::{choose_files, download};
pub use handle::Page;
use peelnet_gpu::{AdapterRequest, Gpu, GpuError};
use peelnet_render::{MethodSpec, RenderError};
use peelnet_scene::Camera;
use shelf::Shelf;
use std::{path::PathBuf, rc::Rc};
use wasm_bindgen::JsValue;

/// The scene and the method of a page that was not opened before.
const FIRST: (&str, &str) = ("cups", "deep-medium");
/// Seconds between two changes of the address: browsers refuse more than a hundred in half a minute.
const ADDRESS: f64 = 0.5;
/// Devices that are opened one after the other before the page gives up.
const MOST_LOST: u32 = 5;

/// What an application in a page has besides.
#[derive(Default)]
pub(crate) struct InPage {
    /// Draws the page again.
    context: egui::Context,
    /// Files that were dropped and are being read.
    reading: Option<Task<Result<Files, String>>>,
    /// What the address says, and when it was written.
    address: (String, f64),
    /// Begins again with another device.
    again: Option<Rc<dyn Fn()>>,
    /// The frame that the GPU is drawing.
    drawing: Option<Task<()>>,
    /// The scene that the browser keeps.
    shelf: Option<Rc<Shelf>>,
}

impl InPage {
    /// Whether the GPU is still drawing the last frame. A browser takes frames faster than a slow GPU draws them: what methods read back
    /// of a frame, and what is dragged, would wait behind all of them.
    pub fn is_drawing(&mut self, ui: &egui::Context) -> bool {
        if let Some(drawing) = &mut self.drawing
            && drawing.poll(ui).is_some()
        {
            self.drawing = None;
        }
        self.drawing.is_some()
    }

    /// A frame was submitted.
    pub fn drew(&mut self, gpu: &Gpu, ui: &egui::Context) {
        let gpu = gpu.clone();
        self.drawing = Some(Task::new(async move { gpu.submitted_async().await }));
        // Its end is asked for now, not at the next frame.
        self.is_drawing(ui);
    }
}

impl std::fmt::Debug for InPage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("InPage")
    }
}

/// What is shown, without anything of a device.
struct Kept {
    source: Option<Source>,
    time: Option<f32>,
    camera: Camera,
    view: Option<usize>,
    first: MethodSpec,
    network: Option<Network>,
    second: MethodSpec,
    compare: Compare,
    panels: State,
}

impl App {
    /// Leaves the application without anything that is worth keeping.
    fn keep(&mut self) -> Kept {
        let stage = self.stage.as_ref();
        Kept {
            source: stage.map(|s| s.source.clone()),
            time: self.time(),
            camera: self.camera,
            view: self.view,
            first: self.first.spec().clone(),
            network: self.first.network().cloned(),
            second: self.second.spec().clone(),
            compare: self.compare,
            panels: std::mem::replace(&mut self.panels, State::new(false)),
        }
    }

    /// The time of a scene that has a timeline.
    fn time(&self) -> Option<f32> {
        let scene = self.stage.as_ref()?.scene();
        (!scene.timeline.is_empty()).then_some(scene.time)
    }

    /// The application of an address.
    fn of_address(
        gpu: &Gpu,
        query: &str,
        mut recent: Vec<PathBuf>,
        shelf: &Shelf,
    ) -> Result<Self, RenderError> {
        let (address, wrong) = Address::read(query);
        recent.retain(|path| shelf.has(path));
        let last = recent.first().cloned();
        let last = last.unwrap_or_else(|| FIRST.0.into());
        let wanted = address.scene.clone().map(PathBuf::from);
        let missing = wanted.clone().filter(|path| !shelf.has(path));
        let is_missing = missing.is_some();
        let method = address.method.map_or_else(|| FIRST.1.parse(), Ok)?;
        let start = Start {
            view: address.view.filter(|_| !is_missing).unwrap_or(0),
            camera: address.camera.filter(|_| !is_missing),
            time: address.time.filter(|_| !is_missing),
            bare: address.bare,
            ..Start::new(FIRST.0, method)
        };
        let source = shelf.source(wanted.filter(|_| !is_missing).unwrap_or(last));
        let mut app = Self::of_source(gpu, start, source, recent);
        if app.stage.is_none() {
            // A time that the scene does not have, or a scene that this GPU does not take.
            app.open(Source::Named(FIRST.0.into()), None);
        }
        for text in wrong {
            app.messages.error(text);
        }
        if let Some(path) = missing {
            let name = peelnet_files::shown(&path);
            app.messages.warn(format!(
                "{name}: no scene of this name ships with the viewer, and a page keeps only the one that was dropped last: drop it again"
            ));
        }
        Ok(app)
    }

    /// The application of another device, as it was.
    fn of_kept(gpu: &Gpu, kept: Kept, recent: Vec<PathBuf>) -> Self {
        let start = Start::new(FIRST.0, kept.first.clone());
        let mut app = Self::empty(gpu, &start, recent);
        app.first.set_network(kept.network);
        app.second.set_spec(kept.second);
        app.compare = kept.compare;
        app.panels = kept.panels;
        if let Some(source) = kept.source {
            app.open(source, kept.time);
            (app.camera, app.view) = (kept.camera, kept.view);
        }
        app.messages
            .warn("the graphics device was lost: this view is drawn by a new one".into());
        app
    }

    /// Has the browser keep a dropped scene, in place of the one before.
    pub(crate) fn keep_dropped(&mut self, source: &Source) {
        if let Some(shelf) = &self.page.shelf
            && shelf.put(source)
        {
            self.recent.retain(|path| shelf.has(path));
        }
    }

    /// The scene of a name: the one that the browser keeps, or one that ships.
    pub(crate) fn kept_or_named(&self, path: PathBuf) -> Source {
        match &self.page.shelf {
            Some(shelf) => shelf.source(path),
            None => Source::Named(path),
        }
    }

    /// Begins again where the device was lost; whether it does.
    pub(crate) fn begin_again(&mut self, error: &GpuError) -> bool {
        if !matches!(error, GpuError::Lost(_)) {
            return false;
        }
        // Once: frames may still come until it has begun.
        if let Some(again) = self.page.again.take() {
            again();
        }
        true
    }

    /// Writes what is shown into the page's address.
    pub(crate) fn show_address(&mut self, ui: &egui::Context) {
        let Some(stage) = &self.stage else {
            return;
        };
        let scene = match &stage.source {
            Source::Named(path) | Source::Dropped(path, _) => path.to_string_lossy().into_owned(),
        };
        let (method, bare) = (self.first.spec(), self.panels.bare);
        let view = (self.view, &self.camera);
        let query = Address::query(&scene, method, view, self.time(), bare);
        let (written, when) = &self.page.address;
        if *written == query {
            return;
        }
        let now = ui.input(|i| i.time);
        let wait = ADDRESS - (now - when);
        if wait > 0.0 && !written.is_empty() {
            ui.request_repaint_after(std::time::Duration::from_secs_f64(wait));
            return;
        }
        if let Some(history) = web_sys::window().and_then(|w| w.history().ok()) {
            // A browser that refuses loses nothing but the link.
            let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&query));
        }
        self.page.address = (query, now);
        memory::save_in_page(&self.recent);
    }
}

/// Shows a sentence over the page, or nothing.
fn say(text: &str) {
    let document = web_sys::window().and_then(|w| w.document());
    if let Some(element) = document.and_then(|d| d.get_element_by_id("say")) {
        element.set_text_content(Some(text));
    }
}

/// Why there is nothing to draw with.
fn no_device(error: &GpuError) -> String {
    let why = crate::stage::one_line(error);
    format!("This browser gave the page no graphics device ({why}). Reload the page to try again.")
}

/// What the page draws on, with a device that is open.
fn options(gpu: &Gpu) -> eframe::WebOptions {
    let setup = WgpuSetupExisting {
        instance: gpu.instance.clone(),
        adapter: gpu.adapter.clone(),
        device: gpu.device.clone(),
        queue: gpu.queue.clone(),
    };
    eframe::WebOptions {
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::Existing(setup),
            ..Default::default()
        },
        ..Default::default()
    }
}

/// One font for words and for numbers, and egui's own signs; what they lack the browser draws.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let all = [
        ("text", epaint_default_fonts::UBUNTU_LIGHT),
        ("icons", epaint_default_fonts::EGUI_ICONS),
    ];
    for (name, bytes) in all {
        let data = FontData::from_static(bytes);
        fonts.font_data.insert(name.into(), data.into());
        for family in [FontFamily::Proportional, FontFamily::Monospace] {
            fonts.families.entry(family).or_default().push(name.into());
        }
    }
    fonts
}

/// What the application begins with.
enum Begin {
    /// What the address says.
    Address(String),
    /// What was shown before.
    Again(Box<Kept>),
}

impl Page {
    async fn begin(&self, begin: Begin) -> Result<(), String> {
        let opened = Gpu::open_async(&AdapterRequest::Auto).await;
        let gpu = opened.map_err(|e| no_device(&e))?;
        let options = options(&gpu);
        let page = self.clone();
        let make: eframe::AppCreator<'static> = Box::new(move |cc| {
            cc.egui_ctx.set_fonts(fonts());
            let recent = memory::load(cc.storage);
            let mut app = match begin {
                Begin::Address(query) => App::of_address(&gpu, &query, recent, &page.shelf)?,
                Begin::Again(kept) => App::of_kept(&gpu, *kept, recent),
            };
            gpu.wake_when_lost(repaints(&cc.egui_ctx));
            app.page.context = cc.egui_ctx.clone();
            app.page.shelf = Some(Rc::clone(&page.shelf));
            app.page.again = Some(Rc::new(move || {
                let page = page.clone();
                wasm_bindgen_futures::spawn_local(async move { page.begin_again().await });
            }));
            Ok(Box::new(app))
        });
        let started = self.runner.start(self.canvas.clone(), options, make).await;
        started.map_err(|e| {
            let why = e.as_string().unwrap_or_else(|| format!("{e:?}"));
            format!("The page cannot draw: {why}.")
        })
    }

    /// Another device and another application, as it was.
    async fn begin_again(&self) {
        let kept = self.runner.app_mut::<App>().map(|mut app| app.keep());
        let lost = self.lost.get() + 1;
        self.lost.set(lost);
        self.runner.destroy();
        let Some(kept) = kept else {
            return;
        };
        if lost > MOST_LOST {
            say(
                "The browser took the page's graphics device away again and again. Reload the page to try again.",
            );
            return;
        }
        say("The graphics device was lost: opening another one.");
        match self.begin(Begin::Again(Box::new(kept))).await {
            Ok(()) => say(""),
            Err(e) => say(&e),
        }
    }
}

impl App {
    /// Opens what was dropped onto the page or chosen.
    fn take_files(&mut self, files: Files) {
        use crate::input::{Opens, opens};
        match opens(files.keys().map(PathBuf::as_path)) {
            Ok(Opens::Network(path)) => {
                let bytes = files.get(path).map(Vec::as_slice).unwrap_or_default();
                match Network::from_bytes(path.to_owned(), bytes) {
                    Ok(network) => self.take_network(network),
                    Err(e) => self.messages.error(e),
                }
            }
            Ok(Opens::Scene(path)) => {
                let path = path.to_owned();
                self.open(Source::Dropped(path, files.into()), None);
            }
            Err(e) => self.messages.error(e),
        }
    }

    pub(crate) fn take_dropped(&mut self, ui: &egui::Context) {
        let dropped = ui.input(|i| i.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.page.reading = Some(Task::new(files::read(dropped)));
        }
        if let Some(reading) = &mut self.page.reading
            && let Some(read) = reading.poll(ui)
        {
            self.page.reading = None;
            match read {
                Ok(files) => self.take_files(files),
                Err(e) => self.messages.error(e),
            }
        }
    }
}
