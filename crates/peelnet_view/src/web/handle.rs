//! What the page's own script, and tests, do with the viewer.

use super::{dom::show_message, shelf::Shelf};
use crate::{
    app::App,
    eye,
    stage::{Files, Source},
};
use peelnet_render::{FrameStatus, MethodSpec};
use std::{cell::Cell, path::PathBuf, rc::Rc};
use wasm_bindgen::{JsValue, prelude::wasm_bindgen};

/// The viewer on a canvas.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Page {
    pub(super) runner: eframe::WebRunner,
    pub(super) canvas: web_sys::HtmlCanvasElement,
    pub(super) lost: Rc<Cell<u32>>,
    pub(super) shelf: Rc<Shelf>,
}

impl Page {
    /// Reads or changes the application, and has it drawn again.
    fn with<T>(&self, of: impl FnOnce(&mut App) -> T) -> Option<T> {
        let mut app = self.runner.app_mut::<App>()?;
        let result = of(&mut app);
        app.page.context.request_repaint();
        Some(result)
    }

    /// Reads, without drawing anything for it.
    fn read<T>(&self, of: impl FnOnce(&App) -> T) -> Option<T> {
        self.runner.app_mut::<App>().map(|app| of(&app))
    }
}

fn named(names: Vec<String>, files: Vec<js_sys::Uint8Array>) -> Files {
    let files = names.into_iter().zip(files);
    let files = files.map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec()));
    files.collect()
}

#[wasm_bindgen]
impl Page {
    /// Opens a device and draws what the query of an address says on a canvas.
    ///
    /// `scene` is the name of the dropped scene that the browser keeps, empty if there is none, and `names` and `files` are its files.
    /// `keep` is called with the same three where another scene was dropped.
    ///
    /// # Errors
    /// One sentence for people.
    pub async fn open(
        canvas: web_sys::HtmlCanvasElement,
        query: String,
        scene: String,
        names: Vec<String>,
        files: Vec<js_sys::Uint8Array>,
        keep: js_sys::Function,
    ) -> Result<Page, JsValue> {
        let shelf = Shelf::new(scene, named(names, files), keep);
        let page = Self {
            runner: eframe::WebRunner::new(),
            canvas,
            lost: Rc::default(),
            shelf: Rc::new(shelf),
        };
        page.begin(query, None).await?;
        show_message("");
        Ok(page)
    }

    /// Opens files, as if they were dropped.
    pub fn give(&self, names: Vec<String>, files: Vec<js_sys::Uint8Array>) {
        let files = named(names, files);
        self.with(|app| app.take_files(files));
    }

    pub fn warn(&self, text: &str) {
        let text = peelnet_core::files::one_line(text).into_owned();
        self.with(|app| app.messages.warn(text));
    }

    /// Whether the viewer panicked: then it draws no more.
    pub fn panicked(&self) -> bool {
        self.runner.has_panicked()
    }

    /// Draws with another method from the next frame on.
    ///
    /// # Errors
    /// A text that names no method.
    pub fn set_method(&self, method: &str) -> Result<(), String> {
        let method: MethodSpec = method.parse().map_err(|e| crate::task::one_line(&e))?;
        self.with(|app| app.first.set_spec(method));
        Ok(())
    }

    pub fn method(&self) -> Option<String> {
        self.read(|app| app.first.spec.to_string())
    }

    pub fn open_scene(&self, name: &str) {
        self.with(|app| app.open(Source::named(name), None));
    }

    pub fn scene(&self) -> Option<String> {
        self.read(|app| app.stage.as_ref().map(|s| s.source.name()))?
    }

    /// Turns about the target, radians.
    pub fn orbit(&self, yaw: f32, pitch: f32) {
        self.with(|app| app.move_eye(|camera, _| eye::orbit(camera, yaw, pitch)));
    }

    /// Frames that the method has drawn since the page was opened or its device lost.
    pub fn frames(&self) -> f64 {
        self.read(|app| app.first.frames as f64).unwrap_or_default()
    }

    /// Whether the picture is whole: methods that count fragments first need more than a frame.
    pub fn is_whole(&self) -> bool {
        let whole = |app: &App| {
            let slot = &app.first;
            slot.picture.is_some()
                && slot.failure.is_none()
                && slot.status == FrameStatus::Whole
                && app.page.reading.is_none()
        };
        self.read(whole).unwrap_or_default()
    }

    /// Mean squared error of the picture, of 255², once it is measured.
    pub fn error(&self) -> Option<f64> {
        self.read(|app| {
            let numbers = app.errors.get(&app.key()?)?.as_ref();
            numbers.ok().map(|n| n.differences.mse255)
        })?
    }

    /// Messages, one a line.
    pub fn messages(&self) -> String {
        let lines = |app: &App| -> Vec<String> {
            let lines = app.messages.0.iter();
            lines.map(|(_, text)| text.clone()).collect()
        };
        self.read(lines).unwrap_or_default().join("\n")
    }

    pub fn devices_lost(&self) -> u32 {
        self.lost.get()
    }

    /// Has the device destroyed, as a browser may do at any time.
    pub fn lose_device(&self) {
        self.read(|app| app.gpu.device.destroy());
    }
}
