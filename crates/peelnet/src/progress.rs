//! Progress bars: on a terminal only, gone when done.

use crate::console::Console;
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar between a name and a text.
#[derive(Debug)]
pub struct Bar(ProgressBar);

impl Bar {
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

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A whole number with commas between the thousands.
pub fn thousands(count: u64) -> String {
    HumanCount(count).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_right_and_a_hidden_bar_counts() {
        let bar = Bar::new(Console::new(true, false), "rows", 10);
        bar.set(3, 12, "x".to_owned());
        assert_eq!((bar.0.position(), bar.0.length()), (3, Some(12)));
    }

    #[test]
    fn counts() {
        assert_eq!(thousands(0), "0");
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(1_544_955), "1,544,955");
    }
}
