//! What moves by itself: a timeline that plays, and a turntable.

use crate::app::App;
use egui::Context;

/// Seconds that a whole timeline takes, and a turn of the turntable.
const LENGTH: f32 = 8.0;

#[derive(Debug, Default)]
pub(crate) struct Motion {
    /// Whether the timeline plays.
    pub plays: bool,
    /// Whether the eye goes round.
    pub turns: bool,
}

impl Motion {
    pub const fn stop(&mut self) {
        (self.plays, self.turns) = (false, false);
    }
}

impl App {
    /// Moves what moves by itself.
    pub(crate) fn advance(&mut self, ui: &Context) {
        if !self.motion.plays && !self.motion.turns {
            return;
        }
        let step = ui.input(|i| i.stable_dt).min(0.25) / LENGTH;
        if self.motion.turns {
            self.move_eye(|camera, _| {
                crate::eye::orbit(camera, step * std::f32::consts::TAU, 0.0);
            });
        }
        if self.motion.plays
            && let Some(scene) = self.stage.as_ref().map(|s| s.scene())
            && let (Some(from), Some(to)) = (scene.timeline.first(), scene.timeline.last())
        {
            let (from, to) = (from.time, to.time);
            let next = scene.time + step * (to - from);
            let next = if next > to { from } else { next };
            self.edit(|stage| stage.set_time(next));
        }
        ui.request_repaint();
    }
}
