//! What a script asks of the window: so many frames, a screenshot, the end.

use crate::slot::Slot;
use egui::{ColorImage, Context};
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

/// Draws so many frames, saves what the window shows, and closes it.
#[derive(Debug)]
pub struct Script {
    frames: u64,
    screenshot: Option<PathBuf>,
    asked: bool,
    result: Outcome,
}

/// What became of a script, shared with the program that opened the window.
pub type Outcome = Arc<Mutex<Option<Result<(), String>>>>;

impl Clone for Script {
    fn clone(&self) -> Self {
        Self {
            frames: self.frames,
            screenshot: self.screenshot.clone(),
            asked: self.asked,
            result: Arc::clone(&self.result),
        }
    }
}

impl Script {
    /// At least one frame is drawn.
    pub fn new(frames: u64, screenshot: Option<PathBuf>) -> Self {
        Self {
            frames: frames.max(1),
            screenshot,
            asked: false,
            result: Arc::default(),
        }
    }

    /// Where the outcome will be.
    pub fn outcome(&self) -> Outcome {
        Arc::clone(&self.result)
    }

    /// Frames are drawn again while a script counts them.
    pub(crate) const fn draws_always(&self) -> bool {
        !self.asked
    }

    pub(crate) fn advance(&mut self, ui: &Context, slot: &Slot) {
        let finished = |result: &Outcome, with: Result<(), String>| {
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(with);
        };
        if let Some(failure) = slot.failure.as_ref().filter(|_| !self.asked) {
            finished(&self.result, Err(format!("{}: {failure}", slot.spec())));
            ui.send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        }
        ui.request_repaint();
        // A method that needs counts has its whole picture only after they came back.
        let is_whole = slot.status() == peelnet_render::FrameStatus::Whole;
        if self.asked || slot.frames < self.frames || !is_whole {
            return;
        }
        self.asked = true;
        let Some(path) = self.screenshot.clone() else {
            finished(&self.result, Ok(()));
            ui.send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        };
        let (result, context) = (Arc::clone(&self.result), ui.clone());
        ui.request_screenshot(move |image: Arc<ColorImage>| {
            finished(&result, save(&image, &path));
            context.send_viewport_cmd(egui::ViewportCommand::Close);
            context.request_repaint();
        });
    }
}

/// Writes what the window shows as a PNG file.
pub(crate) fn save(image: &ColorImage, path: &std::path::Path) -> Result<(), String> {
    let pixels = image.pixels.iter();
    let linear = |byte: u8| peelnet_core::srgb::decode(f32::from(byte) / 255.0);
    let pixels = pixels.map(|p| [p.r(), p.g(), p.b()].map(linear));
    let image = peelnet_render::Image {
        width: image.size[0] as u32,
        height: image.size[1] as u32,
        pixels: pixels.map(|[r, g, b]| [r, g, b, 1.0]).collect(),
    };
    image.save(path).map_err(|e| crate::stage::one_line(&e))
}
