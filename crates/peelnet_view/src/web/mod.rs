//! The viewer in a web page: how it begins, and how it begins again after the browser took its graphics device away.

mod dom;
mod files;
mod handle;
pub(crate) mod in_page;
mod shelf;
pub(crate) mod training;

use crate::{
    address,
    app::{App, Start, configuration},
    compare::Compare,
    memory,
    panels::state::State,
    slot::Network,
    stage::{Files, Source},
    task::{Fallible, Task, one_line, repaints},
};
use dom::show_message;
use egui::{FontData, FontDefinitions, FontFamily};
pub(crate) use files::{choose_files, download};
pub use handle::Page;
use peelnet_render::MethodSpec;
use peelnet_render::gpu::{AdapterRequest, Gpu, GpuError};
use peelnet_scene::Camera;
use shelf::Shelf;
use std::path::PathBuf;
use wasm_bindgen::JsValue;

/// The scene and the method of a page that was not opened before.
const FIRST: (&str, &str) = ("cups", "deep-medium");
/// Seconds between two changes of the address: browsers refuse more than a hundred in half a minute.
const ADDRESS: f64 = 0.5;
/// Devices that are opened one after the other before the page gives up.
const MOST_LOST: u32 = 5;

/// What is shown beside what the address says, without anything of a device.
struct Kept {
    against: MethodSpec,
    camera: Camera,
    view: Option<usize>,
    network: Option<Network>,
    compare: Compare,
    panels: State,
}

impl App {
    /// Leaves the application without anything that is worth keeping.
    fn keep(&mut self) -> Kept {
        Kept {
            against: self.second.spec.clone(),
            camera: self.camera,
            view: self.view,
            network: self.first.network.take(),
            compare: self.compare,
            panels: std::mem::replace(&mut self.panels, State::new(false)),
        }
    }

    /// As it was, with another device.
    fn restore(&mut self, kept: Kept) {
        self.first.set_network(kept.network);
        self.second.set_spec(kept.against);
        (self.camera, self.view) = (kept.camera, kept.view);
        (self.compare, self.panels) = (kept.compare, kept.panels);
        self.messages
            .warn("the graphics device was lost: this view is drawn by a new one".into());
    }

    fn of_address(
        gpu: &Gpu,
        query: &str,
        mut recent: Vec<PathBuf>,
        shelf: &Shelf,
    ) -> Fallible<Self> {
        recent.retain(|path| shelf.has(path));
        let mut start = Start::new("", FIRST.1.parse()?);
        let wrong = address::read(query, &mut start);
        let wanted = std::mem::take(&mut start.scene);
        let is_named = !wanted.as_os_str().is_empty();
        let is_missing = is_named && !shelf.has(&wanted);
        if is_missing {
            (start.view, start.camera, start.time) = (0, None, None);
        }
        let scene = if is_named && !is_missing {
            wanted.clone()
        } else {
            recent.first().cloned().unwrap_or_else(|| FIRST.0.into())
        };
        let mut app = Self::new(gpu, start, shelf.source(scene), recent);
        if app.stage.is_none() {
            // A time that the scene does not have, or a scene that this GPU does not take.
            app.open(Source::named(FIRST.0), None);
        }
        for text in wrong {
            app.messages.error(text);
        }
        if is_missing {
            let name = peelnet_core::files::shown(&wanted);
            app.messages.warn(format!(
                "{name}: no scene of this name ships with the viewer, and a page keeps only the one that was dropped last: drop it again"
            ));
        }
        Ok(app)
    }

    /// Has the browser keep a dropped scene, in place of the one before.
    pub(crate) fn keep_dropped(&mut self, source: &Source) {
        if let Some(page) = &self.page.handle
            && page.shelf.put(source)
        {
            self.recent.retain(|path| page.shelf.has(path));
        }
    }

    /// The scene of a name: the one that the browser keeps, or one that ships.
    pub(crate) fn kept_or_named(&self, path: PathBuf) -> Source {
        match &self.page.handle {
            Some(page) => page.shelf.source(path),
            None => Source::named(path),
        }
    }

    /// Begins again where the device was lost; whether it does.
    pub(crate) fn begin_again(&mut self, error: &GpuError) -> bool {
        if !matches!(error, GpuError::Lost(_)) {
            return false;
        }
        // Once: frames may still come until it has begun.
        if let Some(page) = self.page.handle.take() {
            wasm_bindgen_futures::spawn_local(async move { page.begin_again().await });
        }
        true
    }

    /// Writes what is shown into the page's address.
    pub(crate) fn show_address(&mut self, ui: &egui::Context) {
        let (written, when) = &self.page.address;
        let Some(query) = self.query().filter(|query| query != written) else {
            return;
        };
        let now = ui.input(|i| i.time);
        let wait = ADDRESS - (now - when);
        if wait > 0.0 && !written.is_empty() {
            ui.request_repaint_after(std::time::Duration::from_secs_f64(wait));
            return;
        }
        let window = web_sys::window();
        if let Some(history) = window.as_ref().and_then(|w| w.history().ok()) {
            // A browser that refuses loses nothing but the link.
            let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&query));
        }
        self.page.address = (query, now);
        // At once: a page may be closed without a word.
        if let Some(storage) = window.and_then(|w| w.local_storage().ok().flatten()) {
            // A browser that keeps nothing shows the first scene again.
            let _ = storage.set_item(memory::RECENT, &memory::text(&self.recent));
        }
    }

    /// Opens what was dropped onto the page or chosen.
    fn take_files(&mut self, files: Files) {
        let paths: Vec<PathBuf> = files.keys().cloned().collect();
        self.open_files(&paths, Some(files.into()));
    }

    pub(crate) fn take_dropped(&mut self, ui: &egui::Context) {
        let dropped = ui.input(|i| i.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.page.reading = Some(Task::new(files::read(dropped)));
        }
        let read = Task::finish(&mut self.page.reading, ui);
        let files = read.and_then(|read| self.messages.unless_error(read));
        if let Some(files) = files {
            self.take_files(files);
        }
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

impl Page {
    /// Opens a device, and what the query of an address says; after another device, what was shown.
    async fn begin(&self, query: String, kept: Option<Kept>) -> Result<(), String> {
        let opened = Gpu::open_async(&AdapterRequest::Auto).await;
        let gpu = opened.map_err(|e| {
            let why = one_line(&e);
            format!("This browser gave the page no graphics device ({why}). Reload the page to try again.")
        })?;
        let options = eframe::WebOptions {
            wgpu_options: configuration(&gpu),
            ..Default::default()
        };
        let page = self.clone();
        let make: eframe::AppCreator<'static> = Box::new(move |cc| {
            cc.egui_ctx.set_fonts(fonts());
            let recent = memory::load(cc.storage);
            let app = App::of_address(&gpu, &query, recent, &page.shelf);
            let mut app = app.map_err(|e| one_line(&*e))?;
            if let Some(kept) = kept {
                app.restore(kept);
            }
            gpu.wake_when_lost(repaints(&cc.egui_ctx));
            app.page.context = cc.egui_ctx.clone();
            app.page.handle = Some(page);
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
        let app = self.runner.app_mut::<App>();
        let kept = app.map(|mut app| (app.query().unwrap_or_default(), app.keep()));
        let lost = self.lost.get() + 1;
        self.lost.set(lost);
        self.runner.destroy();
        let Some((query, kept)) = kept else { return };
        if lost > MOST_LOST {
            show_message(
                "The browser took the page's graphics device away again and again. Reload the page to try again.",
            );
            return;
        }
        show_message("The graphics device was lost: opening another one.");
        match self.begin(query, Some(kept)).await {
            Ok(()) => show_message(""),
            Err(e) => show_message(&e),
        }
    }
}
