//! The scene: cameras, layers, objects, lights, effects and time.

use crate::{app::App, stage::Shown};
use egui::{ComboBox, DragValue, Grid, Slider, Ui};
use glam::{EulerRot, Mat4, Quat, Vec3};
use peelnet_render::{LayerFormula, LayerView};
use peelnet_scene::{Census, Effect, Light, Lighting, Material, Source};

pub(super) fn camera(app: &mut App, ui: &mut Ui) {
    let Some(views) = app.stage.as_ref().map(|s| s.scene().views.len()) else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        for number in 0..views {
            let is_own = app.view == Some(number);
            let name = format!("View {number}");
            if ui.selectable_label(is_own, name).clicked() {
                app.show_view(number);
            }
        }
    });
    ui.horizontal(|ui| {
        if ui.button("See everything").clicked() {
            app.fit();
        }
        ui.checkbox(&mut app.motion.turns, "Turntable");
    });
    let mut degrees = app.camera.fov_y_degrees;
    let slider = Slider::new(&mut degrees, 5.0..=120.0).suffix("°");
    if ui.add(slider.text("Field of view")).changed() {
        app.move_eye(|camera, _| camera.fov_y_degrees = degrees);
    }
}

pub(super) fn layers(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    let layers = stage.scene().layers();
    if layers.is_empty() {
        ui.weak("No object of this scene has a layer (layer = N in the scene file, 0 outermost).");
        return;
    }
    let before = stage.shown().clone();
    let mut shown = before.clone();
    ui.horizontal_wrapped(|ui| {
        ui.radio_value(&mut shown.layers, None, "None");
        for layer in layers {
            let is_own = shown.layers.is_some_and(|v| v.highlight == layer);
            if ui.radio(is_own, format!("Layer {layer}")).clicked() {
                let view = shown.layers.unwrap_or(LayerView {
                    highlight: layer,
                    increasing: false,
                    formula: LayerFormula::Front,
                });
                shown.layers = Some(LayerView {
                    highlight: layer,
                    ..view
                });
            }
        }
    });
    if let Some(view) = &mut shown.layers {
        ui.checkbox(&mut view.increasing, "Increasing layers only")
            .on_hover_text(
                "Leaves out surfaces whose layer is not deeper than the one in front of them",
            );
        ui.radio_value(
            &mut view.formula,
            LayerFormula::Front,
            "Only what lies in front of the highlighted one",
        );
        ui.radio_value(
            &mut view.formula,
            LayerFormula::Printed,
            "All fragments, as the formula is printed (Adamopoulos 2018)",
        );
        let mut selective = !shown.shade_all;
        if ui
            .checkbox(&mut selective, "Shade the highlighted layer alone")
            .changed()
        {
            shown.shade_all = !selective;
        }
        if let Some(ms) = app.first.gpu_ms() {
            ui.monospace(format!("{ms:.3} ms on the GPU"));
        }
    }
    set(app, before, shown);
}

/// Draws something else of the scene, where it is something else.
fn set(app: &mut App, before: Shown, shown: Shown) {
    if shown != before {
        app.edit(|stage| stage.set_shown(shown));
    }
}

/// Everything that a renderer does only where the scene needs it, with why, and a switch.
fn effects(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    let census = Census::of(stage.scene());
    let before = stage.shown().clone();
    let mut shown = before.clone();
    for effect in Effect::ALL {
        let Some(called) = census.effects.iter().find(|e| e.name == effect.name()) else {
            continue;
        };
        if !called.on {
            continue;
        }
        let mut on = !shown.off.contains(&effect);
        let why: Vec<String> = called.why.iter().take(8).cloned().collect();
        let why = peelnet_files::printable(&why.join(", ")).to_string();
        let about = format!("Needed by: {why}. Adds {}.", called.adds);
        if ui
            .checkbox(&mut on, effect.name())
            .on_hover_text(about)
            .changed()
        {
            shown.off.retain(|e| *e != effect);
            if !on {
                shown.off.push(effect);
            }
        }
    }
    set(app, before, shown);
}

pub(super) fn objects(app: &mut App, ui: &mut Ui) {
    ui.collapsing("Effects of this scene", |ui| effects(app, ui));
    let stage = app.stage.as_ref();
    let Some(stage) = stage.filter(|s| !s.scene().objects.is_empty()) else {
        return;
    };
    let all = &stage.scene().objects;
    let number = app.panels.object.min(all.len() - 1);
    let shown = |k: usize| {
        let name = peelnet_files::printable(&all[k].name).to_string();
        format!("{k} {name}")
    };
    let mut chosen = number;
    ComboBox::from_label("Object")
        .selected_text(shown(number))
        .show_ui(ui, |ui| {
            for k in 0..all.len() {
                ui.selectable_value(&mut chosen, k, shown(k));
            }
        });
    let object = all[number].clone();
    let loaded = stage.loaded().objects.get(number).cloned();
    app.panels.object = chosen;
    if let Some(moved) = transform(ui, object.world_from_object) {
        app.edit(|stage| stage.set_transform(number, moved));
    }
    for (part, material) in object.materials.iter().enumerate() {
        let name = peelnet_files::printable(&material.name).to_string();
        let title = if name.is_empty() {
            format!("Material {part}")
        } else {
            format!("Material {part}: {name}")
        };
        let original = loaded.as_ref().and_then(|o| o.materials.get(part));
        ui.collapsing(title, |ui| {
            if let Some(changed) = material_of(ui, material, original) {
                app.edit(|stage| stage.set_material(number, part, changed));
            }
        });
    }
    if ui.button("Take all changes back").clicked() {
        app.edit(|stage| stage.reset());
    }
}

/// Three numbers in a row; whether one changed.
fn vector(ui: &mut Ui, name: &str, x: &mut Vec3, speed: f32) -> bool {
    let label = ui.label(name);
    let mut changed = false;
    ui.horizontal(|ui| {
        for k in 0..3 {
            let drag = DragValue::new(&mut x[k]).speed(speed).max_decimals(3);
            changed |= ui.add(drag).labelled_by(label.id).changed();
        }
    });
    ui.end_row();
    changed
}

fn transform(ui: &mut Ui, matrix: Mat4) -> Option<Mat4> {
    let (mut scale, rotation, mut place) = matrix.to_scale_rotation_translation();
    let (x, y, z) = rotation.to_euler(EulerRot::XYZ);
    let mut degrees = Vec3::new(x, y, z) * (180.0 / std::f32::consts::PI);
    let mut changed = false;
    Grid::new("transform").show(ui, |ui| {
        changed |= vector(ui, "place", &mut place, 0.01);
        changed |= vector(ui, "turned, °", &mut degrees, 0.5);
        changed |= vector(ui, "scale", &mut scale, 0.01);
    });
    if !changed || scale.x * scale.y * scale.z == 0.0 {
        return None;
    }
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    let rotation = Quat::from_euler(EulerRot::XYZ, x, y, z);
    let moved = Mat4::from_scale_rotation_translation(scale, rotation, place);
    moved.is_finite().then_some(moved)
}

fn material_of(ui: &mut Ui, before: &Material, original: Option<&Material>) -> Option<Material> {
    let mut m = before.clone();
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        // egui's button edits linear values.
        ui.color_edit_button_rgb(&mut m.color).labelled_by(label.id);
        let label = ui.label("Emission");
        ui.color_edit_button_rgb(&mut m.emission)
            .labelled_by(label.id);
    });
    ui.add(Slider::new(&mut m.alpha, 0.0..=1.0).text("Opacity"));
    ui.horizontal(|ui| {
        for (lighting, name) in [
            (Lighting::Unlit, "Unlit"),
            (Lighting::Phong, "Phong"),
            (Lighting::Pbr, "PBR"),
        ] {
            ui.selectable_value(&mut m.lighting, lighting, name);
        }
    });
    match m.lighting {
        Lighting::Unlit => {}
        Lighting::Phong => {
            ui.add(Slider::new(&mut m.specular, 0.0..=1.0).text("Highlight"));
            let exponent = Slider::new(&mut m.shininess, 1.0..=512.0);
            ui.add(exponent.logarithmic(true).text("Exponent"));
        }
        Lighting::Pbr => {
            ui.add(Slider::new(&mut m.metallic, 0.0..=1.0).text("Metallic"));
            ui.add(Slider::new(&mut m.roughness, 0.0..=1.0).text("Roughness"));
        }
    }
    ui.checkbox(&mut m.double_sided, "Back faces");
    if let Some(original) = original {
        let maps = &original.maps;
        let rows = [
            ("Colour map", &maps.color, &mut m.maps.color),
            ("Normal map", &maps.normal, &mut m.maps.normal),
            (
                "Metallic and roughness map",
                &maps.metallic_roughness,
                &mut m.maps.metallic_roughness,
            ),
            ("Occlusion map", &maps.occlusion, &mut m.maps.occlusion),
            ("Emission map", &maps.emissive, &mut m.maps.emissive),
        ];
        for (name, original, own) in rows {
            if original.is_none() {
                continue;
            }
            let mut on = own.is_some();
            if ui.checkbox(&mut on, name).changed() {
                *own = original.clone().filter(|_| on);
            }
        }
    }
    (m != *before).then_some(m)
}

pub(super) fn lights(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else {
        return;
    };
    let before = stage.scene().lights.clone();
    let all = stage.all;
    let mut lights = before.clone();
    let mut gone = None;
    for (k, light) in lights.iter_mut().enumerate() {
        ui.push_id(k, |ui| {
            ui.horizontal(|ui| {
                ui.strong(format!("Light {k}"));
                let label = ui.label("Colour");
                ui.color_edit_button_rgb(&mut light.color)
                    .labelled_by(label.id);
                if ui.button("Remove light").clicked() {
                    gone = Some(k);
                }
            });
            Grid::new("light").show(ui, |ui| {
                let label = ui.label("intensity");
                let drag = DragValue::new(&mut light.intensity)
                    .range(0.0..=1e6)
                    .speed(0.02);
                ui.add(drag).labelled_by(label.id);
                ui.end_row();
                match &mut light.source {
                    Source::Point(place) => {
                        vector(ui, "place", place, 0.01 * all.radius);
                    }
                    Source::Toward(direction) => {
                        let mut toward = *direction;
                        if vector(ui, "from", &mut toward, 0.01) {
                            *direction = toward.normalize_or(*direction);
                        }
                    }
                }
            });
        });
    }
    if let Some(k) = gone {
        lights.remove(k);
    }
    ui.horizontal(|ui| {
        let new = |source| Light {
            source,
            color: [1.0; 3],
            intensity: 1.0,
        };
        if ui.button("Add a point light").clicked() {
            let place = all.middle + all.radius * Vec3::ONE;
            lights.push(new(Source::Point(place)));
        }
        if ui.button("Add a sun").clicked() {
            lights.push(new(Source::Toward(Vec3::ONE.normalize())));
        }
    });
    if lights != before {
        app.edit(|stage| stage.set_lights(lights));
    }
}

pub(super) fn timeline(app: &mut App, ui: &mut Ui) {
    let Some(scene) = app.stage.as_ref().map(|s| s.scene()) else {
        return;
    };
    let (Some(from), Some(to)) = (scene.timeline.first(), scene.timeline.last()) else {
        return;
    };
    let (range, mut time) = (from.time..=to.time, scene.time);
    let states = scene.timeline.iter().rev();
    let state = states.into_iter().find(|s| s.time <= scene.time);
    let label = state.map_or_else(String::new, |s| {
        peelnet_files::printable(&s.label).to_string()
    });
    let stops: Vec<(f32, String)> = scene
        .timeline
        .iter()
        .map(|s| (s.time, peelnet_files::printable(&s.label).to_string()))
        .collect();
    ui.horizontal(|ui| {
        let name = if app.motion.plays { "Pause" } else { "Play" };
        if ui.button(name).clicked() {
            app.motion.plays = !app.motion.plays;
        }
        ui.spacing_mut().slider_width = (ui.available_width() - 260.0).max(80.0);
        let moved = ui.add(Slider::new(&mut time, range).text("Time"));
        ui.label(label);
        if moved.changed() {
            app.motion.plays = false;
            app.edit(|stage| stage.set_time(time));
        }
    });
    ui.horizontal_wrapped(|ui| {
        for (time, label) in stops {
            if ui.small_button(&label).clicked() {
                app.edit(|stage| stage.set_time(time));
            }
        }
    });
}
