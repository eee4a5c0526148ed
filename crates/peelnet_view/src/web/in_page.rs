//! What an application has where it runs in a page.

use super::handle::Page;
use crate::{
    stage::Files,
    task::{Fallible, Task},
};
use peelnet_render::gpu::Gpu;

/// What an application in a page has besides.
#[derive(Default)]
pub(crate) struct InPage {
    /// Draws the page again.
    pub(super) context: egui::Context,
    pub(super) reading: Option<Task<Fallible<Files>>>,
    /// What the address says, and when it was written.
    pub(super) address: (String, f64),
    pub(super) drawing: Option<Task<()>>,
    /// Begins again with another device, and has the scene that the browser keeps.
    pub(super) handle: Option<Page>,
}

impl InPage {
    /// Whether the GPU is still drawing the last frame. A browser takes frames faster than a slow GPU draws them: what methods read back
    /// of a frame, and what is dragged, would wait behind all of them.
    pub fn is_drawing(&mut self, ui: &egui::Context) -> bool {
        Task::finish(&mut self.drawing, ui);
        self.drawing.is_some()
    }

    pub fn drew(&mut self, gpu: &Gpu, ui: &egui::Context) {
        let gpu = gpu.clone();
        self.drawing = Some(Task::new(async move { gpu.submitted_async().await }));
        // Its end is asked for now, not at the next frame.
        self.is_drawing(ui);
    }
}
