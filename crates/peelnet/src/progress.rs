//! Progress bars: on a terminal only, gone when done.

use crate::console::Console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use peelnet_core::files::one_line;
use std::time::Duration;

/// A bar between a name and a text.
#[derive(Debug)]
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar of `total` steps, hidden where none may be shown.
    pub fn new(console: Console, name: &'static str, total: u64) -> Self {
        let style =
            ProgressStyle::with_template("{prefix:>8} [{bar:30}] {pos}/{len} · {msg} · {eta} left")
                .expect("the template is constant")
                .progress_chars("=> ");
        let bar = ProgressBar::with_draw_target(Some(total), target(console));
        Self(bar.with_style(style).with_prefix(name))
    }

    /// A sign of life beside what is being done, where nobody knows how long it takes.
    pub fn spinner(console: Console, text: String) -> Self {
        let style = ProgressStyle::with_template("{spinner} {msg} · {elapsed}")
            .expect("the template is constant");
        let bar = ProgressBar::with_draw_target(None, target(console)).with_style(style);
        bar.set_message(one_line(&text).into_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    pub fn set(&self, done: u64, total: u64, text: String) {
        self.0.set_length(total);
        self.0.set_message(one_line(&text).into_owned());
        self.0.set_position(done);
    }
}

/// Where bars are drawn, if anywhere.
fn target(console: Console) -> ProgressDrawTarget {
    if console.shows_progress() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
