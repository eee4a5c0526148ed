//! Choosing methods, and their parameters: all from the methods' own declarations.

use super::error;
use crate::{
    app::App,
    compare::{MODES, Mode},
    slot::Slot,
    stage::Source,
};
use egui::{ComboBox, DragValue, Slider, Ui};
use peelnet_render::{
    METHODS, Method, MethodSpec,
    methods::{Numbered, Parameter, Precision, Values},
};
use std::ops::RangeInclusive;

pub(crate) fn offered() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().filter(|m| m.cpu_only.is_none())
}

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    if (app.stage.as_ref()).is_some_and(|s| s.shown.layers.is_some()) {
        ui.label("Layers are shown: methods draw the scene again once no layer is highlighted.");
    }
    choose(ui, "Draw with", "first", &mut app.first);
    if app.first.spec.needs_model() {
        network(app, ui);
    }
    if let Some(failure) = &app.first.failure {
        error(ui, failure);
    }
}

pub(super) fn compare(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        for (mode, _, name, about) in MODES {
            ui.selectable_value(&mut app.compare.mode, mode, name)
                .on_hover_text(about);
        }
    });
    if !app.compare.mode.needs_second() {
        return;
    }
    choose(ui, "Against", "second", &mut app.second);
    if app.compare.mode == Mode::Split {
        ui.add(Slider::new(&mut app.compare.divider, 0.0..=1.0).text("Divider"));
    }
    if app.compare.mode == Mode::Error {
        let slider = Slider::new(&mut app.compare.scale, 1.0..=255.0);
        ui.add(slider.logarithmic(true).text("Map ends at, of 255"));
    }
}

fn choose(ui: &mut Ui, label: &str, salt: &str, slot: &mut Slot) {
    let mut spec = slot.spec.clone();
    let list = ComboBox::from_label(label).selected_text(spec.name());
    list.width(150.0).height(420.0).show_ui(ui, |ui| {
        for method in METHODS {
            if let Some(why) = method.cpu_only {
                let entry = ui.add_enabled(false, egui::Button::selectable(false, method.name));
                entry.on_disabled_hover_text(why);
                continue;
            }
            let own = spec.method();
            let is_own =
                method.name == own.name && method.numbered.is_some() == own.numbered.is_some();
            let entry = ui.selectable_label(is_own, method.name);
            if entry.on_hover_text(method.about).clicked()
                && !is_own
                && let Some(point) = MethodSpec::points(method).next()
            {
                spec = point;
            }
        }
    });
    ui.weak(spec.method().about);
    ui.push_id(salt, |ui| parameters(ui, &mut spec));
    slot.set_spec(spec);
}

/// A control for the number at the end of the name and for every parameter. What the method does not allow changes nothing: controls keep to
/// the limits, but for those that are excluded.
fn parameters(ui: &mut Ui, spec: &mut MethodSpec) {
    let grid = egui::Grid::new("parameters").num_columns(2);
    grid.show(ui, |ui| {
        if let Some(numbered) = spec.method().numbered {
            let label = ui.label("number");
            if let Some(n) = number(ui, numbered, spec.number(), label.id) {
                *spec = spec.with_number(n);
            }
            ui.end_row();
        }
        for parameter in spec.method().all_parameters() {
            let name = parameter.name;
            let label = ui.label(name).on_hover_text(parameter.about);
            match control(ui, parameter, spec, label.id) {
                Some(Some(value)) => {
                    if let Ok(changed) = spec.with(name, &value) {
                        *spec = changed;
                    }
                }
                Some(None) => *spec = spec.without(name),
                None => {}
            }
            ui.end_row();
        }
    });
}

/// The number at the end of the name, where it was changed.
fn number(ui: &mut Ui, numbered: Numbered, now: u32, label: egui::Id) -> Option<u32> {
    let all = numbered.least..=numbered.most;
    if !numbered.power_of_two {
        return drag(ui, now, all, 1.0, label);
    }
    let powers = (0..32).map(|k| 1u32 << k).filter(|n| all.contains(n));
    let powers = powers.map(|n| n.to_string());
    chosen(ui, "number", &now.to_string(), powers, label)?
        .parse()
        .ok()
}

fn drag<N: egui::emath::Numeric>(
    ui: &mut Ui,
    mut number: N,
    limits: RangeInclusive<N>,
    speed: f64,
    label: egui::Id,
) -> Option<N> {
    let drag = DragValue::new(&mut number).range(limits).speed(speed);
    let drag = ui.add(drag).labelled_by(label);
    drag.changed().then_some(number)
}

/// The control of a parameter; its new value where that was changed, `Some(None)` for the default.
fn control(
    ui: &mut Ui,
    parameter: &Parameter,
    spec: &MethodSpec,
    label: egui::Id,
) -> Option<Option<String>> {
    match parameter.values {
        Values::Number { most, .. } => {
            let x = parameter.number(spec);
            // As fast as the number is large.
            let speed = (x.abs() * 0.01).max(1e-3);
            drag(ui, x, 0.0..=most, speed, label).map(|x| Some(x.to_string()))
        }
        Values::Whole {
            default,
            least,
            most,
        } => {
            let count = parameter.count(spec);
            let (mut is_given, n) = (count.is_some(), count.unwrap_or(least));
            let number = |ui: &mut Ui| {
                let changed = drag(ui, n, least..=most, 1.0, label);
                changed.map(|n| Some(n.to_string()))
            };
            if default.is_some() {
                return number(ui);
            }
            let row = ui.horizontal(|ui| {
                let check = ui.checkbox(&mut is_given, "limit");
                let dragged = count.and_then(|_| number(ui));
                let checked = check.on_hover_text(parameter.about).changed();
                dragged.or_else(|| checked.then(|| is_given.then(|| n.to_string())))
            });
            row.inner
        }
        Values::Words(words) => {
            let words = words.iter().map(|word| word.to_string());
            chosen(ui, parameter.name, parameter.word(spec), words, label).map(Some)
        }
        Values::Precision => {
            const OWN: &str = "its own";
            let now = Some(parameter.word(spec)).filter(|word| !word.is_empty());
            let words = [OWN].into_iter().chain(Precision::WORDS);
            let words = words.map(str::to_owned);
            let word = chosen(ui, parameter.name, now.unwrap_or(OWN), words, label);
            word.map(|word| (word != OWN).then_some(word))
        }
    }
}

/// A list of words; the one that was chosen.
fn chosen(
    ui: &mut Ui,
    salt: &str,
    now: &str,
    words: impl Iterator<Item = String>,
    label: egui::Id,
) -> Option<String> {
    let mut words: Vec<String> = words.collect();
    let before = words.iter().position(|word| word == now)?;
    let mut place = before;
    let list = ComboBox::from_id_salt(salt);
    let list = list.show_index(ui, &mut place, words.len(), |k| words[k].as_str());
    list.labelled_by(label);
    (place != before).then(|| words.swap_remove(place))
}

fn network(app: &mut App, ui: &mut Ui) {
    let own = app.first.own_network();
    let name = |path| peelnet_core::files::shown(path);
    let trained = || "trained here, not exported".into();
    if let Some(name) = own.map(|n| n.path.as_deref().map_or_else(trained, name)) {
        ui.horizontal_wrapped(|ui| {
            let about = "Read again whenever the file changes, as while peelnet train writes it";
            ui.label(format!("Network: {name}")).on_hover_text(about);
            if ui.button("Use the shipped one").clicked() {
                app.training.abandon();
                app.first.set_network(None);
                app.watch.follow(None);
            }
        });
    } else {
        ui.label("Network: the shipped one");
    }
    if cfg!(target_arch = "wasm32") {
        ui.weak("Drop a .safetensors file onto the page to draw with it.");
        return;
    }
    let label = ui.weak("Drop a .safetensors file, or open one:");
    ui.horizontal(|ui| {
        let edit = egui::TextEdit::singleline(&mut app.panels.model).desired_width(120.0);
        ui.add(edit).labelled_by(label.id);
        if ui.button("Open network").clicked() && !app.panels.model.is_empty() {
            app.open_network(Source::named(&app.panels.model));
        }
    });
}
