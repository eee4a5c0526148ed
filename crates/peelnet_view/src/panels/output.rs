//! Pictures, frames, shader text and the command of this view.

use super::{button, error};
use crate::app::App;
use egui::{DragValue, Ui};
use peelnet_export::Language;

const PICTURE: &str = "This view by this method, as peelnet render writes it";
const SCENE: &str =
    "A new scene file with this camera and all changes, beside the one that is open";
pub(super) const NETWORK: &str =
    "The network that is drawn, as .safetensors and as .wgsl, in new files beside the scene";
const FRAMES: &str = "Numbered PNG files in a new folder";

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(command) = app.command() else { return };
    ui.horizontal_wrapped(|ui| {
        if ui.button("Copy command").clicked() {
            ui.ctx().copy_text(command.clone());
        }
        ui.monospace(&command);
    });
    if app.output.job.is_busy() {
        let (done, all) = app.output.progress.get();
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("{done} of {all}"));
            if ui.button("Stop writing").clicked() {
                app.output.job.cancel();
            }
        });
    } else {
        ui.horizontal_wrapped(|ui| {
            for (name, ending) in [("Save PNG", ".png"), ("Save EXR", ".exr")] {
                if button(ui, name, PICTURE) {
                    app.save_picture(ending);
                }
            }
            if button(ui, "Save scene", SCENE) {
                app.save_scene();
            }
        });
        ui.horizontal_wrapped(|ui| films(app, ui));
    }
    if app.first.spec.needs_model() {
        if button(ui, "Export network", NETWORK) {
            app.export_network();
        }
        ui.horizontal_wrapped(|ui| {
            ui.label("Shader text:");
            for language in Language::ALL {
                if ui.button(format!("Copy {}", language.name())).clicked() {
                    app.copy_shader(ui.ctx(), language);
                }
            }
        });
    }
    said(app, ui);
}

/// What was saved, or why not.
pub(super) fn said(app: &App, ui: &mut Ui) {
    match app.output.last() {
        Some(Ok(text)) => drop(ui.label(text)),
        Some(Err(e)) => error(ui, e),
        None => {}
    }
}

fn films(app: &mut App, ui: &mut Ui) {
    let label = ui.label("Frames");
    let drag = DragValue::new(&mut app.panels.frames).range(2..=10_000);
    ui.add(drag).labelled_by(label.id);
    let has_timeline = app.stage.as_ref().is_some_and(|s| s.times().is_some());
    for (name, timeline) in [("Save turntable", false), ("Save timeline", true)] {
        if (has_timeline || !timeline) && button(ui, name, FRAMES) {
            app.save_frames(timeline, app.panels.frames);
        }
    }
}
