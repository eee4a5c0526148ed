//! Progress bars: on a terminal only, gone when done.

use crate::console::Console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar with a name before it and a text behind it.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of `total` steps, hidden where none may be shown.
    pub fn new(console: Console, name: &'static str, total: u64) -> Self {
        let target = if console.shows_progress() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let style =
            ProgressStyle::with_template("{prefix:>8} [{bar:30}] {pos}/{len} · {msg} · {eta} left")
                .expect("the template is constant and was tested")
                .progress_chars("=> ");
        Self(
            ProgressBar::with_draw_target(Some(total), target)
                .with_style(style)
                .with_prefix(name),
        )
    }

    /// Sets the position, the total and the text.
    pub fn set(&self, done: u64, total: u64, text: String) {
        self.0.set_length(total);
        self.0.set_message(text);
        self.0.set_position(done);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A count with a suffix: 950, 12.3 k, 4.56 M.
pub fn short(count: f64) -> String {
    match count {
        c if c < 1e3 => format!("{c:.0}"),
        c if c < 1e6 => format!("{:.1} k", c / 1e3),
        c if c < 1e9 => format!("{:.2} M", c / 1e6),
        c => format!("{:.2} G", c / 1e9),
    }
}

/// A whole number with commas between the thousands.
pub fn thousands(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_right_and_a_hidden_bar_counts() {
        let bar = Progress::new(Console::new(true, false), "rows", 10);
        bar.set(3, 12, "x".to_owned());
        assert_eq!((bar.0.position(), bar.0.length()), (3, Some(12)));
    }

    #[test]
    fn counts() {
        assert_eq!(short(950.0), "950");
        assert_eq!(short(12_345.0), "12.3 k");
        assert_eq!(short(4_560_000.0), "4.56 M");
        assert_eq!(thousands(0), "0");
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(1_544_955), "1,544,955");
    }
}
