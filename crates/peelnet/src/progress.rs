//! Progress bars: on a terminal only, gone when done.

use crate::console::Console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use peelnet_core::files::one_line;
use peelnet_train::EpochReport;
use rgb::RGB8;
use std::time::{Duration, Instant};
use textplots::{
    Chart, ColorPlot as _, LabelBuilder as _, LabelFormat, Shape, TickDisplay,
    TickDisplayBuilder as _,
};

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

/// A training: both losses over the epochs, above a bar of them.
#[derive(Debug)]
pub struct Curves {
    bar: Bar,
    history: Vec<EpochReport>,
    drawn: Option<Instant>,
}

/// Dots of the chart, of which a character has 2 × 4.
const DOTS: [u32; 2] = [120, 40];

/// Of the training loss, and of the held-out loss.
const COLORS: [RGB8; 2] = [RGB8::new(80, 150, 240), RGB8::new(240, 150, 60)];

impl Curves {
    pub fn new(console: Console, epochs: u32) -> Self {
        let bar = Bar::new(console, "train", epochs.into());
        let style = "{prefix}\n   train [{bar:30}] {pos}/{len} · {msg} · {eta} left";
        let style = ProgressStyle::with_template(style).expect("the template is constant");
        bar.0.set_style(style.progress_chars("=> "));
        bar.0.set_prefix("");
        Self {
            bar,
            history: Vec::new(),
            drawn: None,
        }
    }

    /// An epoch ended. The chart follows ten times a second at most: epochs of few rows take a millisecond.
    pub fn add(&mut self, epoch: &EpochReport) {
        self.history.push(epoch.clone());
        let is_late = |at: Instant| at.elapsed() >= Duration::from_millis(100);
        if !self.bar.0.is_hidden() && self.drawn.is_none_or(is_late) {
            self.bar.0.set_prefix(losses(&self.history));
            self.drawn = Some(Instant::now());
        }
        let (done, total) = (epoch.epoch.into(), epoch.epochs.into());
        self.bar.set(done, total, epoch.progress());
    }
}

/// Both losses over the epochs, on a logarithmic axis, in characters of a terminal. Nothing of fewer than two epochs.
fn losses(history: &[EpochReport]) -> String {
    let line = |loss: fn(&EpochReport) -> Option<f64>| -> Vec<(f32, f32)> {
        let points = history.iter().filter_map(|e| Some((e.epoch, loss(e)?)));
        let positive = points.filter(|(_, loss)| *loss > 0.0);
        positive
            .map(|(epoch, loss)| (epoch as f32, loss.log10() as f32))
            .collect()
    };
    let lines = [line(|e| Some(e.train_loss)), line(|e| e.held_out_loss)];
    let [Some(first), Some(last)] = [history.first(), history.last()] else {
        return String::new();
    };
    if lines[0].len() < 2 {
        return String::new();
    }
    let [training, held_out] = lines.each_ref().map(|line| Shape::Lines(line));
    let [width, height] = DOTS;
    let mut chart = Chart::new(width, height, first.epoch as f32, last.epoch as f32);
    let chart = chart
        .linecolorplot(&training, COLORS[0])
        .linecolorplot(&held_out, COLORS[1])
        .x_label_format(LabelFormat::Custom(Box::new(|epoch| format!("{epoch:.0}"))))
        .y_label_format(LabelFormat::Custom(Box::new(|loss| {
            format!("{:.1e}", 10f32.powf(loss))
        })))
        .y_tick_display(TickDisplay::Sparse);
    chart.figures();
    chart.axis();
    chart.to_string().trim_end().to_owned()
}
