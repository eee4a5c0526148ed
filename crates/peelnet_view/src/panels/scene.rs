//! The scene: cameras, layers, objects, lights, effects and time.

use super::printable;
use crate::{app::App, stage::Shown};
use egui::{ComboBox, DragValue, Grid, Slider, Ui};
use glam::{EulerRot, Mat4, Quat, Vec3};
use peelnet_render::{LayerFormula, LayerView};
use peelnet_scene::{
    Control, EFFECTS, Light, Lighting, Material, NUMBERS, Number, SceneFeatures, Source,
};

const INCREASING: &str =
    "Leaves out surfaces whose layer is not deeper than the one in front of them";

pub(super) fn camera(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else { return };
    let views = stage.scene.views.len();
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
        ui.checkbox(&mut app.panels.turns, "Turntable");
    });
    let mut degrees = app.camera.fov_y_degrees;
    let slider = Slider::new(&mut degrees, 5.0..=120.0).suffix("°");
    if ui.add(slider.text("Field of view")).changed() {
        app.move_eye(|camera, _| camera.fov_y_degrees = degrees);
    }
}

pub(super) fn layers(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else { return };
    let layers = stage.scene.layers();
    if layers.is_empty() {
        ui.weak("No object of this scene has a layer (layer = N in the scene file, 0 outermost).");
        return;
    }
    let mut shown = stage.shown.clone();
    ui.horizontal_wrapped(|ui| {
        ui.radio_value(&mut shown.layers, None, "None");
        for layer in layers {
            let is_own = shown.layers.is_some_and(|v| v.highlight == layer);
            if ui.radio(is_own, format!("Layer {layer}")).clicked() {
                let view = shown.layers.get_or_insert(LayerView {
                    highlight: layer,
                    increasing: false,
                    formula: LayerFormula::Front,
                });
                view.highlight = layer;
            }
        }
    });
    if let Some(view) = &mut shown.layers {
        ui.checkbox(&mut view.increasing, "Increasing layers only")
            .on_hover_text(INCREASING);
        let front = "Only what lies in front of the highlighted one";
        ui.radio_value(&mut view.formula, LayerFormula::Front, front);
        let printed = "All fragments, as the formula is printed (Adamopoulos 2018)";
        ui.radio_value(&mut view.formula, LayerFormula::Printed, printed);
        let mut selective = !shown.shade_all;
        ui.checkbox(&mut selective, "Shade the highlighted layer alone");
        shown.shade_all = !selective;
        if let Some(ms) = app.first.gpu_ms() {
            ui.monospace(format!("{ms:.3} ms on the GPU"));
        }
    }
    set(app, shown);
}

/// Draws something else of the scene, where it is something else.
fn set(app: &mut App, shown: Shown) {
    if (app.stage.as_ref()).is_some_and(|stage| stage.shown != shown) {
        app.edit(|stage| stage.set_shown(shown));
    }
}

/// Everything that a renderer does only where the scene needs it, with why, and a switch.
fn effects(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else { return };
    let features = SceneFeatures::new(&stage.scene);
    let mut shown = stage.shown.clone();
    for (effect, feature) in EFFECTS.iter().zip(&features.effects) {
        if !feature.on {
            continue;
        }
        let mut on = !shown.off.contains(&effect.name);
        let why: Vec<&str> = feature.why.iter().take(8).map(String::as_str).collect();
        let why = printable(&why.join(", "));
        let about = format!("Needed by: {why}. Adds {}.", feature.adds);
        let check = ui.checkbox(&mut on, effect.name).on_hover_text(about);
        if check.changed() {
            shown.off.retain(|e| *e != effect.name);
            shown.off.extend((!on).then_some(effect.name));
        }
    }
    set(app, shown);
}

pub(super) fn objects(app: &mut App, ui: &mut Ui) {
    ui.collapsing("Effects of this scene", |ui| effects(app, ui));
    let Some(stage) = &app.stage else { return };
    let all = &stage.scene.objects;
    let number = app.panels.object.min(all.len().saturating_sub(1));
    let Some(object) = all.get(number).cloned() else {
        return;
    };
    let loaded = stage.loaded.objects.get(number).cloned();
    let name = |k: usize| format!("{k} {}", printable(&all[k].name));
    app.panels.object = number;
    let list = ComboBox::from_label("Object");
    list.show_index(ui, &mut app.panels.object, all.len(), name);
    if let Some(moved) = transform(ui, object.world_from_object) {
        app.edit(|stage| stage.set_transform(number, moved));
    }
    for (part, material) in object.materials.iter().enumerate() {
        let title = match printable(&material.name) {
            name if name.is_empty() => format!("Material {part}"),
            name => format!("Material {part}: {name}"),
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
    let mut degrees = Vec3::from([x, y, z].map(f32::to_degrees));
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

/// A colour with its name beside it; egui's button edits linear values.
fn color(ui: &mut Ui, name: &str, color: &mut [f32; 3]) {
    let label = ui.label(name);
    ui.color_edit_button_rgb(color).labelled_by(label.id);
}

/// The numbers that can be changed.
fn controls() -> impl Iterator<Item = (&'static Number, &'static Control)> {
    let with_control = |number: &'static Number| Some((number, number.control.as_ref()?));
    NUMBERS.iter().filter_map(with_control)
}

fn material_of(ui: &mut Ui, before: &Material, original: Option<&Material>) -> Option<Material> {
    let mut m = before.clone();
    let (always, of_model): (Vec<_>, Vec<_>) = controls().partition(|(_, c)| c.models.len() == 3);
    let (colors, sliders): (Vec<_>, Vec<_>) = always.into_iter().partition(|(n, _)| n.length == 3);
    ui.horizontal(|ui| {
        for (number, control) in colors {
            if let [r, g, b] = (number.values_mut)(&mut m) {
                let mut rgb = [*r, *g, *b];
                color(ui, control.label, &mut rgb);
                [*r, *g, *b] = rgb;
            }
        }
    });
    let show = |ui: &mut Ui, m: &mut Material, (number, control): (&Number, &Control)| {
        let [low, high] = control.range;
        for x in (number.values_mut)(m) {
            let slider = Slider::new(x, low..=high).logarithmic(control.logarithmic);
            ui.add(slider.text(control.label));
        }
    };
    for slider in sliders {
        show(ui, &mut m, slider);
    }
    ui.horizontal(|ui| {
        for (lighting, name) in [
            (Lighting::Unlit, "Unlit"),
            (Lighting::Phong, "Phong"),
            (Lighting::Pbr, "PBR"),
        ] {
            ui.selectable_value(&mut m.lighting, lighting, name);
        }
    });
    for control in of_model {
        if control.1.models.contains(&m.lighting) {
            show(ui, &mut m, control);
        }
    }
    ui.checkbox(&mut m.double_sided, "Back faces");
    if let Some(original) = original {
        let (from, to) = (&original.maps, &mut m.maps);
        for (name, original, own) in [
            ("Colour map", &from.color, &mut to.color),
            ("Normal map", &from.normal, &mut to.normal),
            (
                "Metallic and roughness map",
                &from.metallic_roughness,
                &mut to.metallic_roughness,
            ),
            ("Occlusion map", &from.occlusion, &mut to.occlusion),
            ("Emission map", &from.emissive, &mut to.emissive),
        ] {
            let mut on = own.is_some();
            if original.is_some() && ui.checkbox(&mut on, name).changed() {
                *own = original.clone().filter(|_| on);
            }
        }
    }
    (m != *before).then_some(m)
}

pub(super) fn lights(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else { return };
    let all = stage.all;
    let mut lights = stage.scene.lights.clone();
    let mut gone = None;
    for (k, light) in lights.iter_mut().enumerate() {
        ui.push_id(k, |ui| {
            ui.horizontal(|ui| {
                ui.strong(format!("Light {k}"));
                color(ui, "Colour", &mut light.color);
                if ui.button("Remove light").clicked() {
                    gone = Some(k);
                }
            });
            Grid::new("light").show(ui, |ui| {
                let label = ui.label("intensity");
                let drag = DragValue::new(&mut light.intensity).range(0.0..=1e6);
                ui.add(drag.speed(0.02)).labelled_by(label.id);
                ui.end_row();
                match &mut light.source {
                    Source::Point(place) => drop(vector(ui, "place", place, 0.01 * all.radius)),
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
        let point = Source::Point(all.middle + all.radius * Vec3::ONE);
        let sun = Source::Toward(Vec3::ONE.normalize());
        for (name, source) in [("Add a point light", point), ("Add a sun", sun)] {
            if ui.button(name).clicked() {
                lights.push(Light {
                    source,
                    color: [1.0; 3],
                    intensity: 1.0,
                });
            }
        }
    });
    if lights != stage.scene.lights {
        app.edit(|stage| stage.set_lights(lights));
    }
}

pub(super) fn timeline(app: &mut App, ui: &mut Ui) {
    let Some(stage) = &app.stage else { return };
    let Some((from, to)) = stage.times() else {
        return;
    };
    let states = stage.scene.timeline.iter();
    let stops: Vec<(f32, String)> = states.map(|s| (s.time, printable(&s.label))).collect();
    let mut time = stage.scene.time;
    let state = stops.iter().rev().find(|(at, _)| *at <= time);
    let mut chosen = None;
    ui.horizontal(|ui| {
        let name = if app.panels.plays { "Pause" } else { "Play" };
        app.panels.plays ^= ui.button(name).clicked();
        ui.spacing_mut().slider_width = (ui.available_width() - 260.0).max(80.0);
        let slider = Slider::new(&mut time, from..=to).text("Time");
        if ui.add(slider).changed() {
            app.panels.plays = false;
            chosen = Some(time);
        }
        ui.label(state.map_or("", |(_, label)| label));
    });
    ui.horizontal_wrapped(|ui| {
        for (time, label) in &stops {
            if ui.small_button(label).clicked() {
                chosen = Some(*time);
            }
        }
    });
    if let Some(time) = chosen {
        app.edit(|stage| stage.set_time(time));
    }
}
