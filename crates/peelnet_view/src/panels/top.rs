//! The bar on top: what is open, and how the window looks.

use crate::{app::App, input::KEYS};
use egui::{Ui, Window};
use peelnet_scene::suite;
use std::path::{Path, PathBuf};

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        ui.menu_button("Open", |ui| open(app, ui));
        let name = app.stage.as_ref().map(|s| s.source.name());
        ui.label(name.unwrap_or_else(|| "no scene".into()));
        ui.separator();
        ui.toggle_value(&mut app.panels.left, "Controls");
        ui.toggle_value(&mut app.panels.right, "Results");
        ui.separator();
        ui.menu_button("Look", look);
        ui.toggle_value(&mut app.panels.help, "Keys");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.weak(super::printable(&app.gpu.info.name));
        });
    });
}

fn open(app: &mut App, ui: &mut Ui) {
    let mut chosen: Option<PathBuf> = None;
    #[cfg(target_arch = "wasm32")]
    crate::web::choose_files(ui);
    if !cfg!(target_arch = "wasm32") {
        path(app, ui, &mut chosen);
    }
    if !app.recent.is_empty() {
        ui.menu_button("Recent", |ui| {
            for path in &app.recent {
                if ui.button(peelnet_core::files::shown(path)).clicked() {
                    chosen = Some(path.clone());
                }
            }
        });
    }
    ui.separator();
    ui.label("Scenes that ship");
    let scenes = egui::ScrollArea::vertical().max_height(320.0);
    scenes.show(ui, |ui| {
        for file in suite::SCENES.iter().chain(suite::EFFECTS) {
            let stem = Path::new(file.path).file_stem();
            let stem = stem.and_then(|s| s.to_str()).unwrap_or_default();
            if ui.button(stem).clicked() {
                chosen = Some(stem.into());
            }
        }
    });
    if let Some(path) = chosen {
        #[cfg(target_arch = "wasm32")]
        app.open(app.kept_or_named(path), None);
        #[cfg(not(target_arch = "wasm32"))]
        match path.is_dir() {
            true => app.open_dataset(&path),
            false => app.open(crate::stage::Source::named(path), None),
        }
        ui.close();
    }
}

fn path(app: &mut App, ui: &mut Ui, chosen: &mut Option<PathBuf>) {
    let path = ui.label("File, or drop it onto the window");
    ui.horizontal(|ui| {
        let hint = "scene.toml, mesh.glb, mesh.obj, dataset";
        let edit = egui::TextEdit::singleline(&mut app.panels.path).hint_text(hint);
        let edit = ui.add(edit).labelled_by(path.id);
        let entered = edit.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        if (ui.button("Open file").clicked() || entered) && !app.panels.path.is_empty() {
            *chosen = Some(app.panels.path.clone().into());
        }
    });
}

fn look(ui: &mut Ui) {
    egui::widgets::global_theme_preference_buttons(ui);
    ui.separator();
    egui::gui_zoom::zoom_menu_buttons(ui);
}

pub(super) fn help(app: &mut App, ui: &Ui) {
    let window = Window::new("Keys").open(&mut app.panels.help);
    window.resizable(false).show(ui.ctx(), |ui| {
        egui::Grid::new("keys").striped(true).show(ui, |ui| {
            for (key, what) in KEYS {
                ui.strong(key);
                ui.label(what);
                ui.end_row();
            }
        });
    });
}
