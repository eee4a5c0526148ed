//! Keys, dropped files, and what moves by itself.

use crate::{
    app::App,
    compare::MODES,
    eye,
    stage::{Files, Source},
};
use egui::{Context, Key, Modifiers};
use peelnet_core::files::shown;
use peelnet_render::MethodSpec;
use peelnet_scene::file::ENDINGS;
use std::{
    f32::consts::TAU,
    path::{Path, PathBuf},
    sync::Arc,
};

/// How far the eye flies in a second, in radii of the scene.
const SPEED: f32 = 0.7;
/// How far a press of an arrow key turns, radians.
const TURN: f32 = 0.1;
/// Seconds that a whole timeline takes, and a turn of the turntable.
const LENGTH: f32 = 8.0;

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

const MODEL: &str = "safetensors";

fn has_ending(path: &Path, wanted: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(wanted))
}

/// The file to open among several: a network, whatever lies beside it, or else a scene, by the order of endings.
///
/// # Errors
/// A message where there is nothing to open.
fn find_file(paths: &[PathBuf]) -> Result<&PathBuf, String> {
    let mut endings = std::iter::once(MODEL).chain(ENDINGS);
    let found = endings.find_map(|wanted| paths.iter().find(|path| has_ending(path, wanted)));
    found.ok_or_else(|| {
        let name = paths.first().map_or("nothing".into(), |p| shown(p));
        let scenes = ENDINGS.map(|e| format!(".{e}")).join(", ");
        format!("{name}: not a scene or a network; drop a {scenes} or .{MODEL} file")
    })
}

impl App {
    /// Opens the scene or the network among files, which are on disk where they are not given.
    pub fn open_files(&mut self, paths: &[PathBuf], dropped: Option<Arc<Files>>) {
        let Some(path) = self.messages.unless_error(find_file(paths)).cloned() else {
            return;
        };
        let is_network = has_ending(&path, MODEL);
        let source = Source {
            dropped,
            ..Source::named(path)
        };
        if is_network {
            self.open_network(source);
        } else {
            self.open(source, None);
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub fn take_dropped(&mut self, ui: &Context) {
        let files = ui.input(|i| i.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = files.iter().map(|f| f.path().to_owned()).collect();
        match paths.first().filter(|path| path.is_dir()) {
            Some(folder) => self.open_dataset(folder),
            None if paths.is_empty() => {}
            None => self.open_files(&paths, None),
        }
    }

    /// Does what keys ask for, unless a text is typed.
    pub fn take_keys(&mut self, ui: &Context) {
        if ui.egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key: Key| ui.input(|i| i.key_pressed(key) && !i.modifiers.command);
        for number in 0..9 {
            let digit = Key::from_name(&(number + 1).to_string());
            if digit.is_some_and(pressed) {
                self.show_view(number);
            }
        }
        // When a frame takes long, Shift may be released before it is drawn: the event knows.
        let is_shifted = |event: &egui::Event| matches!(event, egui::Event::Key { key: Key::M, pressed: true, modifiers, .. } if modifiers.shift);
        if pressed(Key::M) {
            self.next_method(ui.input(|i| i.events.iter().any(is_shifted)));
        }
        if pressed(Key::C) {
            let now = MODES.iter().position(|m| m.0 == self.compare.mode);
            self.compare.mode = MODES[now.map_or(0, |k| k + 1) % MODES.len()].0;
        }
        if pressed(Key::F) {
            self.fit();
        }
        for (key, on) in [
            (Key::T, &mut self.panels.turns),
            (Key::Space, &mut self.panels.plays),
            (Key::H, &mut self.panels.help),
        ] {
            *on ^= pressed(key);
        }
        self.take_arrows(ui);
        self.fly(ui);
    }

    fn take_arrows(&mut self, ui: &Context) {
        // Where a control has the focus, arrows are its own.
        if ui.memory(|m| m.focused().is_some()) {
            return;
        }
        for (key, yaw, pitch) in [
            (Key::ArrowLeft, -TURN, 0.0),
            (Key::ArrowRight, TURN, 0.0),
            (Key::ArrowUp, 0.0, TURN),
            (Key::ArrowDown, 0.0, -TURN),
        ] {
            if ui.input(|i| i.key_pressed(key)) {
                self.move_eye(|camera, _| eye::orbit(camera, yaw, pitch));
            }
        }
    }

    fn fly(&mut self, ui: &Context) {
        let down = |key: Key| ui.input(|i| i.key_down(key) && i.modifiers == Modifiers::NONE);
        let axis = |(plus, minus): (Key, Key)| f32::from(down(plus)) - f32::from(down(minus));
        let keys = [(Key::D, Key::A), (Key::E, Key::Q), (Key::W, Key::S)];
        let step = glam::Vec3::from(keys.map(axis));
        if step != glam::Vec3::ZERO {
            let time = ui.input(|i| i.stable_dt).min(0.1);
            self.move_eye(|camera, all| eye::fly(camera, step * (SPEED * time * all.radius)));
            ui.request_repaint();
        }
    }

    pub fn fit(&mut self) {
        let [width, height] = self.size.map(|n| n.max(1) as f32);
        self.move_eye(|camera, all| eye::fit(camera, all, width / height));
    }

    fn next_method(&mut self, back: bool) {
        let all: Vec<_> = crate::panels::methods::offered().collect();
        let own = self.first.spec.name();
        let now = all.iter().position(|m| m.name == own).unwrap_or(0);
        let step = if back { all.len() - 1 } else { 1 };
        let next = all[(now + step) % all.len()];
        if let Some(spec) = MethodSpec::points(next).next() {
            self.first.set_spec(spec);
        }
    }

    /// Moves the timeline while it plays, and the eye while it goes round.
    pub fn advance(&mut self, ui: &Context) {
        if !self.panels.plays && !self.panels.turns {
            return;
        }
        let step = ui.input(|i| i.stable_dt).min(0.25) / LENGTH;
        if self.panels.turns {
            self.move_eye(|camera, _| eye::orbit(camera, step * TAU, 0.0));
        }
        let stage = self.stage.as_ref().filter(|_| self.panels.plays);
        if let Some((now, (from, to))) = stage.and_then(|s| Some((s.time()?, s.times()?))) {
            let next = now + step * (to - from);
            let next = if next > to { from } else { next };
            self.edit(|stage| stage.set_time(next));
        }
        ui.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_to_open_is_found() {
        let of = |names: &[&str]| {
            let paths: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            find_file(&paths).cloned()
        };
        assert_eq!(of(&["a.png", "b.obj", "b.mtl"]), Ok("b.obj".into()));
        assert_eq!(of(&["b.obj", "room.TOML"]), Ok("room.TOML".into()));
        let network = of(&["b.obj", "a.safetensors"]);
        assert_eq!(network, Ok("a.safetensors".into()));
        let none = of(&["notes.txt", "glb"]);
        assert!(none.is_err_and(|e| e.starts_with("notes.txt: not a scene")));
    }
}
