//! Keys and dropped files.

#[cfg(not(target_arch = "wasm32"))]
use crate::stage::Source;
use crate::{app::App, compare::Mode, eye};
use egui::{Context, Key};
use peelnet_scene::file::ENDINGS;
use std::path::Path;
#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;

/// How far the eye flies in a second, in radii of the scene.
const SPEED: f32 = 0.7;
/// How far a press of an arrow key turns, radians.
const TURN: f32 = 0.1;

/// Keys, for the help.
pub(crate) const KEYS: [(&str, &str); 14] = [
    ("drag", "orbit"),
    ("right drag, Shift + drag, two fingers", "pan"),
    ("wheel, pinch", "zoom"),
    ("click", "the pixel's fragments"),
    ("arrows", "orbit"),
    ("W A S D, Q E", "fly"),
    ("F", "see everything"),
    ("1 … 9", "the scene's cameras"),
    ("M, Shift + M", "next, previous method"),
    ("C", "next comparison"),
    ("T", "turntable"),
    ("Space", "play the timeline"),
    ("Tab", "hide or show the panels"),
    ("H", "this list"),
];

/// Digits in their order.
const DIGITS: [Key; 9] = [
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

const MODEL: &str = "safetensors";

fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|e| e.to_str());
    ending.unwrap_or_default().to_lowercase()
}

/// The scene among files, where there is one: of several, the one whose ending comes first.
pub(crate) fn scene_among<'a>(paths: impl Iterator<Item = &'a Path> + Clone) -> Option<&'a Path> {
    let mut endings = ENDINGS.iter();
    endings.find_map(|wanted| paths.clone().find(|p| ending(p) == **wanted))
}

/// What dropped files are.
#[derive(Debug, PartialEq)]
pub(crate) enum Opens<'a> {
    /// A network, whatever lies beside it.
    Network(&'a Path),
    /// A scene.
    Scene(&'a Path),
}

/// What there is to open among files; a message where there is nothing.
pub(crate) fn opens<'a>(
    mut paths: impl Iterator<Item = &'a Path> + Clone,
) -> Result<Opens<'a>, String> {
    if let Some(model) = paths.clone().find(|p| ending(p) == MODEL) {
        return Ok(Opens::Network(model));
    }
    if let Some(scene) = scene_among(paths.clone()) {
        return Ok(Opens::Scene(scene));
    }
    let first = paths.next().unwrap_or(Path::new("nothing"));
    let name = peelnet_files::shown(first);
    Err(format!(
        "{name}: not a scene or a network; drop a {} or .{MODEL} file",
        ENDINGS.map(|e| format!(".{e}")).join(", ")
    ))
}

/// Whether a key was pressed with Shift. When a frame takes long, Shift may be released before it is drawn: the event knows.
fn is_shifted(ui: &Context, wanted: Key) -> bool {
    let shifted = |event: &egui::Event| matches!(event, egui::Event::Key { key, pressed: true, modifiers, .. } if *key == wanted && modifiers.shift);
    ui.input(|i| i.events.iter().any(shifted))
}

impl App {
    /// Opens what was dropped onto the window.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn take_dropped(&mut self, ui: &Context) {
        let files = ui.input(|i| i.raw.dropped_files.clone());
        if files.is_empty() {
            return;
        }
        let paths: Vec<PathBuf> = files.iter().map(|f| f.path().to_owned()).collect();
        match opens(paths.iter().map(PathBuf::as_path)) {
            Ok(Opens::Network(path)) => self.open_network(path.to_owned()),
            Ok(Opens::Scene(path)) => self.open(Source::Named(path.to_owned()), None),
            Err(e) => self.messages.error(e),
        }
    }

    /// Does what keys ask for, unless a text is typed.
    pub(crate) fn take_keys(&mut self, ui: &Context) {
        if ui.egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key: Key| ui.input(|i| i.key_pressed(key) && !i.modifiers.command);
        for (number, key) in DIGITS.into_iter().enumerate() {
            if pressed(key) {
                self.show_view(number);
            }
        }
        if pressed(Key::M) {
            self.next_method(is_shifted(ui, Key::M));
        }
        if pressed(Key::C) {
            let all = Mode::ALL.map(|(mode, _, _)| mode);
            let now = all.iter().position(|m| *m == self.compare.mode);
            self.compare.mode = all[now.map_or(0, |k| (k + 1) % all.len())];
        }
        if pressed(Key::F) {
            self.fit();
        }
        if pressed(Key::T) {
            self.motion.turns = !self.motion.turns;
        }
        if pressed(Key::Space) {
            self.motion.plays = !self.motion.plays;
        }
        if pressed(Key::H) {
            self.panels.help = !self.panels.help;
        }
        self.take_arrows(ui);
        self.fly(ui);
    }

    fn take_arrows(&mut self, ui: &Context) {
        // Where a control has the focus, arrows are its own.
        if ui.memory(|m| m.focused().is_some()) {
            return;
        }
        let pressed = |key: Key| ui.input(|i| i.key_pressed(key));
        for (key, yaw, pitch) in [
            (Key::ArrowLeft, -TURN, 0.0),
            (Key::ArrowRight, TURN, 0.0),
            (Key::ArrowUp, 0.0, TURN),
            (Key::ArrowDown, 0.0, -TURN),
        ] {
            if pressed(key) {
                self.move_eye(|camera, _| eye::orbit(camera, yaw, pitch));
            }
        }
    }

    fn fly(&mut self, ui: &Context) {
        let down = |key: Key| ui.input(|i| i.key_down(key) && !i.modifiers.any());
        let axis = |plus: Key, minus: Key| f32::from(down(plus)) - f32::from(down(minus));
        let step = glam::Vec3::new(
            axis(Key::D, Key::A),
            axis(Key::E, Key::Q),
            axis(Key::W, Key::S),
        );
        if step != glam::Vec3::ZERO {
            let time = ui.input(|i| i.stable_dt).min(0.1);
            self.move_eye(|camera, all| eye::fly(camera, step * (SPEED * time * all.radius)));
            ui.request_repaint();
        }
    }

    /// Looks at everything.
    pub(crate) fn fit(&mut self) {
        let [width, height] = self.size.map(|n| n.max(1) as f32);
        self.move_eye(|camera, all| eye::fit(camera, all, width / height));
    }

    fn next_method(&mut self, back: bool) {
        let all: Vec<_> = crate::panels::methods::offered().collect();
        let own = self.first.spec().method().name;
        let now = all.iter().position(|m| m.name == own).unwrap_or(0);
        let step = if back { all.len() - 1 } else { 1 };
        let next = all[(now + step) % all.len()];
        if let Some(spec) = peelnet_render::MethodSpec::points(next).next() {
            self.first.set_spec(spec);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_among_dropped_files_is_found() {
        let of = |names: &[&str]| {
            let paths: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            scene_among(paths.iter().map(PathBuf::as_path)).map(Path::to_owned)
        };
        assert_eq!(of(&["a.png", "b.obj", "b.mtl"]), Some("b.obj".into()));
        assert_eq!(of(&["b.obj", "room.TOML"]), Some("room.TOML".into()));
        assert_eq!(of(&["a.png", "glb"]), None);
        let all = ["b.obj", "a.safetensors"].map(Path::new);
        assert_eq!(opens(all.into_iter()), Ok(Opens::Network(all[1])));
        let none = opens(["notes.txt"].map(Path::new).into_iter());
        assert!(none.is_err_and(|e| e.starts_with("notes.txt: not a scene")));
    }
}
