//! Choosing methods, and their parameters: all from the methods' own declarations.

use crate::{app::App, compare::Mode};
use egui::{ComboBox, DragValue, Slider, Ui};
use peelnet_render::{
    METHODS, Method, MethodSpec,
    methods::{Numbered, Parameter, Precision, Values},
};

/// Methods that a GPU draws.
pub(crate) fn offered() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().filter(|m| m.cpu_only.is_none())
}

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    if app.stage.as_ref().is_some_and(|s| s.layers().is_some()) {
        ui.label("Layers are shown: methods draw the scene again once no layer is highlighted.");
    }
    let mut spec = app.first.spec().clone();
    choose(ui, "Draw with", &mut spec);
    parameters(ui, "first", &mut spec);
    network(app, ui, &spec);
    app.first.set_spec(spec);
    if let Some(failure) = &app.first.failure {
        ui.colored_label(ui.visuals().error_fg_color, failure.clone());
    }
}

pub(super) fn compare(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        for (mode, name, about) in Mode::ALL {
            ui.selectable_value(&mut app.compare.mode, mode, name)
                .on_hover_text(about);
        }
    });
    if !app.compare.mode.needs_second() {
        return;
    }
    let mut spec = app.second.spec().clone();
    choose(ui, "Against", &mut spec);
    parameters(ui, "second", &mut spec);
    app.second.set_spec(spec);
    match app.compare.mode {
        Mode::Split => {
            ui.add(Slider::new(&mut app.compare.divider, 0.0..=1.0).text("Divider"));
        }
        Mode::Error => {
            let slider = Slider::new(&mut app.compare.scale, 1.0..=255.0);
            ui.add(slider.logarithmic(true).text("Map ends at, of 255"));
        }
        _ => {}
    }
}

fn choose(ui: &mut Ui, label: &str, spec: &mut MethodSpec) {
    ComboBox::from_label(label)
        .selected_text(spec.name())
        .width(150.0)
        .height(420.0)
        .show_ui(ui, |ui| {
            for method in METHODS {
                let is_own = method.name == spec.method().name
                    && method.numbered.is_some() == spec.method().numbered.is_some();
                if let Some(why) = method.cpu_only {
                    let entry = ui.add_enabled(false, egui::Button::selectable(false, method.name));
                    entry.on_disabled_hover_text(why);
                    continue;
                }
                let entry = ui.selectable_label(is_own, method.name);
                if entry.on_hover_text(method.about).clicked()
                    && !is_own
                    && let Some(point) = MethodSpec::points(method).next()
                {
                    *spec = point;
                }
            }
        });
    ui.weak(spec.method().about);
}

/// A control for the number at the end of the name and for every parameter.
fn parameters(ui: &mut Ui, salt: &str, spec: &mut MethodSpec) {
    egui::Grid::new(("parameters", salt))
        .num_columns(2)
        .show(ui, |ui| {
            if let Some(numbered) = spec.method().numbered {
                let label = ui.label("number");
                let number = number(ui, salt, numbered, spec.number(), label.id);
                if number != spec.number() {
                    *spec = renumbered(spec, number);
                }
                ui.end_row();
            }
            for parameter in spec.method().all_parameters() {
                let label = ui.label(parameter.name).on_hover_text(parameter.about);
                if let Some(value) = control(ui, salt, parameter, spec, label.id) {
                    *spec = changed(spec, parameter.name, value.as_deref());
                }
                ui.end_row();
            }
        });
}

fn number(ui: &mut Ui, salt: &str, numbered: Numbered, now: u32, label: egui::Id) -> u32 {
    let mut number = now;
    if numbered.power_of_two {
        ComboBox::from_id_salt(("number", salt))
            .selected_text(now.to_string())
            .show_ui(ui, |ui| {
                let powers = (0..32).map(|k| 1u32 << k);
                for n in powers.filter(|n| (numbered.least..=numbered.most).contains(n)) {
                    ui.selectable_value(&mut number, n, n.to_string());
                }
            })
            .response
            .labelled_by(label);
    } else {
        let drag = DragValue::new(&mut number).range(numbered.least..=numbered.most);
        ui.add(drag).labelled_by(label);
    }
    number
}

/// The control of a parameter; its new value where that was changed, `Some(None)` for the default.
fn control(
    ui: &mut Ui,
    salt: &str,
    parameter: &Parameter,
    spec: &MethodSpec,
    label: egui::Id,
) -> Option<Option<String>> {
    let (name, about) = (parameter.name, parameter.about);
    match parameter.values {
        Values::Number { most, .. } => {
            let mut x = parameter.number(spec);
            // As fast as the number is large.
            let speed = (x.abs() * 0.01).max(1e-3);
            let drag = DragValue::new(&mut x).range(0.0..=most).speed(speed);
            let drag = ui.add(drag).labelled_by(label).on_hover_text(about);
            drag.changed().then(|| Some(x.to_string()))
        }
        Values::Whole {
            default: Some(_),
            least,
            most,
        } => {
            let mut n = parameter.count(spec).unwrap_or(least);
            let drag = ui.add(DragValue::new(&mut n).range(least..=most));
            let drag = drag.labelled_by(label).on_hover_text(about);
            drag.changed().then(|| Some(n.to_string()))
        }
        Values::Whole {
            default: None,
            least,
            most,
        } => {
            let given = parameter.count(spec);
            let (mut is_given, mut n) = (given.is_some(), given.unwrap_or(least));
            let mut change = None;
            ui.horizontal(|ui| {
                let check = ui.checkbox(&mut is_given, "limit").on_hover_text(about);
                if check.changed() {
                    change = Some(is_given.then(|| n.to_string()));
                }
                if given.is_some() {
                    let drag = ui.add(DragValue::new(&mut n).range(least..=most));
                    if drag.labelled_by(label).changed() {
                        change = Some(Some(n.to_string()));
                    }
                }
            });
            change
        }
        Values::Words(words) => {
            let words = words.iter().map(|word| (*word, Some(*word)));
            chosen(ui, (salt, name), parameter.word(spec), words, label)
        }
        Values::Precision => {
            let now = parameter.word(spec);
            let now = if now.is_empty() { "its own" } else { now };
            let words = Precision::WORDS.map(|word| (word, Some(word)));
            let all = std::iter::once(("its own", None)).chain(words);
            chosen(ui, (salt, name), now, all, label)
        }
    }
}

/// A list of words; the value of the one that was chosen.
fn chosen<'a>(
    ui: &mut Ui,
    salt: (&str, &str),
    now: &str,
    words: impl Iterator<Item = (&'a str, Option<&'a str>)>,
    label: egui::Id,
) -> Option<Option<String>> {
    let mut change = None;
    ComboBox::from_id_salt(salt)
        .selected_text(now)
        .show_ui(ui, |ui| {
            for (word, value) in words {
                if ui.selectable_label(word == now, word).clicked() && word != now {
                    change = Some(value.map(str::to_owned));
                }
            }
        })
        .response
        .labelled_by(label);
    change
}

/// The same method with another number at its name's end.
fn renumbered(spec: &MethodSpec, number: u32) -> MethodSpec {
    let text = spec.to_string();
    let parameters = text.split_once(':').map(|(_, parameters)| parameters);
    let name = format!("{}-{number}", spec.name());
    let text = parameters.map_or_else(|| name.clone(), |p| format!("{name}:{p}"));
    // A number that the control offers is allowed, but for methods that want more of it.
    text.parse().unwrap_or_else(|_| spec.clone())
}

/// The same method with another value of a parameter, or its default.
fn changed(spec: &MethodSpec, name: &str, value: Option<&str>) -> MethodSpec {
    if let Some(value) = value {
        // Controls keep to the limits, but for those that are excluded.
        return spec.with(name, value).unwrap_or_else(|_| spec.clone());
    }
    let text = spec.to_string();
    let Some((method, parameters)) = text.split_once(':') else {
        return spec.clone();
    };
    let left = parameters.split(',');
    let left: Vec<&str> = left
        .filter(|pair| pair.split_once('=').is_none_or(|(n, _)| n != name))
        .collect();
    let text = format!("{method}:{}", left.join(","));
    text.parse().unwrap_or_else(|_| spec.clone())
}

/// Which network draws.
fn network(app: &mut App, ui: &mut Ui, spec: &MethodSpec) {
    if !spec.needs_model() {
        return;
    }
    let own = app.first.network().filter(|n| n.is_of(spec));
    let name = own.map(|n| peelnet_files::shown(&n.path));
    match name {
        Some(name) => {
            ui.horizontal_wrapped(|ui| {
                ui.label(format!("Network: {name}")).on_hover_text(
                    "Read again whenever the file changes, as while peelnet train writes it",
                );
                if ui.button("Use the shipped one").clicked() {
                    app.first.set_network(None);
                    app.watch.stop();
                    app.judge.last = None;
                }
            });
        }
        None => {
            ui.label("Network: the shipped one");
        }
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
            app.open_network(app.panels.model.clone().into());
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(text: &str) -> MethodSpec {
        text.parse().expect("a method")
    }

    #[test]
    fn values_and_defaults_are_set() {
        let m = spec("wboit-eq10:factor=3e4,targets=f32");
        assert_eq!(changed(&m, "factor", None), spec("wboit-eq10:targets=f32"));
        let other = changed(&m, "targets", Some("f16"));
        assert_eq!(other, spec("wboit-eq10:factor=3e4,targets=f16"));
        // What is not allowed changes nothing.
        assert_eq!(changed(&m, "targets", Some("f8")), m);
        assert_eq!(changed(&spec("mboit4"), "targets", None), spec("mboit4"));
    }

    #[test]
    fn numbers_are_set() {
        let m = spec("kbuffer-4");
        assert_eq!(renumbered(&m, 8), spec("kbuffer-8"));
        assert_eq!(renumbered(&m, 0), m);
    }

    /// Every method that a GPU draws can be chosen, and every parameter has a control: the match in `control` has no catch-all.
    #[test]
    fn methods_are_offered() {
        let drawn = METHODS.iter().filter(|m| m.cpu_only.is_none()).count();
        assert_eq!(offered().count(), drawn);
        assert!(offered().all(|m| MethodSpec::points(m).next().is_some()));
    }
}
