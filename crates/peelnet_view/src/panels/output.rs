//! Pictures, frames, shader text and the command of this view.

use crate::{
    app::App,
    output::{self, Sequence},
};
use egui::{DragValue, Ui};
use peelnet_export::Language;

/// Frames of a film at first.
pub(super) const FRAMES: u32 = 48;

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    let command = output::command(stage, &app.first, &app.camera, app.view);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Copy command").clicked() {
            ui.ctx().copy_text(command.clone());
        }
        ui.monospace(&command);
    });
    if app.output.is_busy() {
        let (done, all) = app.output.progress.get();
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("{done} of {all}"));
            if ui.button("Stop writing").clicked() {
                app.output.cancel();
            }
        });
    } else {
        ui.horizontal_wrapped(|ui| {
            pictures(app, ui);
            scene(app, ui);
        });
        ui.horizontal_wrapped(|ui| films(app, ui));
    }
    if app.first.spec().needs_model() {
        ui.horizontal_wrapped(|ui| {
            ui.label("Shader text:");
            for language in Language::ALL {
                shader(app, ui, language);
            }
        });
    }
    match &app.output.last {
        Some(Ok(text)) => {
            ui.label(text);
        }
        Some(Err(e)) => {
            ui.colored_label(ui.visuals().error_fg_color, e);
        }
        None => {}
    }
}

fn pictures(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    for (name, ending) in [("Save PNG", ".png"), ("Save EXR", ".exr")] {
        if ui
            .button(name)
            .on_hover_text("This view by this method, as peelnet render writes it")
            .clicked()
        {
            let path = output::free_name(stage, &app.first, ending);
            app.output
                .picture(stage, &app.first, app.camera, app.size, path);
        }
    }
}

/// The scene as a file.
fn scene(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    if ui
        .button("Save scene")
        .on_hover_text(
            "A new scene file with this camera and all changes, beside the one that is open",
        )
        .clicked()
    {
        let saved = output::scene(stage, &app.first, &app.camera);
        app.output.say(saved);
    }
}

fn films(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    let label = ui.label("Frames");
    let drag = DragValue::new(&mut app.panels.frames).range(2..=10_000);
    ui.add(drag).labelled_by(label.id);
    let mut films = vec![("Save turntable", Sequence::Turntable)];
    if !stage.scene().timeline.is_empty() {
        films.push(("Save timeline", Sequence::Timeline));
    }
    for (name, sequence) in films {
        if ui
            .button(name)
            .on_hover_text("Numbered PNG files in a new folder")
            .clicked()
        {
            let folder = output::free_name(stage, &app.first, "-frames");
            let what = (sequence, app.panels.frames);
            app.output
                .frames(stage, &app.first, app.camera, app.size, what, folder);
        }
    }
}

fn shader(app: &mut App, ui: &mut Ui, language: Language) {
    let name = format!("Copy {}", language.name());
    if !ui.button(name).clicked() {
        return;
    }
    match output::shader(&app.first, language) {
        Some(Ok(text)) => {
            let lines = text.lines().count();
            ui.ctx().copy_text(text);
            app.output.say(Ok(format!(
                "{lines} lines of {} are in the clipboard",
                language.name()
            )));
        }
        Some(Err(e)) => app.output.say(Err(e)),
        None => {}
    }
}
