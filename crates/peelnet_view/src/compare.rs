//! How one or two pictures are shown.

/// Seconds that each of two pictures is shown.
const FLICKER: f64 = 0.5;

/// What the viewport shows; the numbers of `display.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Mode {
    One = 0,
    /// In place of [`Mode::Flicker`] while the second picture's turn lasts.
    Second = 1,
    Split = 2,
    Beside = 3,
    Error = 4,
    Layers = 5,
    /// Both methods in turn; while the first picture's turn lasts, that one.
    Flicker = 6,
}

/// What people choose from: the word of command lines, a name and what it does.
pub(crate) const MODES: [(Mode, &str, &str, &str); 6] = {
    const SPLIT: &str = "The method left of a divider that you drag, the other one right of it";
    const BESIDE: &str = "Both methods side by side, each whole";
    const FLICKER: &str = "Each in turn, every half second: the eye finds what jumps";
    const ERROR: &str = "The largest difference of a colour channel, of 255";
    const LAYERS: &str = "How many transparent surfaces lie over each pixel";
    [
        (Mode::One, "one", "One", "The method alone"),
        (Mode::Split, "split", "Split", SPLIT),
        (Mode::Beside, "beside", "Beside", BESIDE),
        (Mode::Flicker, "flicker", "Flicker", FLICKER),
        (Mode::Error, "error", "Error map", ERROR),
        (Mode::Layers, "layers", "Depth complexity", LAYERS),
    ]
};

impl std::str::FromStr for Mode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = MODES.iter().find(|(_, word, ..)| *word == text);
        found.map(|(mode, ..)| *mode).ok_or_else(|| {
            let words = MODES.map(|(_, word, ..)| word).join(", ");
            format!("'{text}' is not one of {words}")
        })
    }
}

impl Mode {
    pub(crate) const fn needs_second(self) -> bool {
        !matches!(self, Self::One | Self::Layers)
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Compare {
    pub mode: Mode,
    /// Where the pictures are divided, a share of the width.
    pub divider: f32,
    /// Difference at which the error map ends, levels of 255.
    pub scale: f32,
}

impl Compare {
    /// The mode at this moment: flickering takes turns.
    pub fn mode_at(&self, ui: &egui::Context) -> Mode {
        if self.mode != Mode::Flicker {
            return self.mode;
        }
        let turn = ui.input(|i| i.time) / FLICKER;
        let left = (1.0 - turn.fract()) * FLICKER;
        ui.request_repaint_after(std::time::Duration::from_secs_f64(left));
        if (turn as u64).is_multiple_of(2) {
            Mode::Flicker
        } else {
            Mode::Second
        }
    }
}
