//! The fragments of the pixel that was clicked.

use super::digits;
use crate::{app::App, inspect::Layer};
use egui::{Color32, Grid, Ui};
use peelnet_core::srgb::encode8;

/// Fragments that are listed; the rest is counted.
const MOST: usize = 64;

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some([x, y]) = app.inspector.pixel else {
        ui.add(
            egui::Label::new("Click a pixel of the picture: its fragments, front to back.").wrap(),
        );
        return;
    };
    ui.horizontal(|ui| {
        ui.label(format!("x {x}, y {y}"));
        if ui.button("Clear pixel").clicked() {
            app.inspector.pixel = None;
        }
    });
    match app.inspector.layers() {
        None => {
            ui.spinner();
        }
        Some(Err(e)) => {
            ui.colored_label(ui.visuals().error_fg_color, e.clone());
        }
        Some(Ok(layers)) if layers.is_empty() => {
            ui.weak("No transparent fragment.");
        }
        Some(Ok(layers)) => table(ui, layers),
    }
}

fn table(ui: &mut Ui, layers: &[Layer]) {
    egui::ScrollArea::horizontal().show(ui, |ui| {
        Grid::new("pixel").striped(true).show(ui, |ui| {
            for (head, about) in [
                ("", "Colour"),
                ("depth", "Linear depth, scene units"),
                ("alpha", "Opacity"),
                ("T", "Exact transmittance in front of it, the share of it that is seen"),
                ("T method", "What the method takes it to be; – where its weights stand for no transmittance"),
                ("object", "Whose surface it is"),
            ] {
                ui.strong(head).on_hover_text(about);
            }
            ui.end_row();
            for layer in layers.iter().take(MOST) {
                let [r, g, b] = layer.fragment.color.map(encode8);
                let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
                ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
                ui.monospace(digits(f64::from(layer.fragment.depth)));
                ui.monospace(format!("{:.3}", layer.fragment.alpha));
                ui.monospace(format!("{:.4}", layer.exact));
                let believed = layer.believed.map_or_else(|| "–".into(), |t| format!("{t:.4}"));
                ui.monospace(believed);
                ui.label(&layer.object);
                ui.end_row();
            }
        });
    });
    if layers.len() > MOST {
        ui.weak(format!("and {} more", layers.len() - MOST));
    }
}
