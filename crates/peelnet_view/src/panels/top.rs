//! The bar on top: what is open, and how the window looks.

use crate::{app::App, input::KEYS};
use egui::{Ui, Window};
use peelnet_scene::suite;
use std::path::PathBuf;

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
            let adapter = peelnet_files::printable(&app.gpu.info.name).to_string();
            ui.weak(adapter);
        });
    });
}

fn open(app: &mut App, ui: &mut Ui) {
    let mut chosen: Option<PathBuf> = None;
    #[cfg(target_arch = "wasm32")]
    crate::web::choose_files(ui);
    #[cfg(not(target_arch = "wasm32"))]
    path(app, ui, &mut chosen);
    recent(app, ui, &mut chosen);
    ui.separator();
    ui.label("Scenes that ship");
    egui::ScrollArea::vertical()
        .max_height(320.0)
        .show(ui, |ui| {
            for file in suite::SCENES.iter().chain(suite::EFFECTS) {
                let name = PathBuf::from(file.path);
                let stem = name
                    .file_stem()
                    .and_then(|s| s.to_str())
                    .unwrap_or_default();
                if ui.button(stem).clicked() {
                    chosen = Some(stem.into());
                }
            }
        });
    if let Some(path) = chosen {
        #[cfg(target_arch = "wasm32")]
        let source = app.kept_or_named(path);
        #[cfg(not(target_arch = "wasm32"))]
        let source = crate::stage::Source::Named(path);
        app.open(source, None);
        ui.close();
    }
}

/// Where a path is typed.
#[cfg(not(target_arch = "wasm32"))]
fn path(app: &mut App, ui: &mut Ui, chosen: &mut Option<PathBuf>) {
    let path = ui.label("File, or drop it onto the window");
    ui.horizontal(|ui| {
        let hint = "scene.toml, mesh.glb, mesh.obj";
        let edit = egui::TextEdit::singleline(&mut app.panels.path).hint_text(hint);
        let edit = ui.add(edit).labelled_by(path.id);
        let entered = edit.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        if (ui.button("Open file").clicked() || entered) && !app.panels.path.is_empty() {
            *chosen = Some(app.panels.path.clone().into());
        }
    });
}

fn recent(app: &App, ui: &mut Ui, chosen: &mut Option<PathBuf>) {
    if !app.recent.is_empty() {
        ui.menu_button("Recent", |ui| {
            for path in &app.recent {
                let name = peelnet_files::shown(path);
                if ui.button(name).clicked() {
                    *chosen = Some(path.clone());
                }
            }
        });
    }
}

fn look(ui: &mut Ui) {
    let ctx = ui.ctx().clone();
    let mut theme = ctx.options(|o| o.theme_preference);
    for (value, name) in [
        (egui::ThemePreference::System, "As the system"),
        (egui::ThemePreference::Light, "Light"),
        (egui::ThemePreference::Dark, "Dark"),
    ] {
        if ui.radio_value(&mut theme, value, name).changed() {
            ctx.set_theme(theme);
        }
    }
    ui.separator();
    let mut percent = (ctx.zoom_factor() * 100.0).round();
    let slider = egui::Slider::new(&mut percent, 100.0..=200.0)
        .step_by(25.0)
        .suffix(" %")
        .text("Size");
    // Taken when the pointer is released: the slider itself grows with it.
    if ui.add(slider).drag_stopped() {
        ctx.set_zoom_factor(percent / 100.0);
    }
}

pub(super) fn help(app: &mut App, ui: &Ui) {
    let mut open = app.panels.help;
    Window::new("Keys")
        .open(&mut open)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            egui::Grid::new("keys").striped(true).show(ui, |ui| {
                for (key, what) in KEYS {
                    ui.strong(key);
                    ui.label(what);
                    ui.end_row();
                }
            });
        });
    app.panels.help = open;
}
