//! What the window says: one line each, the newest last, until it is put away.

/// Lines that are kept.
const MOST: usize = 4;

/// Lines, each with whether it is an error.
#[derive(Debug, Default)]
pub(crate) struct Messages(Vec<(bool, String)>);

impl Messages {
    pub fn error(&mut self, text: String) {
        self.add(true, text);
    }

    pub fn warn(&mut self, text: String) {
        self.add(false, text);
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

    /// All lines, the newest last.
    #[cfg(target_arch = "wasm32")]
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(_, text)| text.as_str())
    }

    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Shows all lines, each with a button that puts it away.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let mut gone = None;
        for (i, (is_error, text)) in self.0.iter().enumerate() {
            ui.horizontal(|ui| {
                let away = ui.small_button("×").on_hover_text("Put this message away");
                away.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, "Put message away")
                });
                if away.clicked() {
                    gone = Some(i);
                }
                let color = if *is_error {
                    ui.visuals().error_fg_color
                } else {
                    ui.visuals().warn_fg_color
                };
                ui.add(egui::Label::new(egui::RichText::new(text).color(color)).wrap());
            });
        }
        if let Some(i) = gone {
            self.0.remove(i);
        }
    }
}
