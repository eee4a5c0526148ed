//! Everything around the picture.

mod front;
pub(crate) mod methods;
mod numbers;
mod output;
mod pixel;
mod scene;
mod top;

use crate::app::App;
use eframe::egui_wgpu::RenderState;
use egui::{CentralPanel, Frame, Panel, ScrollArea, Ui};

/// Windows narrower than this have one column below the picture instead of two beside it, points.
const NARROW: f32 = 760.0;

/// Which panels are open, and what is typed into them.
#[derive(Debug)]
pub(crate) struct State {
    /// The picture alone.
    pub bare: bool,
    pub left: bool,
    pub right: bool,
    /// Whether errors are measured when the view rests.
    pub measures: bool,
    pub help: bool,
    /// What is typed as a file to open.
    #[cfg_attr(
        target_arch = "wasm32",
        allow(dead_code, reason = "a page has no paths")
    )]
    pub path: String,
    /// What is typed as a network's file.
    pub model: String,
    /// The object that is edited.
    pub object: usize,
    /// Whether points of the front are listed.
    pub listed: bool,
    /// Frames of a film that is saved.
    pub frames: u32,
}

impl State {
    pub const fn new(bare: bool) -> Self {
        Self {
            bare,
            left: true,
            right: true,
            measures: true,
            help: false,
            path: String::new(),
            model: String::new(),
            object: 0,
            listed: false,
            frames: output::FRAMES,
        }
    }
}

/// The whole window.
pub(crate) fn show(app: &mut App, ui: &mut Ui, egui: &RenderState) {
    if ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Tab)) {
        app.panels.bare = !app.panels.bare;
    }
    if app.panels.bare {
        CentralPanel::no_frame().show(ui, |ui| app.show_viewport(ui, egui));
        return;
    }
    Panel::top("top").show(ui, |ui| top::show(app, ui));
    if !app.messages.is_empty() {
        Panel::bottom("messages").show(ui, |ui| app.messages.show(ui));
    }
    let has_timeline = |app: &App| {
        let stage = app.stage.as_ref();
        stage.is_some_and(|s| !s.scene().timeline.is_empty())
    };
    if has_timeline(app) {
        Panel::bottom("timeline").show(ui, |ui| scene::timeline(app, ui));
    }
    if ui.available_width() < NARROW {
        if app.panels.left || app.panels.right {
            let height = 0.45 * ui.available_height();
            Panel::bottom("column")
                .resizable(true)
                .default_size(height)
                .show(ui, |ui| {
                    scrolled(ui, |ui| {
                        if app.panels.left {
                            controls(app, ui);
                        }
                        if app.panels.right {
                            results(app, ui);
                        }
                    });
                });
        }
    } else {
        if app.panels.left {
            Panel::left("controls")
                .resizable(true)
                .default_size(300.0)
                .show(ui, |ui| scrolled(ui, |ui| controls(app, ui)));
        }
        if app.panels.right {
            Panel::right("results")
                .resizable(true)
                .default_size(340.0)
                .show(ui, |ui| scrolled(ui, |ui| results(app, ui)));
        }
    }
    CentralPanel::default()
        .frame(Frame::NONE)
        .show(ui, |ui| app.show_viewport(ui, egui));
    top::help(app, ui);
}

fn scrolled(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().auto_shrink(false).show(ui, add);
}

/// What is chosen.
fn controls(app: &mut App, ui: &mut Ui) {
    section(ui, "Method", true, |ui| methods::show(app, ui));
    section(ui, "Compare", true, |ui| methods::compare(app, ui));
    section(ui, "Camera", true, |ui| scene::camera(app, ui));
    section(ui, "Layers", false, |ui| scene::layers(app, ui));
    section(ui, "Objects", false, |ui| scene::objects(app, ui));
    section(ui, "Lights", false, |ui| scene::lights(app, ui));
    section(ui, "Save", false, |ui| output::show(app, ui));
}

/// What is measured.
fn results(app: &mut App, ui: &mut Ui) {
    section(ui, "Error of this view", true, |ui| numbers::show(app, ui));
    section(ui, "Time and memory", true, |ui| numbers::passes(app, ui));
    section(ui, "Pixel", true, |ui| pixel::show(app, ui));
    section(ui, "Error against time", true, |ui| front::show(app, ui));
}

fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong())
        .default_open(open)
        .show(ui, add);
}

/// A number with as many digits as are worth reading.
pub(crate) fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 1.0 => format!("{x:.2}"),
        a if a >= 0.001 => format!("{x:.4}"),
        _ => format!("{x:.1e}"),
    }
}
