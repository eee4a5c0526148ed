//! A model file that is read again whenever it changes, as `peelnet train` writes it. A page has no files: nothing changes there.

use egui::Context;
use std::{fs, path::PathBuf, time::Duration, time::SystemTime};

const EVERY: Duration = Duration::from_millis(500);

#[derive(Default)]
pub(crate) struct Watch {
    file: Option<(PathBuf, Option<SystemTime>)>,
    looked: f64,
}

impl Watch {
    /// Looks at this file from now on, or at none.
    pub fn follow(&mut self, path: Option<PathBuf>) {
        self.file = path.map(|path| {
            let time = fs::metadata(&path).and_then(|m| m.modified()).ok();
            (path, time)
        });
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
        let time = fs::metadata(&*path).and_then(|m| m.modified()).ok()?;
        (known.replace(time) != Some(time)).then(|| path.clone())
    }
}
