//! What a script asks of the window: so many frames, a screenshot, the end.

use crate::{
    slot::Slot,
    task::{Fallible, one_line},
    training::Training,
};
use egui::{ColorImage, Context, ViewportCommand};
use peelnet_render::{FrameStatus, Image};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use web_time::Instant;

/// Draws so many frames, saves what the window shows, and closes it.
#[derive(Clone, Debug)]
pub struct Script {
    frames: Option<u64>,
    screenshot: Option<PathBuf>,
    /// Whether all frames are drawn; until then they are drawn again although nothing changes.
    asked: bool,
    last: Option<Instant>,
    /// What frames cost, milliseconds: from frame to frame, the method's passes where their times came back, and the window's frame on the CPU.
    costs: [Vec<f64>; 3],
    outcome: Arc<Mutex<Option<Result<String, String>>>>,
}

impl Script {
    /// At least one frame is drawn; without a number also all that a training brings.
    pub fn new(frames: Option<u64>, screenshot: Option<PathBuf>) -> Self {
        Self {
            frames,
            screenshot,
            asked: false,
            last: None,
            costs: Default::default(),
            outcome: Arc::default(),
        }
    }

    /// What became of the script, in any of its copies: what its frames cost, or what went wrong. `None` before it ended.
    pub fn outcome(&self) -> Option<Result<String, String>> {
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        outcome.take()
    }

    fn finish(&self, ui: &Context, outcome: Result<String, String>) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
        ui.send_viewport_cmd(ViewportCommand::Close);
        ui.request_repaint();
    }

    /// Whether frames are drawn although nothing changes; `waits` says whether a training goes on.
    pub(crate) const fn draws_always(&self, waits: bool) -> bool {
        !self.asked && (self.frames.is_some() || !waits)
    }

    /// After each frame; `cpu_ms` is what its work on the CPU took.
    pub(crate) fn advance(
        &mut self,
        ui: &Context,
        slot: &Slot,
        training: &Training,
        waits: bool,
        cpu_ms: f64,
    ) {
        let drawing = (slot.spec.to_string(), &slot.failure);
        for (what, failure) in [drawing, ("training".to_owned(), &training.failure)] {
            if let Some(failure) = failure.as_ref().filter(|_| !self.asked) {
                return self.finish(ui, Err(format!("{what}: {failure}")));
            }
        }
        ui.request_repaint();
        if self.asked {
            return;
        }
        let now = Instant::now();
        let last = self.last.replace(now);
        let frame_ms = last.map(|last| (now - last).as_secs_f64() * 1e3);
        for (all, ms) in (self.costs.iter_mut()).zip([frame_ms, slot.gpu_ms(), Some(cpu_ms)]) {
            all.extend(ms);
        }
        // A method that needs counts has its whole picture only after they came back.
        let goes_on = self.frames.is_none() && waits;
        if slot.frames < self.frames.unwrap_or(1) || slot.status != FrameStatus::Whole || goes_on {
            return;
        }
        self.asked = true;
        let mut costs = self.medians(slot);
        costs.extend(training.text().map(|text| format!("\n{text}")));
        let Some(path) = self.screenshot.clone() else {
            return self.finish(ui, Ok(costs));
        };
        let (script, context) = (self.clone(), ui.clone());
        ui.request_screenshot(move |image: Arc<ColorImage>| {
            let saved = save(&image, &path).map_err(|e| one_line(&*e));
            script.finish(&context, saved.map(|()| costs.clone()));
        });
    }

    fn medians(&mut self, slot: &Slot) -> String {
        let names = [
            "from frame to frame",
            "the method's passes on the GPU",
            "the frame on the CPU",
        ];
        let mut text = format!("{} frames: ", slot.frames);
        for (name, values) in names.into_iter().zip(&mut self.costs) {
            values.sort_by(f64::total_cmp);
            if let Some(ms) = values.get(values.len() / 2) {
                text += &format!("{name} {ms:.2} ms, ");
            }
        }
        text + &format!("made ready in {:.0} ms", slot.ready_ms)
    }
}

/// Writes what the window shows as a PNG file.
fn save(image: &ColorImage, path: &Path) -> Fallible<()> {
    let linear = |byte: u8| peelnet_core::srgb::decode(f32::from(byte) / 255.0);
    let pixels = image.pixels.iter().map(|p| {
        let [r, g, b] = [p.r(), p.g(), p.b()].map(linear);
        [r, g, b, 1.0]
    });
    let image = Image {
        width: image.size[0] as u32,
        height: image.size[1] as u32,
        pixels: pixels.collect(),
    };
    Ok(image.save(path)?)
}
