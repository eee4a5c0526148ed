//! What the window says: one line each, the newest last, until it is put away.

use crate::task::one_line;
use std::error::Error;

const MOST: usize = 4;

/// Lines, each with whether it is an error.
#[derive(Default)]
pub(crate) struct Messages(pub Vec<(bool, String)>);

impl Messages {
    pub fn error(&mut self, text: String) {
        self.add(true, text);
    }

    pub fn warn(&mut self, text: String) {
        self.add(false, text);
    }

    pub fn unless_error<T>(&mut self, result: Result<T, impl Into<Box<dyn Error>>>) -> Option<T> {
        result.map_err(|e| self.error(one_line(&*e.into()))).ok()
    }

    /// The same line is said once.
    fn add(&mut self, is_error: bool, text: String) {
        if self.0.iter().any(|(_, known)| *known == text) {
            return;
        }
        if self.0.len() == MOST {
            self.0.remove(0);
        }
        self.0.push((is_error, text));
    }

    pub fn show(&mut self, ui: &mut egui::Ui) {
        self.0.retain(|(is_error, text)| {
            let row = ui.horizontal(|ui| {
                let away = ui.small_button("×").on_hover_text("Put this message away");
                away.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, "Put message away")
                });
                let color = if *is_error {
                    ui.visuals().error_fg_color
                } else {
                    ui.visuals().warn_fg_color
                };
                ui.add(egui::Label::new(egui::RichText::new(text).color(color)).wrap());
                away.clicked()
            });
            !row.inner
        });
    }
}
