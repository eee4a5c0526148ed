//! What a script asks of the window: so many frames, a screenshot, the end.

use crate::slot::Slot;
use egui::{ColorImage, Context};
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};
use web_time::Instant;

/// Draws so many frames, saves what the window shows, and closes it.
#[derive(Debug)]
pub struct Script {
    frames: u64,
    screenshot: Option<PathBuf>,
    asked: bool,
    costs: Costs,
    result: Outcome,
}

/// What became of a script, shared with the program that opened the window: what its frames cost, or what went wrong.
pub type Outcome = Arc<Mutex<Option<Result<String, String>>>>;

/// What frames cost, milliseconds.
#[derive(Clone, Debug, Default)]
struct Costs {
    last: Option<Instant>,
    /// From frame to frame.
    frames: Vec<f64>,
    /// Work of the window's frame on the CPU.
    cpu: Vec<f64>,
    /// The method's passes, of frames whose times came back.
    method: Vec<f64>,
}

impl Costs {
    fn frame(&mut self, cpu_ms: f64, slot: &Slot) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now) {
            self.frames.push((now - last).as_secs_f64() * 1e3);
        }
        self.cpu.push(cpu_ms);
        self.method.extend(slot.gpu_ms());
    }

    /// Medians.
    fn text(mut self, slot: &Slot) -> String {
        let median = |name: &str, values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            let middle = values.get(values.len() / 2);
            middle.map(|ms| format!("{name} {ms:.2} ms"))
        };
        let parts = [
            median("from frame to frame", &mut self.frames),
            median("the method's passes on the GPU", &mut self.method),
            median("the frame on the CPU", &mut self.cpu),
            Some(format!("made ready in {:.0} ms", slot.ready_ms)),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!("{} frames: {}", slot.frames, parts.join(", "))
    }
}

impl Clone for Script {
    fn clone(&self) -> Self {
        Self {
            frames: self.frames,
            screenshot: self.screenshot.clone(),
            asked: self.asked,
            costs: self.costs.clone(),
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
            costs: Costs::default(),
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

    /// After each frame; `cpu_ms` is what its work on the CPU took.
    pub(crate) fn advance(&mut self, ui: &Context, slot: &Slot, cpu_ms: f64) {
        let finished = |result: &Outcome, with: Result<String, String>| {
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(with);
        };
        if let Some(failure) = slot.failure.as_ref().filter(|_| !self.asked) {
            finished(&self.result, Err(format!("{}: {failure}", slot.spec())));
            ui.send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        }
        ui.request_repaint();
        if !self.asked {
            self.costs.frame(cpu_ms, slot);
        }
        // A method that needs counts has its whole picture only after they came back.
        let is_whole = slot.status() == peelnet_render::FrameStatus::Whole;
        if self.asked || slot.frames < self.frames || !is_whole {
            return;
        }
        self.asked = true;
        let costs = std::mem::take(&mut self.costs).text(slot);
        let Some(path) = self.screenshot.clone() else {
            finished(&self.result, Ok(costs));
            ui.send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        };
        let (result, context) = (Arc::clone(&self.result), ui.clone());
        ui.request_screenshot(move |image: Arc<ColorImage>| {
            finished(&result, save(&image, &path).map(|()| costs.clone()));
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
