//! Everything around the picture.

#[cfg(not(target_arch = "wasm32"))]
mod dataset;
mod front;
pub(crate) mod methods;
mod numbers;
mod output;
mod pixel;
mod scene;
pub(crate) mod state;
mod top;
#[cfg(not(target_arch = "wasm32"))]
mod training;

use crate::app::App;
#[cfg(target_arch = "wasm32")]
use crate::web::training;
use eframe::egui_wgpu::RenderState;
use egui::{CentralPanel, Panel, ScrollArea, Ui};

/// Windows narrower than this have one column below the picture instead of two beside it, points.
const NARROW: f32 = 760.0;

impl App {
    pub(crate) fn show_panels(&mut self, ui: &mut Ui, egui: &RenderState) {
        self.panels.bare ^= ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Tab));
        if self.panels.bare {
            CentralPanel::no_frame().show(ui, |ui| self.show_viewport(ui, egui));
            return;
        }
        Panel::top("top").show(ui, |ui| top::show(self, ui));
        if !self.messages.0.is_empty() {
            Panel::bottom("messages").show(ui, |ui| self.messages.show(ui));
        }
        if self.stage.as_ref().is_some_and(|s| s.times().is_some()) {
            Panel::bottom("timeline").show(ui, |ui| scene::timeline(self, ui));
        }
        let (left, right) = (self.panels.left, self.panels.right);
        if ui.available_width() < NARROW {
            if left || right {
                let height = 0.45 * ui.available_height();
                column(Panel::bottom("column"), height, ui, |ui| {
                    if left {
                        controls(self, ui);
                    }
                    if right {
                        results(self, ui);
                    }
                });
            }
        } else {
            if left {
                column(Panel::left("controls"), 300.0, ui, |ui| controls(self, ui));
            }
            if right {
                column(Panel::right("results"), 340.0, ui, |ui| results(self, ui));
            }
        }
        CentralPanel::no_frame().show(ui, |ui| self.show_viewport(ui, egui));
        top::help(self, ui);
    }
}

fn column(panel: Panel, size: f32, ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    panel.resizable(true).default_size(size).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, add);
    });
}

type Section = (&'static str, bool, fn(&mut App, &mut Ui));

fn controls(app: &mut App, ui: &mut Ui) {
    let all: [Section; 8] = [
        ("Method", true, methods::show),
        ("Training", app.awaits_training(), training::show),
        ("Compare", true, methods::compare),
        ("Camera", true, scene::camera),
        ("Layers", false, scene::layers),
        ("Objects", false, scene::objects),
        ("Lights", false, scene::lights),
        ("Save", false, output::show),
    ];
    sections(&all, app, ui);
}

fn results(app: &mut App, ui: &mut Ui) {
    #[cfg(not(target_arch = "wasm32"))]
    if app.dataset.is_some() {
        sections(&[("Dataset", true, dataset::show)], app, ui);
    }
    let all: [Section; 4] = [
        ("Error of this view", true, numbers::show),
        ("Time and memory", true, numbers::passes),
        ("Pixel", true, pixel::show),
        ("Error against time", true, front::show),
    ];
    sections(&all, app, ui);
}

fn sections(all: &[Section], app: &mut App, ui: &mut Ui) {
    for (title, open, add) in all {
        egui::CollapsingHeader::new(egui::RichText::new(*title).strong())
            .default_open(*open)
            .show(ui, |ui| add(app, ui));
    }
}

/// A button that says what it does; whether it was clicked.
fn button(ui: &mut Ui, name: &str, about: &str) -> bool {
    ui.button(name).on_hover_text(about).clicked()
}

fn error(ui: &mut Ui, text: &str) {
    ui.colored_label(ui.visuals().error_fg_color, text);
}

/// Text of a file, safe to show.
fn printable(text: &str) -> String {
    peelnet_core::files::printable(text).into_owned()
}

/// A number with as many digits as are worth reading.
fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 1.0 => format!("{x:.2}"),
        a if a >= 0.001 => format!("{x:.4}"),
        _ => format!("{x:.1e}"),
    }
}
