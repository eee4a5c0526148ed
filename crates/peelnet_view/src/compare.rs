//! How one or two pictures are shown.

use crate::display::Show;

/// Seconds that each of two pictures is seen.
const FLICKER: f64 = 0.5;

/// What the viewport shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The method alone.
    #[default]
    One,
    /// Both methods, divided by a line.
    Split,
    /// Both methods side by side.
    Beside,
    /// Both methods in turn.
    Flicker,
    /// In place of [`Mode::Flicker`] while the second picture's turn lasts.
    Second,
    /// A map of their differences.
    Error,
    /// A map of the number of transparent surfaces.
    Layers,
}

/// Names for command lines, in the order of [`Mode::ALL`].
const WORDS: [&str; 6] = ["one", "split", "beside", "flicker", "error", "layers"];

impl std::str::FromStr for Mode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let place = WORDS.iter().position(|word| *word == text);
        place
            .map(|k| Self::ALL[k].0)
            .ok_or_else(|| format!("'{text}' is not one of {}", WORDS.join(", ")))
    }
}

impl Mode {
    /// All that people choose from, with a name and what it does.
    pub(crate) const ALL: [(Self, &'static str, &'static str); 6] = [
        (Self::One, "One", "The method alone"),
        (
            Self::Split,
            "Split",
            "The method left of a divider that you drag, the other one right of it",
        ),
        (
            Self::Beside,
            "Beside",
            "Both methods side by side, each whole",
        ),
        (
            Self::Flicker,
            "Flicker",
            "Each in turn, every half second: the eye finds what jumps",
        ),
        (
            Self::Error,
            "Error map",
            "The largest difference of a colour channel, of 255",
        ),
        (
            Self::Layers,
            "Depth complexity",
            "How many transparent surfaces lie over each pixel",
        ),
    ];

    pub(crate) const fn needs_second(self) -> bool {
        !matches!(self, Self::One | Self::Layers)
    }

    pub(crate) const fn show(self) -> Show {
        match self {
            Self::One | Self::Flicker | Self::Layers => Show::First,
            Self::Second => Show::Second,
            Self::Split => Show::Split,
            Self::Beside => Show::Beside,
            Self::Error => Show::Error,
        }
    }
}

/// The choice, and its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compare {
    pub mode: Mode,
    /// Where the pictures are divided, a share of the width.
    pub divider: f32,
    /// Difference at which the error map ends, levels of 255.
    pub scale: f32,
}

impl Default for Compare {
    fn default() -> Self {
        Self {
            mode: Mode::One,
            divider: 0.5,
            scale: 16.0,
        }
    }
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
