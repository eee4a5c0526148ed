//! The fragments of the pixel that was clicked.

use super::{digits, error};
use crate::{app::App, inspect::Layer};
use egui::{Color32, Grid, Label, Ui};
use peelnet_core::srgb::encode8;

/// Fragments that are listed; the rest is counted.
const MOST: usize = 64;

const EXACT: &str = "Exact transmittance in front of it, the share of it that is seen";
const BELIEVED: &str =
    "What the method takes it to be; – where its weights stand for no transmittance";

const HEADS: [(&str, &str); 6] = [
    ("", "Colour"),
    ("depth", "Linear depth, scene units"),
    ("alpha", "Opacity"),
    ("T", EXACT),
    ("T method", BELIEVED),
    ("object", "Whose surface it is"),
];

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some([x, y]) = app.inspector.pixel else {
        let hint = "Click a pixel of the picture: its fragments, front to back.";
        ui.add(Label::new(hint).wrap());
        return;
    };
    ui.horizontal(|ui| {
        ui.label(format!("x {x}, y {y}"));
        if ui.button("Clear pixel").clicked() {
            app.inspector.pixel = None;
        }
    });
    match app.inspector.layers() {
        None => drop(ui.spinner()),
        Some(Err(e)) => error(ui, e),
        Some(Ok(layers)) if layers.is_empty() => drop(ui.weak("No transparent fragment.")),
        Some(Ok(layers)) => table(ui, layers),
    }
}

fn table(ui: &mut Ui, layers: &[Layer]) {
    egui::ScrollArea::horizontal().show(ui, |ui| {
        Grid::new("pixel").striped(true).show(ui, |ui| {
            for (head, about) in HEADS {
                ui.strong(head).on_hover_text(about);
            }
            ui.end_row();
            for layer in layers.iter().take(MOST) {
                let [r, g, b] = layer.fragment.color.map(encode8);
                let size = egui::vec2(14.0, 14.0);
                let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
                ui.painter()
                    .rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
                ui.monospace(digits(f64::from(layer.fragment.depth)));
                ui.monospace(format!("{:.3}", layer.fragment.alpha));
                ui.monospace(format!("{:.4}", layer.exact));
                ui.monospace(layer.believed.map_or("–".into(), |t| format!("{t:.4}")));
                ui.label(&layer.object);
                ui.end_row();
            }
        });
    });
    if layers.len() > MOST {
        ui.weak(format!("and {} more", layers.len() - MOST));
    }
}
