//! A model file that is read again whenever it changes, as `peelnet train` writes it.

use egui::Context;
use std::{path::PathBuf, time::Duration};
use web_time::SystemTime;

/// How often the file is looked at.
const EVERY: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
pub(crate) struct Watch {
    file: Option<(PathBuf, Option<SystemTime>)>,
    looked: f64,
}

impl Watch {
    /// Looks at this file from now on.
    pub fn follow(&mut self, path: PathBuf) {
        let time = modified(&path);
        self.file = Some((path, time));
    }

    pub fn stop(&mut self) {
        self.file = None;
    }

    /// The file, where it has changed since it was last read.
    pub fn changed(&mut self, ui: &Context) -> Option<PathBuf> {
        let (path, known) = self.file.as_mut()?;
        ui.request_repaint_after(EVERY);
        let now = ui.input(|i| i.time);
        if now - self.looked < EVERY.as_secs_f64() {
            return None;
        }
        self.looked = now;
        // While it is replaced there may be none.
        let time = modified(path)?;
        if *known == Some(time) {
            return None;
        }
        *known = Some(time);
        Some(path.clone())
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn modified(path: &std::path::Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

/// A page has no files.
#[cfg(target_arch = "wasm32")]
fn modified(_: &std::path::Path) -> Option<SystemTime> {
    None
}
